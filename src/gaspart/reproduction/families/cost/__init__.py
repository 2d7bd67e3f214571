"""Cost of features, gain by cores."""

TITLE = "Cost of features, gain by cores"
CHAPTER = "Speed and accuracy"
FIGURES: dict[str, dict] = {"price_of_features": {}, "cores": {}}
