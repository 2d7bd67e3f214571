"""Judging runs: trajectories of this and other programs, scenes, configs; and the certificate of a run."""
