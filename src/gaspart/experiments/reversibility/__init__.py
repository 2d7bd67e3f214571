"""Speed against accuracy."""

TITLE = "Speed against accuracy"
FIGURES: dict[str, dict] = {"reversibility": {}}
