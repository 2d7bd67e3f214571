"""Gases behind a piston."""

TITLE = "Gases behind a piston"
CHAPTER = "Equation of state and structure"
FIGURES: dict[str, dict] = {"piston": {}}
