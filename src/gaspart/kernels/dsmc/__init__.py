"""Collisions sampled among the particles of a cell: direct simulation Monte Carlo (DSMC)."""
