"""Runs as users ask for them: of a duration, or until they are accurate, alone or as replicas."""
