"""Thin films."""

TITLE = "Thin films"
FIGURES = ("thin_film",)
