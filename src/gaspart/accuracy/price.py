"""Cost of the features of a scene with an engine."""

from __future__ import annotations

import math
from dataclasses import dataclass

from gaspart.accuracy import table
from gaspart.analysis.observables import OBSERVABLES
from gaspart.engines import Engine
from gaspart.scene.features import FEATURES
from gaspart.scene.scene import Scene

_NAMES = {
    "walls": "walls of the container",
    "gravity": "gravity",
    "spin": "rough particles",
    "two_masses": "unequal masses",
    "stress": "the stress tensor",
}
"""Names of the measured features."""
_MEASURED = ("gravity", "roughness")
"""Features of `scene.features` among them."""


@dataclass(frozen=True)
class Price:
    """Cost of the features of a scene, in addition to its collisions.

    ratios : time per event with each measured feature, divided by the time without it.
    unknown : features of the scene whose cost was not measured.
    single : time in single precision divided by the time in double precision, None for an engine that has one
        precision only.
    """

    ratios: dict[str, float]
    unknown: tuple[str, ...]
    single: float | None


def price_of(scene: Scene, engine: Engine, observable: str) -> Price:
    """Return the price of an observable of a scene with an engine.

    It was measured in a gas of 4000 spheres at a packing fraction of 0.2 (figure `price_of_features`), where
    a feature that is absent costs nothing.
    """
    has = {
        "walls": not scene.is_periodic,
        "gravity": any(scene.gravity or ()),
        "spin": scene.rough,
        "two_masses": len({kind.mass for kind in scene.kinds}) > 1,
        "stress": OBSERVABLES[observable].needs == "fluxes",
    }
    prices, present = table.prices(engine.timed_as), scene.features
    ratios = {_NAMES[name]: prices[name] for name in _NAMES if has[name] and name in prices}
    unknown = [_NAMES[name] for name in _NAMES if has[name] and name not in prices]
    unknown += [FEATURES[name].meaning for name in FEATURES if name in present and name not in _MEASURED]
    return Price(ratios, tuple(unknown), _single(engine, scene.dimension))


def _single(engine: Engine, dimension: int) -> float | None:
    """Compute the time per contact in single precision divided by the time in double precision.

    The gas is the one at which the engine is timed; None for an engine that was not timed in both.
    """
    fraction, step = engine.timed_at
    single, double = (
        table.seconds(dimension, fraction, engine.timed_as, precision, step)
        for precision in ("float32", "float64")
    )
    return single / double if math.isfinite(single / double) else None
