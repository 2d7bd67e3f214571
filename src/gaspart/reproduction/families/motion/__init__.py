"""Figures on displacement and velocity autocorrelation."""

from gaspart.keys import POSITIVE, list_of, positive

TITLE = "Displacement and velocity autocorrelation"
CHAPTER = "Motion and its memory"
FIGURES: dict[str, dict] = {
    "msd_spheres": {},
    "msd_discs": {},
    "velocity_autocorrelation": {
        "start_to": positive("collisions of a particle up to which the initial decay is fitted"),
        "tail": list_of(POSITIVE, "collisions of a particle from and to which the tail is fitted", 2, 2),
    },
}
