"""Radius, density and number of bodies: radius_grid."""
