"""Random insertion."""

TITLE = "Random insertion"
FIGURES = ("fill_failures",)
