"""Initial states that are given instead of drawn: the positions, velocities and spins of another run."""

from __future__ import annotations

import numpy as np

from gaspart.errors import SceneError
from gaspart.scene.features import FEATURES, features
from gaspart.scene.scene import Scene
from gaspart.state.initial import assembled, masses_of
from gaspart.state.insertion import per_particle
from gaspart.state.overlaps import deepest_overlap
from gaspart.state.state import State

_REMEMBER = ("piston", "vibrating", "sticky", "lees_edwards", "vibrations")
"""Features that keep more than the positions, velocities and spins of particles, or depend on the time."""
_SINGLE = 2.0**-24
"""Largest relative error of a number in single precision, as in the frames of a trajectory."""


def given_state(
    scene: Scene, positions: np.ndarray, velocities: np.ndarray, spins: np.ndarray | None = None
) -> State:
    """The state at time 0 of a scene whose particles have these positions and velocities (N, d).

    spins: (N,) in 2D, (N, 3) in 3D, of rough particles; None: none. Positions beyond a wall by no more than
    the rounding of single precision are put at it. Raises SceneError for a scene that keeps more than these,
    numbers that are not finite or too few, and particles outside the container or in an interior wall.
    """
    for name in features(scene):
        if name in _REMEMBER:
            rule = "excludes a given initial state, which has only positions, velocities and spins"
            raise FEATURES[name].refuse(scene, rule)
    shape = scene.count, scene.dimension
    for name, values in (("positions", positions), ("velocities", velocities)):
        if np.shape(values) != shape:
            raise SceneError("initial", np.shape(values), f"must have {name} of the scene's shape, {shape}")
        if not np.isfinite(values).all():
            raise SceneError("initial", name, "must be finite numbers")
    velocities = np.where(np.isinf(masses_of(scene))[:, None], 0.0, velocities)
    turning = (scene.count,) if scene.dimension == 2 else (scene.count, 3)
    spins = np.zeros(turning) if spins is None or not scene.rough else np.array(spins, dtype=float)
    if spins.shape != turning or not np.isfinite(spins).all():
        raise SceneError("initial", spins.shape, f"must have finite spins of the scene's shape, {turning}")
    radii = per_particle(scene, "radius").astype(float)
    return assembled(scene, _inside(scene, np.array(positions, dtype=float), radii), velocities, spins)


def taken_state(scene: Scene, other: State) -> State:
    """The state at time 0 of a scene, with the positions, velocities and spins of `other`, of the same
    particles in a container of the same size.

    Raises SceneError, as `given_state`, and for other particles or another container.
    """
    if not isinstance(other, State):
        raise SceneError("initial", type(other).__name__, "must be a State, as of Simulation.state")
    if other.positions.shape != (scene.count, scene.dimension):
        has = f"{other.count} particles in {other.dimension} dimensions"
        raise SceneError("initial", has, f"the scene has {scene.count} in {scene.dimension}")
    lengths = scene.container.lengths
    if tuple(other.lengths) != lengths:
        raise SceneError("initial", tuple(other.lengths.tolist()), f"the container of the scene is {lengths}")
    for name, its, mine in (
        ("radius", other.radii, per_particle(scene, "radius").astype(float)),
        ("mass", other.masses, masses_of(scene)),
    ):
        if differ := np.flatnonzero(its != mine).tolist():
            n = differ[0]
            rule = f"particle {n} has this {name}, and {mine[n]:.17g} in the scene: species must be the same"
            raise SceneError("initial", float(its[n]), rule)
    return given_state(scene, other.positions, other.velocities, other.spins)


def check_apart(scene: Scene, state: State) -> None:
    """Raise SceneError if particles overlap by more than the rounding of positions in single precision."""
    if state.count == 0:
        return
    depth = deepest_overlap(state.positions, state.radii, state.lengths, scene.container.periodic)
    allowed = 2.0 * np.sqrt(state.dimension) * _SINGLE * max(scene.container.lengths)  # of two particles
    if depth * 2.0 * state.radii.min() > allowed:
        rule = (
            "is the part of their distance by which particles overlap, more than the rounding of frames: "
            "take the state of a run of the event engine"
        )
        raise SceneError("initial", float(f"{depth:.3g}"), rule)


def _inside(scene: Scene, positions: np.ndarray, radii: np.ndarray) -> np.ndarray:
    """(N, d) positions in [0, L) on periodic axes and between the walls on others."""
    lengths, periodic = np.array(scene.container.lengths), np.array(scene.container.periodic)
    margins = np.where(periodic | scene.centres_to_walls, 0.0, radii[:, None])
    slack = _SINGLE * lengths
    placed = np.where(periodic, positions - lengths * np.floor(positions / lengths), positions)
    placed = np.where(periodic & (placed >= lengths), 0.0, placed)  # rounded up
    outside = ~periodic & ((placed < margins - slack) | (placed > lengths - margins + slack))
    for n in np.flatnonzero(outside.any(axis=1)).tolist():
        raise SceneError("initial", tuple(positions[n].tolist()), f"particle {n} is not inside the container")
    placed = np.where(periodic, placed, np.clip(placed, margins, lengths - margins))
    for n in range(len(radii)) if scene.walls else ():
        if wall := scene.wall_at(tuple(placed[n].tolist()), float(radii[n] - slack.max())):
            raise SceneError("initial", tuple(placed[n].tolist()), f"particle {n} overlaps {wall}")
    return placed
