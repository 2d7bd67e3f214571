"""What space partitioning buys."""

TITLE = "What space partitioning buys"
FIGURES = ("naive_scaling", "box_count", "ideal_boxes", "linear_scaling", "event_scaling")
