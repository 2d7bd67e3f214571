"""Dense random states of a scene: inserted up to saturation, or grown until jammed.

The planning of a workflow imports this module, so slow imports are made inside functions.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from gaspart.keys import Kind, positive
from gaspart.reproduction.jobs.data import PointData
from gaspart.reproduction.jobs.fill import ATTEMPTS, insert

if TYPE_CHECKING:
    from gaspart.engines import Engine
    from gaspart.reproduction.points.point import Point
    from gaspart.scene.scene import Scene

RESULT = "random insertion until nothing more fits; with `arrangement: compressed` growth until all jam"
GROWTH = 2.0**-6
"""Growth rate of particles until jamming: slow enough to find all contacts, too fast to crystallise."""
KEYS: dict[str, Kind] = {
    "attempts": ATTEMPTS,
    "growth_rate": positive(
        "growth rate of the diameter over the thermal speed, with `arrangement: compressed`; 1/64 without it",
        default=None,
    ),
}


def engines(point: Point) -> list[Engine]:
    """Return no engine: growth has kernels that all scenes share."""
    return []


def arguments(point: Point) -> dict:
    """Return the arguments of `pack`."""
    if ("attempts" in point.settings) == (point.settings.get("arrangement") == "compressed"):
        raise point.make_error("attempts", "is required with job: pack, unless the arrangement is compressed")
    if "growth_rate" in point.settings and "attempts" in point.settings:
        raise point.make_error("growth_rate", "excludes attempts")
    own = {"growth": rate} if (rate := point.settings.get("growth_rate")) else {}
    return {"scene": point.scene, "attempts": point.settings.get("attempts"), "seeds": point.seeds, **own}


def pack(
    scene: Scene, attempts: int | None, seeds: list[tuple[int, ...]], growth: float = GROWTH
) -> PointData:
    """Pack a scene of one species, once per seed, by insertion or growth. Insertion tries up to `attempts`
    random positions for each particle. If `attempts` has the value None, the particles grow at the rate
    `growth` until they jam instead. Returns a dataset with position (replica, particle, axis), NaN for a
    particle that was never placed; radius and packing_fraction (replica,); reduced pressure (replica,), NaN
    for insertion; and length (axis,).
    """
    import numpy as np

    from gaspart.state.compression import compress

    shape = (len(seeds), scene.count, scene.dimension)
    positions, scales, fractions, pressures = np.full(shape, np.nan), [], [], []
    for row, seed in zip(positions, seeds, strict=True):
        if attempts is None:
            packing = compress(scene, seed, growth, until="jammed")
            row[:] = packing.positions
            scales.append(packing.scale)
            fractions.append(packing.packing_fraction)
            pressures.append(packing.pressure)
        else:
            _, _, coordinates = insert(scene, attempts * scene.count, seed)
            row[: len(coordinates)] = coordinates
            scales.append(1.0)
            fractions.append(scene.packing_fraction * len(coordinates) / scene.count)
            pressures.append(np.nan)
    return PointData(
        {
            "position": (("replica", "particle", "axis"), positions, {"units": "length"}),
            "radius": ("replica", scene.largest_radius * np.array(scales), {"units": "length"}),
            "packing_fraction": ("replica", fractions, {"units": "1"}),
            "pressure": ("replica", pressures, {"units": "N k_B T / V"}),
            "length": ("axis", np.array(scene.container.lengths), {"units": "length"}),
        }
    )
