"""Observables that the trajectories of a point can have, before they are made."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING

from gaspart.analysis.observables import require_run
from gaspart.errors import SceneError

if TYPE_CHECKING:
    from gaspart.reproduction.points.point import Point

_ENOUGH = 64  # particles of a kind: observables do not distinguish more


def require_observable(name: str, point: Point) -> None:
    """Raise SceneError for an observable that no trajectory of a point has, however long it is."""
    arguments, scene = point.arguments, point.scene
    if "keep" in arguments:
        raise point.make_error("keep", "observables need all that frames may hold")
    stated = arguments.get("correlations")
    kept = {"fluxes": stated and stated.get("stress"), "pairs": arguments.get("pairs")}
    require_run(name, scene, [key for key, value in kept.items() if value], arguments.get("follow"))
    if stated and "frames" not in point.settings and scene.shear_rate is None:
        rule = "is not known of the first and the last frame alone, which the file has: keep more (frames)"
        raise SceneError("frames", None, rule)


def distinct(points: Iterable[Point]) -> list[Point]:
    """Return a point of each kind whose trajectories have the same observables."""
    from gaspart.reproduction.points.point import variant

    kinds: dict[tuple, Point] = {}
    for point in points:
        scene = point.scene
        counts = tuple(min(kind.count, _ENOUGH) for kind in scene.kinds)
        contents = [
            key for key in ("lags", "frames", "displacements", "pairs", "follow") if point.settings.get(key)
        ]
        kinds.setdefault((variant(point), scene.container.boundary, counts, *contents), point)
    return list(kinds.values())
