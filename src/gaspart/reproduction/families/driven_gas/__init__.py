"""Driven granular gases."""

TITLE = "Driven granular gases"
CHAPTER = "Granular matter"
FIGURES: dict[str, dict] = {"driven_gas": {}}
