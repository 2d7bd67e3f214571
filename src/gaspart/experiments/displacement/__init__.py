"""Mean-squared displacement."""

TITLE = "Mean-squared displacement"
FIGURES = ("msd_spheres", "msd_discs")
