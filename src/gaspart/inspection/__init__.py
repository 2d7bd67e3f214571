"""Validation of trajectories of this and other programs, of scenes and configs; the certificate of a run."""
