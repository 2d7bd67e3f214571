"""Pressure on walls."""

TITLE = "Pressure on walls"
FIGURES = ("wall_pressure",)
