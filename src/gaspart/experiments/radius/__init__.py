"""Radius, density and number of particles."""

TITLE = "Radius, density and number of particles"
FIGURES: dict[str, dict] = {"radius_grid": {}}
