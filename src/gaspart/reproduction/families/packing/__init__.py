"""Random insertion."""

TITLE = "Random insertion"
CHAPTER = "Equation of state and structure"
FIGURES: dict[str, dict] = {"densest_fill": {}}
