"""Equation of state."""

TITLE = "Equation of state"
FIGURES = ("virial_discs", "virial_spheres")
