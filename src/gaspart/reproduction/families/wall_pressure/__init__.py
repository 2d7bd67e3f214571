"""Pressure on walls."""

TITLE = "Pressure on walls"
CHAPTER = "Equation of state and structure"
FIGURES: dict[str, dict] = {"wall_pressure": {}}
