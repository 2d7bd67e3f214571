"""Figures that a config defines without code: an observable against a key of a grid."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

from gaspart.analysis.observables import OBSERVABLES
from gaspart.keys import NUMBER, TEXT, Kind, choice, describe, flag, list_of, names, positive, record

if TYPE_CHECKING:
    from gaspart.reproduction.points.point import Point

TITLE = "Own figures"
CHAPTER = "Own figures"
FIGURES: dict[str, dict[str, Kind]] = {}

_CLAIM = record(
    {
        "that": choice(
            "what is stated, at every point or, `exponent`, of all points together: the value of theory, a "
            "bound, a value, or the exponent of a power law",
            *("theory", "at_least", "at_most", "value", "exponent"),
        ),
        "value": describe(NUMBER, "the bound, value or exponent", default=None),
        "tolerance": positive(
            "half of the width of the band in which a value or an exponent lies; with `theory`, if it is an "
            "approximation, the same over theory's value",
            default=None,
        ),
        "required": positive(
            "largest standard uncertainty of the measurement at which the claim is conclusive, with `theory` "
            "over theory's value; of a value and an exponent by default half of the tolerance",
            default=None,
        ),
        "between": list_of(
            NUMBER,
            "lowest and highest value of `against` of the points that it is about",
            2,
            2,
            default=None,
        ),
        "source": describe(
            {**TEXT, "minLength": 1}, "of the expected value; that of a theory is known", default=None
        ),
        "fails_if": describe({**TEXT, "minLength": 1}, "what would make it fail"),
    }
)
KINDS: dict[str, dict[str, Kind]] = {
    "observable": {
        "observable": choice("what is measured, as by `gaspart measure`", *OBSERVABLES),
        "against": describe(
            {**TEXT, "minLength": 1},
            "the key of the grid, of numbers, that is the horizontal axis; of an observable that is a curve "
            "there is one curve for each of its values",
        ),
        "experiments": names("experiments that make trajectories, whose points are measured"),
        "place": describe(
            NUMBER, "of a curve: the place, or the nearest one, whose value is taken instead", default=None
        ),
        "theory": flag("draw theory, where there is one for the scene", default=True),
        "logarithmic": choice("axes with a logarithmic scale", "none", "x", "y", "both", default="none"),
        "caption": describe(
            TEXT, "reStructuredText for the report, whose first words in bold are the finding", default=""
        ),
        "claims": list_of(_CLAIM, "what is expected of the measurement", 0, default=[]),
    }
}
"""Settings of each kind of figure whose name the config chooses."""


def validate(figure: str, settings: Mapping[str, Any], points: Sequence[Point]) -> None:
    """Raise SceneError if settings contradict each other, or the points cannot be drawn."""
    from gaspart.reproduction.families.own import rules

    rules.validate(figure, settings, points)


def caption(settings: Mapping[str, Any]) -> str:
    """Return the caption of a figure from the config; add a title if it is missing."""
    text = str(settings.get("caption", "")).strip()
    if text.startswith("**"):
        return text
    meaning = OBSERVABLES[settings["observable"]].definition.partition(",")[0]
    against = settings["against"].removeprefix("scene.").replace("_", " ")
    return f"**{meaning[0].upper()}{meaning[1:]}, against {against}.** {text}".rstrip()
