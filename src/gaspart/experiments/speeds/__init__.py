"""Speed distributions."""

TITLE = "Speed distributions"
FIGURES = ("speed_relaxation", "speed_distribution_spheres", "speed_distribution_discs")
