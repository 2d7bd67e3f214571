"""Radius, density and number of particles."""

TITLE = "Radius, density and number of particles"
CHAPTER = "Equation of state and structure"
FIGURES: dict[str, dict] = {"radius_grid": {}}
