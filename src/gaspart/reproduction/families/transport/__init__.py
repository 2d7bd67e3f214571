"""Viscosity and conductivity of heat."""

TITLE = "Viscosity and conductivity"
CHAPTER = "Motion and its memory"
FIGURES: dict[str, dict] = {"viscosity": {}, "conductivity": {}}
