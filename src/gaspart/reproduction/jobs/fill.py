"""Random sequential insertion into a container up to saturation, with a count of failures.

The planning of a workflow imports this module, so slow imports are made inside functions.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from gaspart.keys import Kind, count
from gaspart.reproduction.jobs.data import PointData

if TYPE_CHECKING:
    import numpy as np

    from gaspart.engines import Engine
    from gaspart.reproduction.points.point import Point
    from gaspart.scene.scene import Scene

RESULT = "random insertion, every failure counted"
ATTEMPTS = count("positions tried for each particle of `count`, of which not all need fit", default=None)
KEYS: dict[str, Kind] = {"attempts": ATTEMPTS}
CHUNK = 1 << 16


def engines(point: Point) -> list[Engine]:
    """Return no engine, because the particles do not move."""
    return []


def arguments(point: Point) -> dict:
    """Return the arguments of `fill`."""
    if "attempts" not in point.settings:
        raise point.make_error("attempts", "is required with job: fill")
    return {"scene": point.scene, "attempts": point.settings["attempts"], "seeds": point.seeds}


def fill(scene: Scene, attempts: int, seeds: list[tuple[int, ...]]) -> PointData:
    """Fill the container by up to ``attempts`` random positions per particle, once per seed. The scene has
    one species. Its count is the maximum number of particles, which may exceed saturation. Insertion stops
    when all particles are placed, or when the total number of attempts, ``attempts`` times the count, is
    reached. Returns a dataset with ``failures`` (replica, particle), the number of failed attempts before
    each particle was placed, or -1 if it was never placed; ``placed`` (replica,); and ``attempts``
    (replica,). The attributes of the dataset are packing_fraction_per_particle, side and radius.
    """
    import numpy as np

    runs = [_fill_once(scene, attempts * scene.count, seed) for seed in seeds]
    return PointData(
        {
            "failures": (
                ("replica", "particle"),
                np.array([failures for failures, _ in runs]),
                {"units": "1"},
            ),
            "placed": ("replica", np.array([(failures >= 0).sum() for failures, _ in runs]), {"units": "1"}),
            "attempts": ("replica", np.array([used for _, used in runs]), {"units": "1"}),
        },
        attributes={
            "packing_fraction_per_particle": scene.packing_fraction / scene.count,
            "side": list(scene.container.lengths),
            "radius": scene.largest_radius,
        },
    )


def _fill_once(scene: Scene, attempts: int, seed: tuple[int, ...]) -> tuple[np.ndarray, int]:
    """Count failures before each particle (N,), and attempts. The number of failures is -1 for a particle
    that was never placed.
    """
    before, used, _ = insert(scene, attempts, seed)
    return before, used


def insert(scene: Scene, attempts: int, seed: tuple[int, ...]) -> tuple[np.ndarray, int, np.ndarray]:
    """Insert particles, and count the failures (N,) before each particle. The number of failures is -1 for a
    particle that was never placed. The function also returns the number of attempts, and the positions (M, d)
    of the placed particles.
    """
    import numpy as np

    from gaspart.kernels.insertion import Task, place
    from gaspart.state.boxes import make_boxes, sides_for
    from gaspart.state.insertion import empty_arrays
    from gaspart.state.random import stream

    boxes = make_boxes(scene, sides_for(scene), images=False)
    lower, upper = scene.reach(scene.largest_radius)
    placed, grid, block = empty_arrays(scene, boxes, np.full(scene.count, scene.largest_radius))
    rng, number, failures, used = stream(seed), 0, 0, 0
    none = np.empty(0, dtype=np.int64)
    while number < scene.count and used < attempts:
        draws = rng.random((min(CHUNK, attempts - used), scene.dimension))
        task = Task(number, scene.count, failures, attempts + 1, lower, upper)
        number, failures, tried = place(draws, placed, grid, block, task, none, None)
        used += tried
    return placed.failures, used, placed.positions[:number]
