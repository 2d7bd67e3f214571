"""Speed against accuracy."""

from gaspart.kinds import COUNT, POSITIVE, listed, positive

TITLE = "Speed against accuracy"
CHAPTER = "Speed and accuracy"
COSTS = ["time_to_accuracy"]
_ACCURACIES = listed(POSITIVE, "relative accuracies of the cheapest settings")
FIGURES = {
    "speed_accuracy": {
        "order_up_to": positive("largest relative error that the fits of the order use"),
        "accuracies": _ACCURACIES,
    },
    "time_to_accuracy": {"counts": listed(COUNT, "numbers of particles"), "accuracies": _ACCURACIES},
}
