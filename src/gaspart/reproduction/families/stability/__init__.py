"""Figures on stability and reversibility."""

from gaspart.keys import TEXT, list_of, names

TITLE = "Stability and reversibility"
CHAPTER = "Speed and accuracy"
FIGURES: dict[str, dict] = {
    "stability_extremes": {
        "experiments": list_of(TEXT, "none: its scenes are a table of the library", least=0, most=0),
        "groups": names("groups of the table's rows that are run; all by default", default=None),
    },
    "reversibility": {},
}
