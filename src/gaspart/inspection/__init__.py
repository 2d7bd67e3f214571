"""Validation of trajectories of any program, of scenes and of configs; certificate of a run."""
