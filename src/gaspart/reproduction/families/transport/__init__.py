"""Viscosity and conductivity of heat."""

from gaspart.kinds import positive

TITLE = "Viscosity and conductivity"
CHAPTER = "Motion and its memory"
FIGURES: dict[str, dict] = {
    "viscosity": {},
    "conductivity": {},
    "logarithmic_growth": {
        "start": positive("collisions of a particle from which on the growth of the integrals is compared"),
    },
}
