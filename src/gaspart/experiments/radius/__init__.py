"""Radius, density and number of bodies."""

TITLE = "Radius, density and number of bodies"
FIGURES = ("radius_grid",)
