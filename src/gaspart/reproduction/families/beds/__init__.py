"""Figures on settling, discharge and vibrated beds of grains."""

from gaspart.keys import count, positive

TITLE = "Settling, discharge and vibrated beds"
CHAPTER = "Granular matter"
FIGURES: dict[str, dict] = {
    "settling": {
        "gap": positive("two discs with a smaller gap, in mean diameters, are in contact"),
        "start": positive("share of the discs in the hopper from which on the flow is measured", maximum=1),
        "head": positive("height of the filling down to which it is measured, in widths of the orifice"),
    },
    "vibrated_bed": {
        "bins": count("bins of the density profile", least=4),
        "highest": positive("height up to which the profile reaches, over T/g"),
    },
}
