"""Speed against accuracy."""

TITLE = "Speed against accuracy"
FIGURES = ("speed_accuracy", "time_to_accuracy")
