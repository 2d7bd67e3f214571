"""Figures on adsorption: walls that attract or capture particles."""

from gaspart.keys import count, positive

TITLE = "Walls that hold particles"
CHAPTER = "Gravity, heat and walls"
FIGURES = {
    "adsorption": {
        "blocks": count("stretches of each replica"),
        "layer_blocks": count("the same of layers, in whose deep wells particles stay long"),
        "near": positive(
            "distance from the edge of the well, or from where particles stick, within which the "
            "velocities of leaving particles are read"
        ),
        "bins": count("bins of their speeds"),
    }
}
