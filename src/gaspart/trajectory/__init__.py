"""Runs written to files: AMBER format, recipes, checkpoints, resuming, export, provenance."""
