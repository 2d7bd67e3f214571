"""Figures on speed distributions."""

from gaspart.keys import POSITIVE, count, list_of, positive

TITLE = "Speed distributions"
CHAPTER = "Motion and its memory"
_HISTOGRAM = {
    "bins": count("bins of the histogram"),
    "highest": positive("its largest speed, over the root-mean-square speed"),
}
_DISTRIBUTION = {**_HISTOGRAM, "classes": count("classes of equal probability for chi-square", minimum=3)}
FIGURES = {
    "speed_relaxation": {
        "times": list_of(POSITIVE, "times of the histograms, each a sampled one"),
        **_HISTOGRAM,
    },
    "speed_distribution_spheres": _DISTRIBUTION,
    "speed_distribution_discs": _DISTRIBUTION,
}
