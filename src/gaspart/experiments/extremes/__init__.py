"""Speed, accuracy, stability."""

TITLE = "Speed, accuracy, stability"
FIGURES = ("stability_extremes",)
