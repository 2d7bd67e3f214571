"""Speed against accuracy."""

TITLE = "Speed against accuracy"
FIGURES = ("reversibility",)
