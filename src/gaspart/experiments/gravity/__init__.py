"""Under gravity."""

TITLE = "Under gravity"
FIGURES = ("barometric", "separation", "heat_capacity")
