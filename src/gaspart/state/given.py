"""Initial states from arrays or from another state.

The positions and velocities of particles and piston, and the displacement of sheared images, may come from
another run.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from gaspart.errors import SceneError
from gaspart.scene.boundaries import flow_of_rate
from gaspart.scene.faces import FLOW, GRADIENT
from gaspart.scene.features import FEATURES
from gaspart.scene.scene import Scene
from gaspart.scene.surfaces import FACES
from gaspart.scene.walls import MOVING_WALL
from gaspart.state.boxes import deepest_overlap
from gaspart.state.initial import assemble_state, in_flow, masses_of
from gaspart.state.insertion import per_particle
from gaspart.state.state import State

_SINGLE = 2.0**-24
"""Largest relative error of a number in single precision, the precision of trajectory frames."""
_FARTHEST = 2.0**40
"""Largest coordinate of a position on a periodic axis, in side lengths."""


def state_from_arrays(
    scene: Scene,
    positions: np.ndarray,
    velocities: np.ndarray,
    spins: np.ndarray | None = None,
    piston: np.ndarray | None = None,
    displaced: float | np.ndarray | None = None,
    vibrations: np.ndarray | None = None,
) -> State:
    """Return the state at time 0 of a scene from positions and velocities of its particles."""
    if "sticky" in scene.features:
        rule = "excludes a given initial state, which does not say which particles stick"
        raise FEATURES["sticky"].refuse(scene, rule)
    if scene.vibrates and vibrations is None:
        raise FEATURES["vibrations"].refuse(scene, "needs an initial state that has energies of vibrations")
    vibrations = np.array(vibrations, dtype=float) if scene.vibrates else np.zeros(scene.count)
    turning = (scene.count,) if scene.dimension == 2 else (scene.count, 3)
    spins = np.zeros(turning) if spins is None or not scene.rough else np.array(spins, dtype=float)
    shape = scene.count, scene.dimension
    for name, values, expected in (
        ("positions", positions, shape),
        ("velocities", velocities, shape),
        ("spins", spins, turning),
        ("vibrations", vibrations, shape[:1]),
    ):
        if np.shape(values) != expected:
            raise SceneError(
                "initial", np.shape(values), f"must have {name} of the scene's shape, {expected}"
            )
        if not np.isfinite(values).all():
            raise SceneError("initial", name, "must be finite numbers")
    velocities = np.where(np.isinf(masses_of(scene))[:, None], 0.0, velocities)
    radii = per_particle(scene, "radius").astype(float)
    coordinates = _inside(scene, np.array(positions, dtype=float), radii, _checked_piston(scene, piston))
    state = assemble_state(scene, coordinates, velocities, spins)
    return replace(
        state,
        piston=state.piston if piston is None else np.array(piston, dtype=float),
        displaced=state.displaced if displaced is None else float(displaced),
        vibrations=vibrations if scene.vibrates else None,
    )


def state_at_time_zero(scene: Scene, other: State) -> State:
    """Return the state at time 0 of a scene from the particles of another state."""
    if not isinstance(other, State):
        raise SceneError("initial", type(other).__name__, "must be a State, as of Simulation.state")
    if other.positions.shape != (scene.count, scene.dimension):
        has = f"{other.count} particles in {other.dimension} dimensions"
        raise SceneError("initial", has, f"must be as in the scene, {scene.count} in {scene.dimension}")
    for name in ("displaced", "shear_rate"):
        if not math.isfinite(getattr(other, name) or 0.0):
            raise SceneError("initial", getattr(other, name), f"must have a finite {name}")
    lengths = scene.container.lengths
    if tuple(other.lengths) != lengths:
        raise SceneError(
            "initial", tuple(other.lengths.tolist()), f"must be the container of the scene, {lengths}"
        )
    for name, its, mine in (
        ("radius", other.radii, per_particle(scene, "radius").astype(float)),
        ("mass", other.masses, masses_of(scene)),
    ):
        if differ := np.flatnonzero(its != mine).tolist():
            n = differ[0]
            rule = f"particle {n} has this {name}, and {mine[n]:.17g} in the scene: species must be the same"
            raise SceneError("initial", float(its[n]), rule)
    positions, velocities = _in_flow(scene, other)
    piston, displaced = _taken_piston(scene, other), _image_displacement(scene, other)
    return state_from_arrays(scene, positions, velocities, other.spins, piston, displaced, other.vibrations)


def _in_flow(scene: Scene, other: State) -> tuple[np.ndarray, np.ndarray]:
    """Return positions and velocities (N, d) of a state, in the flow of the scene."""
    positions, height = np.array(other.positions, dtype=float), scene.container.lengths[GRADIENT]
    # faces of a sheared scene have no special position
    if scene.shear_rate is not None and other.shear_rate is None:
        positions[:, GRADIENT] = _wrap_coordinates(positions[:, GRADIENT], height)
    if (scene.shear_rate or 0.0) == (other.shear_rate or 0.0):
        return positions, other.velocities
    peculiar = other.velocities - flow_of_rate(other.shear_rate, height, positions)
    return positions, in_flow(scene, other.masses, positions, peculiar)


def _image_displacement(scene: Scene, other: State) -> float | None:
    """Return the displacement of a state's images; raise SceneError if the scene lacks shear. Multiples of
    the length of the container are subtracted without rounding.
    """
    here = math.fmod(other.displaced or 0.0, scene.container.lengths[FLOW])
    if scene.shear_rate is not None:
        return here
    if here != 0.0 and scene.container.periodic[GRADIENT]:
        rule = (
            "is the displacement of images in a sheared gas; the images of the scene are not displaced: "
            "give it the face y_high of kind lees_edwards, to stop the flow with shear_rate: 0"
        )
        raise SceneError("initial", here, rule)
    return None


def _taken_piston(scene: Scene, other: State) -> np.ndarray | None:
    """Return position and velocity of the piston in a state; None if there is no piston. Raises SceneError if
    another face is the piston in the scene.
    """
    if other.piston is None:
        return None
    for n, face in scene.pistons:
        if other.piston_face != FACES[n]:
            rule = f"is the face that is the piston, {FACES[n]} in the scene: they must be the same"
            raise SceneError("initial", other.piston_face, rule)
        return other.piston if face.speed is None else np.array([other.piston[0], face.initial_velocity(n)])
    if scene.moving_wall is None:
        return None
    if other.piston_face != MOVING_WALL:
        rule = f"is the face that is the piston, {MOVING_WALL} in the scene: they must be the same"
        raise SceneError("initial", other.piston_face, rule)
    return other.piston


def _checked_piston(scene: Scene, piston: np.ndarray | None) -> np.ndarray | None:
    """Return position and velocity of a piston; raise SceneError if they are invalid."""
    axes = [n // 2 for n, _ in scene.pistons]
    if wall := scene.moving_wall:
        axes = [wall.axis]
    for axis in axes if piston is not None else ():
        values, length = np.asarray(piston), scene.container.lengths[axis]
        if values.shape != (2,) or not np.isfinite(values).all() or not 0.0 <= values[0] <= length:
            rule = f"must be a position from 0 to {length:g} and a velocity of the piston"
            raise SceneError("initial", values.tolist(), rule)
    return piston


def check_apart(scene: Scene, state: State) -> None:
    """Raise SceneError if particles overlap by more than rounding in single precision."""
    if state.count == 0:
        return
    positions, radii = state.positions, state.radii
    if state.displaced is not None:
        positions, radii = _with_images(state)
    depth = deepest_overlap(positions, radii, state.lengths, scene.image_axes)
    allowed = 2.0 * np.sqrt(state.dimension) * _SINGLE * max(scene.container.lengths)  # of two particles
    if depth * 2.0 * state.radii.min() > allowed:
        rule = (
            "is the relative overlap of two particles; it exceeds the rounding of frames: "
            "take the state of a run of the event engine"
        )
        raise SceneError("initial", float(f"{depth:.3g}"), rule)


def _with_images(state: State) -> tuple[np.ndarray, np.ndarray]:
    """Return positions (M, d) and radii (M,) of a sheared gas's particles and images. The result includes
    only images below the gas, and of these only the images that particles may touch.
    """
    near = state.lengths[GRADIENT] - state.positions[:, GRADIENT] <= 2.0 * state.radii.max()
    images = state.positions[near]
    images[:, GRADIENT] -= state.lengths[GRADIENT]
    images[:, FLOW] = _wrap_coordinates(images[:, FLOW] - state.displaced, state.lengths[FLOW])
    return np.concatenate([state.positions, images]), np.concatenate([state.radii, state.radii[near]])


def _wrap_coordinates(values: np.ndarray, lengths: np.ndarray | float) -> np.ndarray:
    """Return the coordinates of the periodic images inside the container, in [0, L)."""
    placed = values - lengths * np.floor(values / lengths)
    return np.where(placed >= lengths, 0.0, placed)  # rounding may give L itself


def _inside(scene: Scene, positions: np.ndarray, radii: np.ndarray, piston: np.ndarray | None) -> np.ndarray:
    """Return positions (N, d) inside the container; raise SceneError for a particle outside. On periodic axes
    with images at fixed distances, the returned positions are in [0, L). On other axes they are between the
    walls or the piston.
    """
    lengths, periodic = np.array(scene.container.lengths), np.array(scene.image_axes)
    slack = _SINGLE * lengths
    low, high = _bounds(scene, positions, radii, piston)
    for n in np.flatnonzero((np.abs(positions) > _FARTHEST * lengths).any(axis=1)).tolist():
        rule = f"particle {n} is so many containers away that rounding changes its position"
        raise SceneError("initial", tuple(positions[n].tolist()), rule)
    placed = np.where(periodic, _wrap_coordinates(positions, lengths), positions)
    outside = ~periodic & ((placed < low - slack) | (placed > high + slack))
    for n in np.flatnonzero(outside.any(axis=1)).tolist():
        rule = f"particle {n} is not inside the container"
        rule += "" if piston is None else f", or beyond the piston at {piston[0]:g}"
        raise SceneError("initial", tuple(positions[n].tolist()), rule)
    placed = np.where(periodic, placed, np.clip(placed, low, high))
    for n in range(len(radii)) if scene.walls and scene.moving_wall is None else ():
        if wall := scene.wall_at(tuple(placed[n].tolist()), float(radii[n] - slack.max())):
            raise SceneError("initial", tuple(placed[n].tolist()), f"particle {n} overlaps {wall}")
    return placed


def _bounds(
    scene: Scene, positions: np.ndarray, radii: np.ndarray, piston: np.ndarray | None
) -> tuple[np.ndarray, np.ndarray]:
    """Return the lowest and highest coordinates, (N, d) each, that particles may have. The bounds follow from
    the walls and the piston. With a moving interior wall, the bounds of a particle depend on the side of the
    wall where it is. A particle passes through a sheared face when its centre reaches the face.
    """
    walled = ~np.array(scene.container.periodic)
    margins = np.where(walled & (not scene.centres_to_walls), radii[:, None], 0.0)
    low, high = margins.copy(), np.array(scene.container.lengths) - margins
    if scene.shear_rate is not None:
        high[:, GRADIENT] = np.nextafter(high[:, GRADIENT], 0.0)
    if wall := scene.moving_wall:
        axis, position = wall.axis, wall.position if piston is None else piston[0]
        above = positions[:, axis] > position
        low[above, axis] = position + radii[above]
        high[~above, axis] = position - radii[~above]
    if piston is None:
        return low, high
    for n, _ in scene.pistons:
        bound, inwards = (high, -1.0) if n % 2 else (low, 1.0)
        bound[:, n // 2] = piston[0] + inwards * margins[:, n // 2]
    return low, high
