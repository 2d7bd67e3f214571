"""Figures on granular gases."""

from gaspart.keys import count, names, positive

TITLE = "Granular gases"
CHAPTER = "Granular matter"
FIGURES: dict[str, dict] = {
    "equipartition": {
        "steady_from": positive(
            "collisions per particle after which the ratio of temperatures of a cooling gas is steady"
        )
    },
    "cooling": {
        "clustering": names("the experiments of dense and large gases, which leave Haff's law"),
        "cells_per_side": count("cells per side in which their particles are counted"),
    },
    "driven_gas": {},
}
