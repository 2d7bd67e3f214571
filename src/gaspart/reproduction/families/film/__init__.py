"""Figures on thin films."""

from gaspart.keys import POSITIVE, count, list_of, positive

TITLE = "Thin films"
CHAPTER = "Equation of state and structure"
FIGURES = {
    "thin_film": {
        "bulk_packing_fraction": positive(
            "packing fraction of the fluid with which all slits are (nearly) in equilibrium"
        ),
        "insertions": count("number of Widom's trial insertions for each width", minimum=1000),
        "theory_widths": list_of(POSITIVE, "first, last and number of the curve's widths", 3, 3),
    }
}
