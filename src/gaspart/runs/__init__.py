"""Runs of a given duration, or until accuracies are reached, also as replicas."""
