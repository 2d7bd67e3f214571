"""Several cores."""

TITLE = "Several cores"
CHAPTER = "Speed and accuracy"
FIGURES: dict[str, dict] = {"cores": {}}
