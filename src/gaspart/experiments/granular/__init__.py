"""Rough and inelastic bodies."""

TITLE = "Rough and inelastic bodies"
FIGURES = ("equipartition", "cooling")
