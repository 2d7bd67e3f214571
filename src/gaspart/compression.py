"""Random packings denser than insertion can make: bodies that move, collide and grow until they are as large
as wanted, or jam (Lubachevsky & Stillinger, J. Stat. Phys. 60, 561 (1990)).

All bodies grow in proportion, at a constant rate of their diameters; they move as bodies of mass 1 whose
temperature is brought back to 1 every few collisions. How dense they become is a matter of how slowly they
grow: fast, spheres jam at a packing fraction of about 0.64 and discs at 0.84; slowly, they crystallise.
"""

from __future__ import annotations

import math
from contextlib import suppress
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from gaspart.engines.calendar import PLAN, empty_calendar
from gaspart.errors import SceneError, SimulationError
from gaspart.memory import aligned
from gaspart.random import normals, stream
from gaspart.scene import Scene, Species

JAMMED = 1e6
"""Reduced pressure PV/(N k_B T) at which bodies count as jammed."""
RATES = (2.0**-4, 2.0**-7, 2.0**-10)
"""Growth of the largest diameter per thermal speed: what `compressed` tries in turn."""

_START = {2: 0.3, 3: 0.2}  # packing fraction at which growth begins, within easy reach of insertion
_SPARE = 2.0**-36  # by which bodies are grown larger than wanted, so that rounding leaves no overlap
_COLLISIONS = 8  # per body between two resettings of the temperature
_POSITIONS, _MOTION = 0, 4


@dataclass(frozen=True)
class Packing:
    """positions (N, d); scale: the radii reached, as multiples of the scene's; packing_fraction; pressure,
    reduced, in the last stretch; collisions, in all."""

    positions: np.ndarray
    scale: float
    packing_fraction: float
    pressure: float
    collisions: int


def compress(
    scene: Scene,
    seed: int | tuple[int, ...] = 0,
    growth_rate: float = RATES[0],
    until: float | Literal["jammed"] | None = None,
    jammed: float = JAMMED,
) -> Packing:
    """Grow the species of a scene from a random start until their packing fraction is `until` (by default the
    scene's), or, with "jammed", until the reduced pressure exceeds `jammed`, which always ends it.

    The diameter of the largest bodies grows by `growth_rate` times the thermal speed of a body.

    Raises SceneError for scenes with bodies or walls of their own, and if bodies jam before they are as dense
    as wanted.
    """
    if scene.bodies or scene.walls or any(kind.fixed for kind in scene.species):
        raise SceneError("arrangement", "compressed", "all bodies must be free to move, with no walls inside")
    if scene.count == 0:
        return Packing(np.empty((0, scene.dimension)), 1.0, 0.0, 1.0, 0)
    d = scene.dimension
    unit = scene.packing_fraction
    wanted = (
        unit if until is None else math.pi / math.sqrt(12 if d == 2 else 18) if until == "jammed" else until
    )
    end = _root(wanted / unit, d)
    growing = _Growing(scene, seed, min(end, _root(_START[d] / unit, d)), end)
    while growing.scale < end * (1.0 + _SPARE) and growing.pressure < jammed:
        growing.grow(growth_rate, end * (1.0 + _SPARE))
    if growing.scale < end and until != "jammed":
        raise SceneError(
            "packing_fraction",
            wanted,
            f"bodies that grow by {growth_rate:g} jam at {unit * growing.scale**d:.4f} already",
        )
    scale = min(end, growing.scale * (1.0 - _SPARE))
    fraction = replace(scene, species=_scaled(scene, scale)).packing_fraction
    return Packing(growing.settled(scale), scale, fraction, growing.pressure, growing.collisions)


def compressed(scene: Scene, seed: int | tuple[int, ...]) -> np.ndarray:
    """(N, d) positions for the scene as it is, by the fastest of `RATES` that leads there.

    Raises SceneError if none does.
    """
    for rate in RATES[:-1]:
        with suppress(SceneError):
            return compress(scene, seed, rate).positions
    return compress(scene, seed, RATES[-1]).positions


