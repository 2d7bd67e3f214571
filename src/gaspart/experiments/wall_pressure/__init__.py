"""Pressure on walls."""

TITLE = "Pressure on walls"
FIGURES: dict[str, dict] = {"wall_pressure": {}}
