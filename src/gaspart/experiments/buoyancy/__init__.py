"""Under gravity."""

TITLE = "Under gravity"
FIGURES = ("buoyancy",)
