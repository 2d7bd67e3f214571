"""Random packings denser than insertion can make: particles that move, collide and grow until they are as
large as wanted, or jam (Lubachevsky & Stillinger, J. Stat. Phys. 60, 561 (1990)).

All particles grow in proportion, at a constant rate of their diameters; they move as particles of mass 1
whose temperature is brought back to 1 every few collisions. How dense they become depends on how slowly
they grow: fast, spheres jam at a packing fraction of about 0.64 and discs at 0.84; slowly, they crystallise.
"""

from __future__ import annotations

from contextlib import suppress
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from gaspart.errors import SceneError, SimulationError
from gaspart.kernels.memory import aligned
from gaspart.scene.limits import closest_packing
from gaspart.scene.scene import Scene
from gaspart.scene.species import Species
from gaspart.state.boxes import make_boxes, sides_for
from gaspart.state.insertion import per_particle, random_insertion
from gaspart.state.random import normals, stream

JAMMED = 1e6
"""Reduced pressure PV/(N k_B T) at which particles count as jammed."""
RATES = (2.0**-4, 2.0**-7, 2.0**-10)
"""Growth of the largest diameter per thermal speed: the rates that `compressed` tries, in this order."""

_START = {2: 0.3, 3: 0.2}  # packing fraction at which growth begins, within easy reach of insertion
_SPARE = 2.0**-36  # by which particles are grown larger than wanted, so that rounding leaves no overlap
_COLLISIONS = 8  # per particle between two resettings of the temperature
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

    The diameter of the largest particles grows by `growth_rate` times the thermal speed of a particle.

    Raises SceneError for scenes with particles or walls of their own, and if particles jam before they are as
    dense as wanted.
    """
    if scene.particles or scene.walls or any(kind.fixed for kind in scene.species):
        raise SceneError(
            "arrangement", "compressed", "all particles must be free to move, without interior walls"
        )
    if scene.count == 0:
        return Packing(np.empty((0, scene.dimension)), 1.0, 0.0, 1.0, 0)
    d = scene.dimension
    unit = scene.packing_fraction
    wanted = unit if until is None else closest_packing(scene) if until == "jammed" else until
    end = _root(wanted / unit, d)
    growing = _Growing(scene, seed, min(end, _root(_START[d] / unit, d)), end)
    while growing.scale < end * (1.0 + _SPARE) and growing.pressure < jammed:
        growing.grow(growth_rate, end * (1.0 + _SPARE))
    if growing.scale < end and until != "jammed":
        raise SceneError(
            "packing_fraction",
            wanted,
            f"particles that grow by {growth_rate:g} jam already at {unit * growing.scale**d:.4f}",
        )
    scale = min(end, growing.scale * (1.0 - _SPARE))
    fraction = replace(scene, species=_scaled(scene, scale)).packing_fraction
    return Packing(growing.final_positions(scale), scale, fraction, growing.pressure, growing.collisions)


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
    """The particles of a scene, at `scale` times their radii, in progress."""

    def __init__(self, scene: Scene, seed: int | tuple[int, ...], scale: float, end: float) -> None:
        from gaspart.kernels import model
        from gaspart.kernels.event import growth
        from gaspart.kernels.event.box_lists import empty_lists
        from gaspart.kernels.event.queue import empty_queue
        from gaspart.kernels.physics import flight

        start = replace(scene, species=_scaled(scene, scale), faces={})
        positions, _ = random_insertion(start, stream(seed, _POSITIONS))
        self._scene, self._growth, self._flight, self._kernels = scene, growth, flight, model
        d, n = scene.dimension, scene.count
        self.scale, self.pressure, self.collisions = scale, 1.0, 0
        self._radii = per_particle(scene, "radius").astype(float)
        self.flights = aligned((n,), model.flight_dtype(d))
        self.flights["position"] = positions
        self.flights["velocity"] = normals(stream(seed, _MOTION), n, d)
        self.flights["radius"] = self._radii * scale
        predictions = aligned((n,), model.PREDICTION)
        self.particles = model.Particles(self.flights, np.zeros((n, d), dtype=np.int64), predictions)
        width = 2.0 * scene.largest_radius * end * (1.0 + 2.0 * _SPARE)  # so that boxes serve to the end
        boxes = make_boxes(scene, sides_for(scene, width), images=True, narrowest=width)
        predictions["box"] = boxes.coordinates(positions)
        self.boxes = empty_lists(boxes, n)
        self._space = model.Space(
            scene.container.lengths, scene.container.periodic, float(not scene.centres_to_walls)
        )
        self._queue = empty_queue(n)

    def grow(self, rate: float, end: float) -> None:
        """Some collisions per particle at this rate, or until the scale is `end`."""
        d, n = self._scene.dimension, self._scene.count
        rate /= 2.0 * self._scene.largest_radius * self.scale
        remaining = (end / self.scale - 1.0) / rate
        tally = self._kernels.empty_tally(2 * d)
        common = self.particles, self._queue, self.boxes, self._space
        self._growth.start(*common, rate)
        time = self._growth.run(*common, tally, rate, remaining, _COLLISIONS * n)
        self._flight.restart_clocks(self.flights, time, self._space, None)
        self.scale = end if time == remaining else self.scale * (1.0 + rate * time)
        self.flights["radius"] = self._radii * self.scale
        self.collisions += int(tally.counts[self._kernels.COLLISIONS])
        if time > 0.0:
            self.pressure = 1.0 + float(tally.sums[self._kernels.VIRIAL].sum()) / (d * n * time)

    def final_positions(self, scale: float) -> np.ndarray:
        """(N, d) positions at this scale. Raises SimulationError if any two particles would overlap."""
        self.flights["radius"] = self._radii * scale
        if self._growth.closest(self.particles, self.boxes, self._space) < 1.0:
            raise SimulationError("growth has left an overlap")
        positions, lengths = self.flights["position"], np.array(self._space.lengths)
        periodic = np.array(self._space.periodic)
        margin = np.outer(self._radii * scale, self._space.margin * ~periodic)
        # within a wall's reach, or an image of the container, to the last bit
        images = periodic * (np.array(positions >= lengths) - 1.0 * (positions < 0.0))
        positions = positions - images * lengths
        positions = np.where(periodic & (positions >= lengths), 0.0, positions)
        return np.clip(positions, margin, lengths - margin)
