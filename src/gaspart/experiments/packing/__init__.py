"""Random insertion."""

TITLE = "Random insertion"
FIGURES: dict[str, dict] = {"densest_fill": {}}
