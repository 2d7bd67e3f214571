"""Speed against accuracy."""

TITLE = "Speed against accuracy"
FIGURES = ("price_of_features",)
