"""Collisions between randomly drawn particles of a cell: direct simulation Monte Carlo (DSMC)."""
