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
_COLLISIONS = positive("collisions before the sample of source C's own run")
FIGURES = {
    "barometric": _PROFILES
    | {
        "source_collisions": _COLLISIONS,
        "source_temperature": positive("that source C fits to the speeds of its sample"),
    },
    "separation": _PROFILES
    | {
        "source_collisions": _COLLISIONS,
        "source_shares": listed(
            POSITIVE, "of the light discs in source C's sample, in equal layers from the floor up"
        ),
    },
    "heat_capacity": {"blocks": count("stretches of each replica")},
}
