"""Runs on request: of a duration, or until they are accurate, alone or as replicas."""
