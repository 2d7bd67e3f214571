"""Mean-squared displacement."""

TITLE = "Mean-squared displacement"
FIGURES: dict[str, dict] = {"msd_spheres": {}, "msd_discs": {}}
