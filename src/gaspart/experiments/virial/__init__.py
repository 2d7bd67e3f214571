"""Equation of state: virial_discs, virial_spheres."""
