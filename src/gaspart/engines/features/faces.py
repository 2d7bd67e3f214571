"""Faces of the container with a kind, for all engines, and what particles keep at them."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from gaspart.engines.features.open_faces import opened
from gaspart.engines.features.part import Part
from gaspart.engines.features.piston import piston_of
from gaspart.engines.features.vibrating import motion_of
from gaspart.kernels.model import NONE, STICKY, Faces, Ramp, Sliding
from gaspart.kernels.obstacles.face import RULES
from gaspart.kernels.physics.running_sum import values
from gaspart.scene.faces import FACES
from gaspart.scene.scene import Scene
from gaspart.state.random import key_of
from gaspart.state.state import State
from gaspart.state.wells import places_in_wells, well_energies, wells_of

WALL_DRAWS = 2
"""The purpose of the random numbers of thermal walls, after those of the initial state."""


def kinds_and_levels(scene: Scene) -> tuple[np.ndarray, np.ndarray]:
    """(2d,), (2d,) the kernels' kinds of the container's faces, and their levels: temperatures or momenta."""
    surfaces = (scene.faces.get(name) for name in FACES[: 2 * scene.dimension])
    names, levels = zip(*(surface.rule if surface else ("hard", 0.0) for surface in surfaces), strict=True)
    return np.array([RULES[name] for name in names], dtype=np.int64), np.array(levels, dtype=float)


def sliding_velocities(scene: Scene) -> np.ndarray | None:
    """(2d, d) the velocities of the container's faces, None if it has no `has_dragged_faces`."""
    if not scene.drags_faces:
        return None
    velocities = np.zeros((2 * scene.dimension, scene.dimension))
    for n, face in scene.sliding_faces:
        velocities[n] = face.velocity
    return velocities


def accommodations(scene: Scene) -> np.ndarray | None:
    """(2d,) the fractions of hits of the container's faces after which velocities are drawn, None if all
    are."""
    if not scene.partial_faces:
        return None
    fractions = np.ones(2 * scene.dimension)
    for n, face in scene.partial_faces:
        fractions[n] = face.accommodation
    return fractions


def ramp_of(scene: Scene) -> Ramp | None:
    """The temperatures that vary along faces, None without any."""
    if not scene.ramps:
        return None
    axes, high = np.full(2 * scene.dimension, NONE), np.zeros(2 * scene.dimension)
    for n, face in scene.ramps:
        axes[n], high[n] = face.varies_along, face.temperatures[1]
    return Ramp(axes, high)


def has_special_faces(scene: Scene) -> bool:
    """Whether particles meet faces with a kind, other than periodic ones."""
    return bool(scene.faces) and scene.shear_rate is None


def special_faces(scene: Scene, state: State, seed: int | tuple[int, ...], unit_mass: float) -> Faces:
    """The kinds of the container's faces as the kernels' `Faces`, in units of `unit_mass`."""
    kind, level = kinds_and_levels(scene)
    depths, widths = wells_of(scene)
    velocities, ramp = sliding_velocities(scene), ramp_of(scene)
    return Faces(
        kind=kind,
        level=level / unit_mass,
        depth=depths / unit_mass,
        width=widths,
        place=places_in_wells(scene, state.positions, state.radii),
        held=np.zeros(state.positions.shape),
        draws=np.zeros(state.count, dtype=np.int64),
        key=key_of(seed, WALL_DRAWS),
        sticky=kind == STICKY if (kind == STICKY).any() else None,
        motion=motion_of(scene),
        piston=piston_of(scene, state, unit_mass),
        sliding=None if velocities is None else Sliding(velocities, np.zeros((velocities.size, 2))),
        accommodation=accommodations(scene),
        ramp=ramp._replace(high=ramp.high / unit_mass) if ramp else None,
        open=opened(scene, state),
    )


def face_energy(scene: Scene) -> float:
    """Upper estimate of the energy that a thermal face or wall or a well gives a particle, at whatever speed
    it moves."""
    hottest = max(scene.face_temperatures, default=0.0)
    deepest = max((getattr(face, "depth", 0.0) for face in scene.faces.values()), default=0.0)
    fastest = max((math.hypot(*(face.velocity or ())) for _, face in scene.sliding_faces), default=0.0)
    heaviest = max((kind.mass for kind in scene.kinds), default=0.0) if fastest else 0.0
    return scene.dimension * hottest + 2.0 * deepest + heaviest * fastest**2


class FacesPart(Part):
    """Faces with a kind, in units of `unit_mass`: which particles are in a well or stuck, with what energy,
    how often random numbers were drawn, and what momentum faces were given along themselves. lightest: the
    least mass of a particle."""

    def __init__(self, scene: Scene, faces: Faces, unit_mass: float, lightest: float = np.inf) -> None:
        self._shear = faces.sliding.shear if faces.sliding else None
        arrays = {key: getattr(faces, key) for key in ("place", "held", "draws")}
        super().__init__(arrays if self._shear is None else {**arrays, "shear": self._shear})
        self._scene, self._unit_mass = scene, unit_mass
        self.gained = face_energy(scene) / lightest

    @property
    def stored(self) -> float:
        """The energy of particles that stick to a face."""
        return float(self.arrays["held"].sum()) * self._unit_mass

    def write(self, state: State, clock: float) -> None:
        """Write the energies in wells, and add those of particles that stick to a face."""
        state.well_energies = well_energies(self._scene, self.arrays["place"])
        if state.vibrations is not None:
            state.vibrations += self.arrays["held"].sum(axis=1) * self._unit_mass

    def reset(self, clock: float) -> None:
        """Begin to count from zero."""
        if self._shear is not None:
            self._shear[...] = 0.0

    def counts(self, clock: float) -> dict[str, Any]:
        """The momentum that faces were given along themselves, by the field of `Tally`."""
        if self._shear is None:
            return {}
        shear = values(self._shear).reshape(-1, self._scene.dimension) * self._unit_mass
        return {"wall_shear": np.pad(shear, ((0, len(self._scene.walls)), (0, 0)))}
