"""Arrays of the DSMC engine's kernels: particles, grid and workspace."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from gaspart.engines.dsmc.cells import spreads
from gaspart.engines.features.faces import (
    WALL_DRAWS,
    accommodations,
    kinds_and_levels,
    ramp_of,
    sliding_velocities,
)
from gaspart.errors import SceneError
from gaspart.kernels.dsmc.cells import LEAST_PART
from gaspart.kernels.dsmc.enskog import Dense
from gaspart.kernels.dsmc.model import PADDED, Faces, Grid, Law, Particles, Workspace
from gaspart.kernels.model import ContactLaw, Open, flight_dtype
from gaspart.kernels.physics.exact_sum import WIDTH
from gaspart.scene.accessible import Accessible
from gaspart.scene.scene import Scene
from gaspart.scene.sizes import ball_volume
from gaspart.state.random import key_of
from gaspart.state.state import State
from gaspart.theory.discretisation import BEND, HIGHEST, SLOPE
from gaspart.theory.rates import accessible

if TYPE_CHECKING:
    from gaspart.engines.dsmc.settings import DsmcSettings


_COLLISION_DRAWS = 5  # stream number of these random numbers, after those of thermal walls and kicks
_MOST_KINDS = 2**16


def empty_particles(state: State) -> Particles:
    """Return empty arrays for the particles."""
    d, n = state.dimension, state.count
    rows = np.append(np.arange(2 * d + 1), 0)
    return Particles(np.empty((2 * d + 1, n)), rows, np.zeros((2, n), np.uint32), np.zeros((d, n), np.int32))


def grid_for(scene: Scene, state: State, cells: tuple[int, ...], threads: int) -> Grid:
    """Return a grid over the accessible volume; open faces add a counter for slots without a particle."""
    lower, upper = accessible(scene)
    per_side = np.array(cells, dtype=np.int64)
    strides = np.append(np.cumprod(per_side[:0:-1])[::-1], 1)
    number = int(per_side.prod())
    return Grid(
        per_side=per_side,
        origin=lower,
        inverse=per_side / (upper - lower),
        strides=strides,
        volume=float(((upper - lower) / per_side).prod()),
        cell=np.zeros(state.count, np.uint32),
        order=np.zeros(state.count, np.uint32),
        counts=np.zeros((threads, number + scene.is_open), np.uint32),
        starts=np.zeros(number + 1, np.uint32),
    )


def kinds_of(state: State) -> tuple[np.ndarray, np.ndarray]:
    """Return the kinds of particles, and the kind number (N,) of each particle. The kinds are rows of radius,
    mass and moment of inertia, (K, 3); (0,) if all particles are identical.
    """
    properties = np.stack([state.radii, state.masses, state.moments_of_inertia], axis=1)
    if not len(properties) or (properties == properties[0]).all():
        return properties[:1], np.zeros(0, np.uint16)
    kinds, which = np.unique(properties, axis=0, return_inverse=True)
    if len(kinds) > _MOST_KINDS:
        raise SceneError("species", len(kinds), f"the DSMC engine takes {_MOST_KINDS} kinds of particles")
    return kinds, which.ravel().astype(np.uint16)


def workspace_for(
    engine: DsmcSettings, scene: Scene, state: State, step: float, seed: int | tuple[int, ...]
) -> Workspace:
    """Return the workspace of a step, with all counters at zero."""
    kinds, which = kinds_of(state)
    threads, faces, d = engine.threads, 2 * scene.dimension, scene.dimension
    radius, mass, inertia = (np.ascontiguousarray(column) for column in kinds.T)
    inverse = np.zeros((0, faces))
    if scene.has_unequal_areas:
        inverse = 1.0 / Accessible(scene).areas(radius)
    return Workspace(
        margin=float(not scene.centres_to_walls),
        dt=step,
        clock=np.zeros(1, np.int64),
        kind=which,
        radius=radius,
        mass=mass,
        inertia=inertia,
        largest=scene.largest_radius,
        key=(key_of(seed, _COLLISION_DRAWS) & np.uint64(0xFFFFFFFF)).astype(np.uint32),
        wall_key=key_of(seed, WALL_DRAWS),
        flights=np.zeros((threads, 2), flight_dtype(d)),
        inverse_mass=np.zeros((threads, 2)),
        inverse_inertia=np.zeros((threads, 2)),
        pair_spins=np.zeros((threads, 2, 3)),
        sums=np.zeros((threads, 2, 2)),
        counts=np.zeros((threads, PADDED), np.int64),
        virial=np.zeros((threads, WIDTH), np.int64),
        loss=np.zeros((threads, WIDTH), np.int64),
        wall_hits=np.zeros((threads, faces), np.int64),
        wall_impulse=np.zeros((threads, faces, WIDTH), np.int64),
        wall_heat=np.zeros((threads, faces, WIDTH), np.int64),
        inverse_area=inverse,
        per_area=np.zeros((threads, faces if len(inverse) else 0, d + 1, WIDTH), np.int64),
    )


TALLY = ("counts", "virial", "loss", "wall_hits", "wall_impulse", "wall_heat")
"""Names of the arrays in `Workspace` that contain counters for each thread."""


def faces_for(scene: Scene, threads: int, opened: Open | None) -> Faces | None:
    """Return the container's faces for the kernels, or None if all are hard or periodic."""
    if not scene.faces:
        return None
    velocities = sliding_velocities(scene)
    shear = None if velocities is None else np.zeros((threads, *velocities.shape, WIDTH), np.int64)
    present = opened.present if opened else None
    return Faces(*kinds_and_levels(scene), velocities, shear, accommodations(scene), ramp_of(scene), present)


