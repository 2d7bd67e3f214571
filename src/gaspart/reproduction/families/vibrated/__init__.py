"""Vibrated granular beds."""

from gaspart.keys import count, positive

TITLE = "Vibrated granular beds"
CHAPTER = "Granular matter"
FIGURES = {
    "vibrated_bed": {
        "bins": count("bins of the density profile", least=4),
        "highest": positive("height up to which the profile reaches, over T/g"),
    }
}
