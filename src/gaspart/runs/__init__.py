"""Runs of a prescribed duration or until accuracies are reached, single or as replicas."""
