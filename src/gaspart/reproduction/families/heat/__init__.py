"""Figures on heat conduction between walls."""

from gaspart.keys import count, positive

TITLE = "Heat between walls"
CHAPTER = "Gravity, heat and walls"
_BINS = {"bins": count("bins across the gap")}
FIGURES = {
    "heat_conduction_gas": {
        **_BINS,
        "blocks": count("stretches of each replica"),
        "clear": positive("mean free paths next to the walls that are left out, where no fluid theory holds"),
    },
    "heat_conduction_metal": {
        **_BINS,
        "blocks": count("stretches of a run; of several replicas each is one block"),
    },
}
