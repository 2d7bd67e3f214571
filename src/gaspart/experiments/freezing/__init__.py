"""Freezing and melting."""

TITLE = "Freezing and melting"
FIGURES = ("freezing_discs", "freezing_spheres")
