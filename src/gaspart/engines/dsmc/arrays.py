"""Arrays of the DSMC engine's kernels: particles, grid and workspace."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from gaspart.engines.dsmc.defaults import accessible
from gaspart.engines.features.faces import (
    WALL_DRAWS,
    accommodations,
    kinds_and_levels,
    ramp_of,
    sliding_velocities,
)
from gaspart.errors import SceneError
from gaspart.kernels.dsmc.model import PADDED, Faces, Grid, Law, Particles, Workspace
from gaspart.kernels.model import ContactLaw, flight_dtype
from gaspart.kernels.physics.exact_sum import WIDTH
from gaspart.scene.accessible import Accessible
from gaspart.scene.scene import Scene
from gaspart.state.random import key_of
from gaspart.state.state import State

if TYPE_CHECKING:
    from gaspart.engines.dsmc.settings import DSMC

_COLLISION_DRAWS = 5  # the purpose of their random numbers, after those of thermal walls and kicks
MOST_KINDS = 2**16


def empty_particles(state: State) -> Particles:
    """Return empty arrays for the particles."""
    d, n = state.dimension, state.count
    rows = np.append(np.arange(2 * d + 1), 0)
    return Particles(np.empty((2 * d + 1, n)), rows, np.zeros((2, n), np.uint32), np.zeros((d, n), np.int32))


def grid_for(scene: Scene, state: State, cells: tuple[int, ...], threads: int) -> Grid:
    """Return the grid with a number of cells along each axis, where centres may be."""
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
        counts=np.zeros((threads, number), np.uint32),
        starts=np.zeros(number + 1, np.uint32),
    )


def kinds_of(state: State) -> tuple[np.ndarray, np.ndarray]:
    """Return the kinds of particles, and the kind (N,) of each particle.

    A kind has radius, mass and moment of inertia (K, 3). The kinds of the particles are (0,) if all particles
    are alike.
    """
    properties = np.stack([state.radii, state.masses, state.moments_of_inertia], axis=1)
    if not len(properties) or (properties == properties[0]).all():
        return properties[:1], np.zeros(0, np.uint16)
    kinds, which = np.unique(properties, axis=0, return_inverse=True)
    if len(kinds) > MOST_KINDS:
        raise SceneError("species", len(kinds), f"the DSMC engine takes {MOST_KINDS} kinds of particles")
    return kinds, which.ravel().astype(np.uint16)


def workspace_for(
    engine: DSMC, scene: Scene, state: State, step: float, seed: int | tuple[int, ...]
) -> Workspace:
    """Return the workspace of a step, with the tally at zero."""
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
"""Arrays of `Workspace` with counts, by thread."""


def faces_for(scene: Scene, threads: int) -> Faces | None:
    """Return the kinds of the container's faces, or None if no face is thermal."""
    if not scene.faces:
        return None
    velocities = sliding_velocities(scene)
    shear = None if velocities is None else np.zeros((threads, *velocities.shape, WIDTH), np.int64)
    return Faces(*kinds_and_levels(scene), velocities, shear, accommodations(scene), ramp_of(scene))


def law_for(law: ContactLaw | None) -> Law | None:
    """Convert the collision law for this engine's kernels; None if collisions are elastic and smooth."""
    return None if law is None else Law(law.normal, law.tangential, law.spins, law.viscous)
