"""Random insertion."""

TITLE = "Random insertion"
FIGURES = ("densest_fill",)
