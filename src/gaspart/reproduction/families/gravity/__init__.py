"""Figures on gases under gravity."""

from gaspart.keys import POSITIVE, TEXT, count, describe, list_of, positive, record

TITLE = "Under gravity"
CHAPTER = "Gravity, heat and walls"


def _columns(**meanings: str) -> dict:
    """Return the setting `columns`, which names the experiment of each column."""
    return record(
        {name: describe(TEXT, meaning, default=None) for name, meaning in meanings.items()},
        "the experiment of each column that the figure distinguishes",
    )


_OWN = {"dilute": "nearly an ideal gas", "dense": "at fluid densities at the floor"}
_PROFILES = {
    "bins": count("bins of height"),
    "blocks": count("stretches of each replica"),
    "clear": positive("diameters next to floor and ceiling that are left out, where layers are"),
    "ranges": list_of(
        list_of(POSITIVE, least=2, most=2),
        "pairs of packing fractions between which the equation of state is averaged",
    ),
}
_COLLISIONS = positive("collisions before the sample of source C's own run")
FIGURES = {
    "barometric": _PROFILES
    | {
        "columns": _columns(
            **_OWN, source="source C's own run", later="its scene, after a longer time, without side walls"
        ),
        "source_collisions": _COLLISIONS,
        "source_temperature": positive("that source C fits to the speeds of its sample"),
    },
    "separation": _PROFILES
    | {
        "columns": _columns(**_OWN, source="source C's own run"),
        "source_collisions": _COLLISIONS,
        "source_shares": list_of(
            POSITIVE, "of the light discs in source C's sample, in equal layers from the floor up"
        ),
    },
    "heat_capacity": {"blocks": count("stretches of each replica")},
}
