"""Heat between walls."""

from gaspart.kinds import count, positive

TITLE = "Heat between walls"
CHAPTER = "Gravity, heat and walls"
_PROFILES = {"bins": count("bins across the gap"), "blocks": count("stretches of each replica")}
FIGURES = {
    "heat_conduction_gas": {
        **_PROFILES,
        "clear": positive("mean free paths next to the walls that are left out, where no fluid theory holds"),
    },
    "heat_conduction_metal": _PROFILES,
}
