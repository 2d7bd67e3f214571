"""Driven granular gases."""

TITLE = "Driven granular gases"
FIGURES: dict[str, dict] = {"driven_gas": {}}