def law_for(law: ContactLaw | None) -> Law | None:
    """Return the collision law for the kernels; None if collisions are elastic and smooth."""
    return None if law is None else Law(law.normal, law.tangential, law.spins, law.viscous)


# Arrays of the Enskog collision scheme.


_SAMPLES = 4000.0
"""Number of particles from which the density of a cell is averaged, over one or more steps."""
_LEAST_PART = 0.25
"""Smallest part of a cell by which collision rates are divided, because all cells then have more trials."""
_MOST_DENSE_KINDS = 16
"""Maximum number of kinds of particles in a dense gas. With many kinds most trials fail."""

_FEWEST_CELLS = 64
"""Minimum number of cells for several threads. Fewer cells form a single slab and are processed one after
another.
"""


def is_uniform(scene: Scene) -> bool:
    """Return True if the density is uniform at all times, and therefore known."""
    return scene.is_periodic and spreads(scene)


def moved_fields(fields: np.ndarray, before: Grid, after: Grid) -> np.ndarray:
    """Return fields (2, cells) of a grid, evaluated at the cell centres of another."""
    per_side = tuple(after.per_side)
    centres = np.stack(np.unravel_index(np.arange(len(after.starts) - 1), per_side)) + 0.5
    ratio = (before.per_side / after.per_side)[:, None]
    indices = np.minimum((centres * ratio).astype(np.int64), before.per_side[:, None] - 1)
    return fields[:, np.ravel_multi_index(tuple(indices), tuple(before.per_side))]


def slabs_of(per_side: np.ndarray, reach: np.ndarray) -> tuple[int, np.ndarray]:
    """Return the axis along which slabs divide the cells, and the first cell of each slab. The result is an
    even number of slabs, each at least two `reach` wide, with the end of the last, or a single slab.
    """
    numbers = 2 * (per_side // (4 * reach))
    axis = int(numbers.argmax())
    number = int(numbers[axis]) if per_side.prod() >= _FEWEST_CELLS and numbers[axis] > 2 else 1
    return axis, np.arange(number + 1) * per_side[axis] // number


def dense_for(scene: Scene, state: State, grid: Grid, kinds: int) -> Dense:
    """Return the arrays of the Enskog model for several kinds of particles; SceneError if it excludes the
    scene.
    """
    d, cells, sigma = scene.dimension, len(grid.starts) - 1, 2.0 * scene.largest_radius
    if kinds > _MOST_DENSE_KINDS:
        most = _MOST_DENSE_KINDS
        rule = f'takes {most} kinds of particles at most; the "event" and "step" engines take any number'
        raise SceneError("model", "enskog", rule)
    if min(scene.container.lengths) < sigma:
        raise SceneError("lengths", scene.container.lengths, 'model = "enskog" needs sides of a diameter')
    volume = grid.volume * cells
    sums = [float((state.radii**power).sum()) for power in (d, d - 1)]
    if (filled := sums[0] * ball_volume(d) / volume) > HIGHEST:
        rule = f'model = "enskog" has contact values up to {HIGHEST:g}'
        raise SceneError("packing_fraction", round(filled, 4), rule)
    fields = np.repeat(np.array(sums)[:, None] * ball_volume(d) / volume, cells, axis=1)
    steps = max(1.0, _SAMPLES * cells / max(1, state.count))
    around = scene.is_periodic
    reach = np.array([math.ceil(sigma * inverse) for inverse in grid.inverse], dtype=np.int64)
    axis, slabs = slabs_of(grid.per_side, reach)
    drift = state.momentum / state.masses.sum() if around and state.count else np.zeros(d)
    return Dense(
        fields=fields,
        speed=np.zeros(cells),
        near_speed=np.zeros(cells),
        near_count=np.zeros(cells),
        room=np.zeros(cells),
        reach=reach,
        wraps=np.array(scene.container.periodic),
        axis=axis,
        slabs=slabs,
        drift=drift,
        ball=ball_volume(d),
        weight=0.0 if is_uniform(scene) else 1.0 / steps,
        slope=SLOPE[d],
        bend=BEND[d],
        highest=np.ones(1),
        least_part=least_part(scene, np.unique(state.radii), grid),
        half=np.zeros(1, np.int64),
    )


def least_part(scene: Scene, radii: np.ndarray, grid: Grid) -> float | None:
    """Return the smallest part of a cell that particles of some radius (K,) can reach, see `Dense`."""
    if len(radii) < 2 or scene.centres_to_walls or scene.is_periodic:
        return None
    least = 1.0
    for radius in radii:
        part = 1.0
        for axis in scene.walled_axes:
            low = (radius - radii[0]) * grid.inverse[axis]
            covered = np.minimum(np.arange(1.0, grid.per_side[axis] + 1.0), grid.per_side[axis] - low)
            covered -= np.maximum(np.arange(float(grid.per_side[axis])), low)
            part *= float(covered[covered > 0.0].min().clip(LEAST_PART, 1.0))
        least = min(least, part)
    return max(least, _LEAST_PART)
