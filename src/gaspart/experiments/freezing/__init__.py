"""Freezing and melting: freezing_discs, freezing_spheres."""
