"""Speed against accuracy."""

TITLE = "Speed against accuracy"
CHAPTER = "Speed and accuracy"
FIGURES: dict[str, dict] = {"price_of_features": {}}
