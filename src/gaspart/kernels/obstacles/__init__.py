"""Obstacles of particles: faces of the container, wells, interior walls."""
