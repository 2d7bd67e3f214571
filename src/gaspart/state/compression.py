"""Random packings that are denser than insertion can reach, by growing particles.

The particles move, collide and grow until they reach their final size, or jam (Lubachevsky & Stillinger, J.
Stat. Phys. 60, 561 (1990)). All diameters grow at constant rates, in proportion to their final values. During
growth all particles have mass 1, and their temperature is reset to 1 every few collisions. The final density
depends on the growth rate. If growth is fast, spheres jam at a packing fraction of about 0.64, and discs at
0.84. If it is slow, they crystallise.
"""

from __future__ import annotations

from contextlib import suppress
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from gaspart.errors import SceneError, SimulationError
from gaspart.kernels.memory import aligned_zeros
from gaspart.scene.scene import Scene
from gaspart.scene.species import Species
from gaspart.state.boxes import make_boxes, sides_for
from gaspart.state.insertion import per_particle, random_insertion
from gaspart.state.random import normals, stream

JAMMED = 1e6
"""Reduced pressure PV/(N k_B T) above which the particles are assumed to be jammed."""
RATES = (2.0**-4, 2.0**-7, 2.0**-10)
"""Growth rates of the largest diameter, divided by the thermal speed.

The function `compress_positions` tries them in this order.
"""

_START = {2: 0.3, 3: 0.2}  # packing fraction at which growth begins; insertion easily reaches it
_SPARE = 2.0**-36  # relative excess of the final size, so that rounding leaves no overlap
_COLLISIONS = 8  # collisions per particle between two resets of the temperature
_POSITIONS, _MOTION = 0, 4


@dataclass(frozen=True)
class Packing:
    """Result of `compress`: a packing of particles."""

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
    """Grow the particles of a scene to a packing fraction, or until they jam.

    The algorithm is by B. D. Lubachevsky and F. H. Stillinger, J. Stat. Phys. 60, 561 (1990). The temperature
    is reset to 1 every few collisions. If growth is fast, spheres jam at a packing fraction of about 0.64,
    and discs at 0.84. If growth is slow, they crystallise.

    Parameters
    ----------
    scene : Scene
        Scene without single particles, interior walls and fixed particles.
    seed : int or tuple of int, default 0
        Seed of the random initial state, from which the particles grow.
    growth_rate : float, default 0.0625, [1]
        Growth rate of the diameter of the largest particles, divided by the thermal speed of a particle.
    until : float or "jammed", optional
        Packing fraction at which growth ends, or "jammed" for growth until the particles jam. Default: the
        packing fraction of the scene.
    jammed : float, default 1e6, [1]
        Reduced pressure at which growth ends for any value of `until`.

    Returns
    -------
    Packing
        Positions, scale of the radii, packing fraction, pressure and number of collisions.

    Raises
    ------
    SceneError
        If the scene has single particles, interior walls or fixed particles, or if the particles jam before
        the requested packing fraction.

    Examples
    --------
    >>> import gaspart as gp
    >>> gas = gp.Scene(gp.Container((10.0, 10.0), boundary="periodic"), [gp.Species(20, radius=0.5)])
    >>> packing = gp.compress(gas, seed=1, until=0.7)
    >>> round(packing.packing_fraction, 4), round(packing.scale, 4)
    (0.7, 2.111)
    """
    if scene.particles or scene.walls or any(kind.fixed for kind in scene.species):
        raise SceneError(
            "arrangement", "compressed", "all particles must be free to move, without interior walls"
        )
    if scene.count == 0:
        return Packing(np.empty((0, scene.dimension)), 1.0, 0.0, 1.0, 0)
    d = scene.dimension
    unit = scene.packing_fraction
    target = unit if until is None else scene.closest_packing if until == "jammed" else until
    end = _root(target / unit, d)
    growing = _Growing(scene, seed, min(end, _root(_START[d] / unit, d)), end)
    while growing.scale < end * (1.0 + _SPARE) and growing.pressure < jammed:
        growing.grow(growth_rate, end * (1.0 + _SPARE))
    if growing.scale < end and until != "jammed":
        raise SceneError(
            "packing_fraction",
            target,
            f"particles that grow by {growth_rate:g} jam already at {unit * growing.scale**d:.4f}",
        )
    scale = min(end, growing.scale * (1.0 - _SPARE))
    fraction = replace(scene, species=_scale_species(scene, scale)).packing_fraction
    return Packing(growing.final_positions(scale), scale, fraction, growing.pressure, growing.collisions)


