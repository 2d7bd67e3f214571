"""Figures on viscosity and thermal conductivity."""

from gaspart.keys import positive

TITLE = "Viscosity and conductivity"
CHAPTER = "Motion and its memory"
FIGURES: dict[str, dict] = {
    "viscosity": {},
    "conductivity": {},
    "logarithmic_growth": {
        "viscosity_from": positive(
            "collisions of a particle from which on the integral's growth is compared"
        ),
        "conductivity_from": positive("the same of the heat flux, which relaxes half as fast"),
    },
}
