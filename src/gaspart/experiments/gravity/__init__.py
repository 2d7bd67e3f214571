"""Under gravity."""

from gaspart.kinds import POSITIVE, count, listed, positive

TITLE = "Under gravity"
CHAPTER = "Gravity, heat and walls"
_PROFILES = {
    "bins": count("bins of height"),
    "blocks": count("stretches of each replica"),
    "clear": positive("diameters next to floor and ceiling that are left out, where layers are"),
    "ranges": listed(
        listed(POSITIVE, least=2, most=2),
        "pairs of packing fractions between which the equation of state is averaged",
    ),
}
FIGURES = {
    "barometric": _PROFILES,
    "separation": _PROFILES,
    "heat_capacity": {"blocks": count("stretches of each replica")},
}
