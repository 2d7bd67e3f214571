"""Trajectory files: AMBER format, recipes, checkpoints, continuation, export, provenance."""
