"""Figures on Couette flow: shear between sliding walls."""

from gaspart.keys import count, names, positive, record

TITLE = "Shear between sliding walls"
CHAPTER = "Motion and its memory"
FIGURES = {
    "couette": {
        "parts": record(
            {
                "flows": names("gases between walls that slide"),
                "sheared": names("periodic gases that are sheared without walls"),
                "equilibrium": names("gases with correlations of the stress, as `viscosity`"),
            },
            "the experiments of each part",
        ),
        "blocks": count("stretches of each run"),
        "bins": count("bins across the gap"),
        "clear": positive("distance from the walls, in mean free paths or diameters, of what is measured"),
    }
}
