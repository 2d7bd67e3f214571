"""Figures on mixtures and polydisperse gases."""

TITLE = "Mixtures"
CHAPTER = "Equation of state and structure"
FIGURES: dict[str, dict] = {"mixture_state": {}}