def _root(value: float, dimension: int) -> float:
    """The square or cube root, by bisection: library roots differ between machines."""
    low, high = 0.0, max(1.0, value)
    for _ in range(200):
        middle = 0.5 * (low + high)
        power = middle * middle if dimension == 2 else middle * middle * middle
        low, high = (middle, high) if power <= value else (low, middle)
    return low


def _scaled(scene: Scene, scale: float) -> tuple[Species, ...]:
    """The species of a scene with radii of another scale, at random places."""
    return tuple(replace(kind, radius=kind.radius * scale, arrangement="random") for kind in scene.species)


class _Growing:
    """The bodies of a scene, at `scale` times their radii, under way."""

    def __init__(self, scene: Scene, seed: int | tuple[int, ...], scale: float, end: float) -> None:
        from gaspart.boxes import make_boxes, sides_for
        from gaspart.engines import growth, layout, lists
        from gaspart.initial import per_body, random_insertion

        start = replace(scene, species=_scaled(scene, scale), faces={})
        positions, _ = random_insertion(start, stream(seed, _POSITIONS))
        self._scene, self._kernels, self._layout = scene, growth, layout
        d, n = scene.dimension, scene.count
        self.scale, self.pressure, self.collisions = scale, 1.0, 0
        self._radii = per_body(scene, "radius").astype(float)
        self.rows = aligned((n, 8), float)
        self.rows[:, :d] = positions
        self.rows[:, d : 2 * d] = normals(stream(seed, _MOTION), n, d)
        self.rows[:, 2 * d + 1] = self._radii * scale
        width = 2.0 * scene.largest_radius * end * (1.0 + 2.0 * _SPARE)  # so that boxes serve to the end
        self._boxes = make_boxes(scene, sides_for(scene, 1.0, width), images=True, narrowest=width)
        self._space = layout.Space(
            scene.container.lengths, scene.container.periodic, float(not scene.centres_to_walls)
        )
        self._plans = aligned((n,), PLAN)
        self._plans["at"] = self._boxes.coordinates(positions)
        self._partition = lists.empty_partition(self._boxes, n)
        self._calendar = empty_calendar(n)

    def grow(self, rate: float, end: float) -> None:
        """Some collisions per body at this rate, or until the scale is `end`."""
        d, n = self._scene.dimension, self._scene.count
        rate /= 2.0 * self._scene.largest_radius * self.scale
        left = (end / self.scale - 1.0) / rate
        counters = self._layout.zero_counters(2 * d)
        self._kernels.start(self.rows, self._plans, self._calendar, self._space, self._partition, rate)
        time = self._kernels.run_growing(
            self.rows, self._plans, self._calendar, self._space, self._partition, rate, counters,
            left, _COLLISIONS * n,
        )  # fmt: skip
        self._kernels.synchronise(self.rows, time, self._space, None)
        self.scale = end if time == left else self.scale * (1.0 + rate * time)
        self.rows[:, 2 * d + 1] = self._radii * self.scale
        self.collisions += int(counters.counts[self._layout.COLLISIONS])
        if time > 0.0:
            self.pressure = 1.0 + float(counters.sums[self._layout.VIRIAL].sum()) / (d * n * time)

    def settled(self, scale: float) -> np.ndarray:
        """(N, d) where the bodies are, at this scale. Raises SimulationError if any two would overlap."""
        d = self._scene.dimension
        self.rows[:, 2 * d + 1] = self._radii * scale
        if self._kernels.closest(self.rows, self._plans, self._space, self._partition) < 1.0:
            raise SimulationError("bodies that were to grow without overlap do overlap")
        positions, lengths = self.rows[:, :d], np.array(self._space.lengths)
        margin = np.outer(self._radii * scale, self._space.margin * ~np.array(self._space.periodic))
        # within a wall's reach, or a lap, to the last bit
        laps = np.array(self._space.periodic) * (np.array(positions >= lengths) - 1.0 * (positions < 0.0))
        positions = positions - laps * lengths
        positions = np.where(np.array(self._space.periodic) & (positions >= lengths), 0.0, positions)
        return np.clip(positions, margin, lengths - margin)
