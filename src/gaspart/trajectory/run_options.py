"""Options of a run that determine what its file holds, each declared once.

The keys of a config, the options of `gaspart run` and of the command that a file states, and the checks of
`Recipe` follow from the declarations. A tally that a run can request declares itself
(`state.optional_tallies`).
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from gaspart.keys import TEXT, Kind, choice, count, describe, flag
from gaspart.state.optional_tallies import REQUESTED

KEPT = {"positions": "coordinates", "velocities": "velocities"}
"""Choices of `keep`, and the variable of a frame that each is."""

OPTIONS: dict[str, Kind] = {
    "displacements": flag(
        "also keep unwrapped displacements since time 0, in float64, for mean-squared displacements",
        default=False,
    ),
    "follow": count(
        "keep only the first so many particles (single `particles` come first, then `species`); counters and "
        "energies are those of all",
        default=None,
    ),
    "keep": choice(
        "what frames hold of each particle (by default positions, velocities and spins; without positions "
        "no other program reads the file, and chemfiles finds 0)",
        *KEPT,
        default=None,
    ),
    "pairs": flag(
        "count the collisions of each pair of species, with which `contact_values` are measured",
        default=False,
    ),
    **{
        tally.name: describe(TEXT, tally.meaning, title=tally.form, default=None)
        for tally in REQUESTED.values()
    },
}
"""Kind, meaning and default of each option, by its name, in the order of help and reference."""


def recipe_fields(settings: Mapping[str, Any]) -> dict[str, Any]:
    """Return the fields of a recipe that settings of a run determine.

    Parameters
    ----------
    settings : mapping of str to object
        Fields of `Recipe`, and texts of tallies by their names.

    Returns
    -------
    dict of str to object
        Fields, with the requested `tallies` in place of their texts.

    Raises
    ------
    SceneError
        If the text of a tally is invalid.
    """
    fields = {name: value for name, value in settings.items() if name not in REQUESTED}
    texts = {name: settings[name] for name in REQUESTED if settings.get(name) is not None}
    return {**fields, "tallies": tuple(REQUESTED[name].from_text(text) for name, text in texts.items())}
