"""Figures on the structure of the fluid, and on its chemical potential."""

from gaspart.keys import count, names, positive

TITLE = "Structure and chemical potential"
CHAPTER = "Equation of state and structure"
_SERIES = {"measured": names("the experiments whose frames are measured; of the others Z alone")}
FIGURES = {
    "structure": {
        **_SERIES,
        "small": positive("wave number times the diameter up to which S(k) is fitted, to extrapolate to 0"),
        "highest": positive("wave number times the diameter up to which S(k) is drawn"),
        "furthest": positive("distance in diameters up to which g(r) is drawn", maximum=4.5),
        "frames": count("frames of each run that are used for the curves", minimum=20),
    },
    "chemical_potential": {
        **_SERIES,
        "trials": count("positions that are tried in each frame"),
        "frames": count("frames of each run that are used", minimum=20),
        "enough": count("frames with a free place from which on their mean counts as Gaussian"),
    },
}
