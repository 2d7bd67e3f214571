"""Estimators: what else than counts measures the same, in the same run."""

from gaspart.keys import listed, positive

TITLE = "Estimators"
CHAPTER = "Equation of state and structure"
FIGURES = {
    "estimators": {
        "widths": listed(
            positive(""), "widths of bins, in diameters: whole multiples of those that runs keep"
        )
    }
}
