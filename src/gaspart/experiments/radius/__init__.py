"""Radius, density and number of bodies."""

TITLE = "Radius, density and number of bodies"
FIGURES: dict[str, dict] = {"radius_grid": {}}
