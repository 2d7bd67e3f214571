"""Figures on random insertion and dense packings."""

from gaspart.keys import count, list_of, names, positive

TITLE = "Random insertion"
CHAPTER = "Equation of state and structure"
FIGURES: dict[str, dict] = {
    "fill_failures": {
        "saturated": names("the experiments that are filled until nothing more fits"),
        "bins": count("bins of the packing fraction up to the densest fill"),
        "windows": list_of(
            {"type": "number", "exclusiveMinimum": 1},
            "ratios of the last time to the first one of the fitted window; the first is the one claimed",
        ),
        "dilute": positive(
            "packing fraction up to which failures are compared with the low-density expansion", maximum=0.1
        ),
    },
    "densest_fill": {},
}
