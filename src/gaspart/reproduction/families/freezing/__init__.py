"""Figures on freezing and melting."""

from gaspart.keys import POSITIVE, count, list_of, positive

TITLE = "Freezing and melting"
CHAPTER = "Equation of state and structure"
FIGURES = {
    "freezing_discs": {
        "shown": list_of(POSITIVE, "packing fractions whose structure is kept"),
        "furthest": positive("largest distance of g(r), in diameters"),
        "bins": count("bins of g(r)"),
        "highest": positive("largest wave number of S(k), times the diameter"),
    },
    "freezing_spheres": {},
}
