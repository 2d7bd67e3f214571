"""The densest random states of a scene: inserted to saturation, or grown until jammed."""

from __future__ import annotations

import numpy as np

from gaspart.reproduction.jobs.data import PointData
from gaspart.reproduction.jobs.fill import insert
from gaspart.scene.scene import Scene
from gaspart.state.compression import compress

GROWTH = 2.0**-6
"""Rate of growth towards jamming: slow enough to find all contacts, too fast to crystallise."""


def pack(scene: Scene, attempts: int | None, seeds: list[tuple[int, ...]]) -> PointData:
    """Pack a scene of one species, once per seed: offer the container `attempts` random positions for each
    particle, or, with None, let the particles grow until they jam.

    Returns a dataset: position (replica, body, axis), NaN for a particle never placed; radius and
    packing_fraction (replica,); pressure (replica,), reduced, NaN for an insertion; length (axis,).
    """
    shape = (len(seeds), scene.count, scene.dimension)
    positions, scales, fractions, pressures = np.full(shape, np.nan), [], [], []
    for one, seed in zip(positions, seeds, strict=True):
        if attempts is None:
            packing = compress(scene, seed, GROWTH, until="jammed")
            one[:] = packing.positions
            scales.append(packing.scale)
            fractions.append(packing.packing_fraction)
            pressures.append(packing.pressure)
        else:
            _, _, places = insert(scene, attempts * scene.count, seed)
            one[: len(places)] = places
            scales.append(1.0)
            fractions.append(scene.packing_fraction * len(places) / scene.count)
            pressures.append(np.nan)
    return PointData(
        {
            "position": (("replica", "body", "axis"), positions, {"units": "length"}),
            "radius": ("replica", scene.largest_radius * np.array(scales), {"units": "length"}),
            "packing_fraction": ("replica", fractions, {"units": "1"}),
            "pressure": ("replica", pressures, {"units": "N k_B T / V"}),
            "length": ("axis", np.array(scene.container.lengths), {"units": "length"}),
        }
    )


def run(recipe: dict) -> PointData:
    """`pack` of a point's recipe."""
    return pack(
        Scene.from_dict(recipe["scene"]), recipe["attempts"], [tuple(seed) for seed in recipe["seeds"]]
    )
