"""Estimators: what else than counts measures the same, in the same run."""

from gaspart.keys import list_of, positive

TITLE = "Estimators"
CHAPTER = "Equation of state and structure"
FIGURES = {
    "estimators": {
        "widths": list_of(
            positive(""), "widths of bins, in diameters: whole multiples of those that runs keep"
        )
    }
}
