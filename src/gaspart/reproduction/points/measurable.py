"""Observables that the trajectories of a point will have, known before the run."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING

from gaspart.analysis.observables import require_run
from gaspart.errors import SceneError
from gaspart.trajectory.run_options import OPTIONS, contents_of

if TYPE_CHECKING:
    from gaspart.reproduction.points.point import Point

_ENOUGH = 64  # number of particles of a kind; more make no difference for observables


def require_observable(name: str, point: Point) -> None:
    """Raise SceneError for an observable that trajectories of a point never have."""
    contents, scene = contents_of(point.arguments), point.scene
    if contents.keep:
        raise point.make_error("keep", "observables need all that frames may hold")
    require_run(name, scene, contents.kept, contents.follow)
    if contents.correlations and "frames" not in point.settings and scene.shear_rate is None:
        rule = "is not known of the first and the last frame alone, which the file has: keep more (frames)"
        raise SceneError("frames", None, rule)


def distinct(points: Iterable[Point]) -> list[Point]:
    """Return one point of each kind; points of a kind have the same observables."""
    from gaspart.reproduction.points.point import variant

    kinds: dict[tuple, Point] = {}
    for point in points:
        scene = point.scene
        counts = tuple(min(kind.count, _ENOUGH) for kind in scene.kinds)
        contents = tuple(key for key in ("lags", "frames", *OPTIONS) if point.settings.get(key))
        kinds.setdefault((variant(point), scene.container.boundary, counts, contents), point)
    return list(kinds.values())
