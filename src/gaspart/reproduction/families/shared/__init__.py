"""Measurements that several families share."""
