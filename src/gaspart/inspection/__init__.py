"""Validation of trajectories of any program, of scenes and configs; the certificate of a run."""
