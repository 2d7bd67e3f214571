"""Figures on the equation of state."""

from gaspart.keys import count, flag, list_of, names, positive, record

TITLE = "Equation of state"
CHAPTER = "Equation of state and structure"
_FITS = list_of(
    record(
        {
            "free": count("highest coefficient left free", minimum=4, maximum=9),
            "up_to": positive("largest packing fraction used"),
            "held": flag("hold the higher coefficients at their literature values"),
        }
    ),
    "fits of the virial coefficients; the first one is claimed",
)
SERIES = {"virial_discs": (2, 0.65), "virial_spheres": (3, 0.49)}
FIGURES: dict[str, dict] = {
    "virial_discs": {"fits": _FITS},
    "virial_spheres": {"fits": _FITS},
    "radius_grid": {},
    "literature": {"judged": names("experiments whose values have claims of their own, not only together")},
}