def compress_positions(scene: Scene, seed: int | tuple[int, ...]) -> np.ndarray:
    """Return positions for a scene from compression at the fastest sufficient rate of `RATES`. A growth rate
    is sufficient if the particles reach the packing fraction of the scene before they jam.
    """
    for rate in RATES[:-1]:
        with suppress(SceneError):
            return compress(scene, seed, rate).positions
    return compress(scene, seed, RATES[-1]).positions


def _root(value: float, dimension: int) -> float:
    """Return the square or cube root by bisection, because roots of libraries differ between machines."""
    low, high = 0.0, max(1.0, value)
    for _ in range(200):
        middle = 0.5 * (low + high)
        power = middle * middle if dimension == 2 else middle * middle * middle
        low, high = (middle, high) if power <= value else (low, middle)
    return low


def _scale_species(scene: Scene, scale: float) -> tuple[Species, ...]:
    """Return the species of a scene with scaled radii, at random positions."""
    return tuple(replace(kind, radius=kind.radius * scale, arrangement="random") for kind in scene.species)


class _Growing:
    """Growing particles of a scene; their radii are `scale` times the radii of the scene."""

    def __init__(self, scene: Scene, seed: int | tuple[int, ...], scale: float, end: float) -> None:
        from gaspart.kernels import model
        from gaspart.kernels.event import growth
        from gaspart.kernels.event.boxes import empty_lists
        from gaspart.kernels.event.queue import empty_queue
        from gaspart.kernels.physics import flight

        start = replace(scene, species=_scale_species(scene, scale), faces={})
        positions, _ = random_insertion(start, stream(seed, _POSITIONS))
        self._scene, self._growth, self._flight, self._kernels = scene, growth, flight, model
        d, n = scene.dimension, scene.count
        self.scale, self.pressure, self.collisions = scale, 1.0, 0
        self._radii = per_particle(scene, "radius").astype(float)
        self.flights = aligned_zeros((n,), model.flight_dtype(d))
        self.flights["position"] = positions
        self.flights["velocity"] = normals(stream(seed, _MOTION), n, d)
        self.flights["radius"] = self._radii * scale
        predictions = aligned_zeros((n,), model.PREDICTION)
        self.particles = model.Particles(self.flights, np.zeros((n, d), dtype=np.int64), predictions)
        # so that the same boxes suffice until the end
        width = 2.0 * scene.largest_radius * end * (1.0 + 2.0 * _SPARE)
        boxes = make_boxes(scene, sides_for(scene, width), images=True, narrowest=width)
        predictions["box"] = boxes.coordinates(positions)
        self.boxes = empty_lists(boxes, n)
        self._space = model.Space(
            scene.container.lengths, scene.container.periodic, float(not scene.centres_to_walls)
        )
        self._queue = empty_queue(n)

    def grow(self, rate: float, end: float) -> None:
        """Simulate a block of collisions with this growth rate; stop if the scale reaches `end`."""
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
        """Return the positions (N, d) at a scale. Raises SimulationError if two particles overlap."""
        self.flights["radius"] = self._radii * scale
        if self._growth.closest(self.particles, self.boxes, self._space) < 1.0:
            raise SimulationError("growth has left an overlap")
        positions, lengths = self.flights["position"], np.array(self._space.lengths)
        periodic = np.array(self._space.periodic)
        margin = np.outer(self._radii * scale, self._space.margin * ~periodic)
        # inside the walls or the periodic container, to the last bit
        images = periodic * (np.array(positions >= lengths) - 1.0 * (positions < 0.0))
        positions = positions - images * lengths
        positions = np.where(periodic & (positions >= lengths), 0.0, positions)
        return np.clip(positions, margin, lengths - margin)
