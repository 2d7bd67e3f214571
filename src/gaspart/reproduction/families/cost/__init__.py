"""Figures on the cost of features, and the gain from several cores."""

TITLE = "Cost of features, gain by cores"
CHAPTER = "Speed and accuracy"
FIGURES: dict[str, dict] = {"price_of_features": {}, "cores": {}}
