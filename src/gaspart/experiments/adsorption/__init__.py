"""Walls that hold bodies."""

TITLE = "Walls that hold bodies"
FIGURES = ("adsorption",)
