"""Speed, accuracy, stability."""

from gaspart.keys import TEXT, list_of, names

TITLE = "Speed, accuracy, stability"
CHAPTER = "Speed and accuracy"
FIGURES = {
    "stability_extremes": {
        "experiments": list_of(TEXT, "none: its scenes are a table of the library", least=0, most=0),
        "groups": names("groups of the table's rows that are run; all by default", default=None),
    }
}
