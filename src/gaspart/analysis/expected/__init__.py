"""Theoretical values for a run, from its engine's equation and its number of particles."""
