"""Piles at rest and flow through an orifice."""

from gaspart.keys import positive

TITLE = "Settling and discharge"
CHAPTER = "Granular matter"
FIGURES = {
    "settling": {
        "gap": positive("two discs with a smaller gap, in mean diameters, are in contact"),
        "start": positive("share of the discs in the hopper from which on the flow is measured", maximum=1),
        "head": positive("height of the filling down to which it is measured, in widths of the orifice"),
    }
}
