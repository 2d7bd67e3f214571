"""Figures on speed against accuracy."""

from gaspart.keys import COUNT, POSITIVE, count, list_of, names, positive

TITLE = "Speed against accuracy"
CHAPTER = "Speed and accuracy"
COSTS = ["time_to_accuracy"]
ENGINES = ("event", "step", "boltzmann", "enskog")
"""Engines that are compared; the last two are the models of the DSMC engine."""
PARTS = ("model", "discretisation", "noise", "equilibration", "finite_size")
"""Parts of an error, from the bottom of a stacked bar; the parts that add up to the accuracy come first."""
FREE_TIMES = 2.5
"""Duration of the relaxation of speeds over which it is integrated, in mean free times."""
FIGURES = {
    "speed_accuracy": {
        "order_up_to": positive("largest relative error that the fits of the order use"),
        "cells": names("experiments of the Enskog model in its default cells"),
    },
    "time_to_accuracy": {
        "counts": list_of(COUNT, "numbers of particles; the first is that of the map"),
        "accuracies": list_of(POSITIVE, "relative accuracies of the cheapest settings"),
        "elsewhere": names("experiments of gases that the model of costs was not fitted to"),
        "cells": names("experiments of the Enskog model in its default cells"),
        "plates": names("experiments between a hot and a cold plate"),
        "plates_cost": names("timings of the experiments between plates"),
        "relaxation": names("experiments whose speeds are equal at first"),
        "blocks": count("stretches of each run between plates"),
    },
}
