"""Mean-squared displacement."""

TITLE = "Mean-squared displacement"
CHAPTER = "Motion and its memory"
FIGURES: dict[str, dict] = {"msd_spheres": {}, "msd_discs": {}}
