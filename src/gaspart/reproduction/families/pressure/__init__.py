"""Figures on pressure on walls and pistons."""

from gaspart.keys import list_of, positive

TITLE = "Pressure on walls and pistons"
CHAPTER = "Equation of state and structure"
FIGURES: dict[str, dict] = {
    "wall_pressure": {},
    "piston": {},
    "estimators": {
        "widths": list_of(
            positive(""), "widths of bins, in diameters: whole multiples of those that runs keep"
        )
    },
}
