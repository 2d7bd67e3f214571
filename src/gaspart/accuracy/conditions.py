"""Local density and temperature of a steady scene, which bound the errors of DSMC.

A homogeneous gas has its mean values everywhere; a gas under gravity has the profiles of hydrostatics
(`column`), where theory knows them; any other gas has the values that a pilot run of the exact engine
measures.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np

from gaspart import theory
from gaspart.accuracy.column import Column, GravityColumn, compare_columns, gravity_column
from gaspart.analysis.run import open_run
from gaspart.engines.conditions import Layers
from gaspart.engines.dsmc.defaults import accessible
from gaspart.scene.faces import Thermal
from gaspart.scene.scene import Scene
from gaspart.state.state import State

_LAYERS = 12
"""Number of equally populated layers of a measured profile, in each axis."""
_CERTAIN = 4.0
"""Standard errors by which two of all layers differ if there is a gradient."""
_HELD = 0.02
"""Part of the particles beyond which a layer counts in the shortest scale."""


@dataclass(frozen=True)
class Conditions(Layers):
    """Layers of a scene, with the columns that theory knows.

    columns : under gravity, the columns of the real gas and of an ideal gas.
    """

    columns: tuple[Column, Column] | None = None

    @property
    def quickened(self) -> float:
        """Collision rate divided by the rate in a homogeneous gas as hot as at the start."""
        kinds = self.scene.moving_kinds
        d = self.scene.dimension
        start = sum(kind.count * kind.initial_temperature(d) for kind in kinds) / self.scene.count
        hotter = np.sqrt(self.temperature / (start or math.inf))
        mean = (self.share * self.crowding * self.contact * hotter).sum()
        return float(mean / even_conditions(self.scene, 1.0).contact[0])

    @cached_property
    def memory(self) -> float:
        """Effect |D / Enskog's - 1| of correlated collisions on the transport of spheres.

        The coefficients of discs grow with the size of the system; their estimate is the value at the same
        packing fraction.
        """
        densest = min(float(self.filled.max()), theory.ERPENBECK_WOOD_HIGHEST)
        return abs(float(theory.erpenbeck_wood_ratio(densest)) - 1.0) if densest > 0.0 else 0.0

    def of_points(self, observable: str, face: str | None) -> float | None:
        """Compute the relative difference of an observable between points and particles.

        `face` is the wall of a pressure. None if theory does not know the column.
        """
        return compare_columns(*self.columns, observable, self._top(face)) if self.columns else None

    def _top(self, face: str | None) -> bool | None:
        """Return True if a face of the container is at the top of a column.

        None for a face that is not across the axis of the column.
        """
        scene, axis = self.scene, self.axis
        if face is None or axis is None or face[0] != "xyz"[axis] or scene.gravity is None:
            return None
        return (scene.gravity[axis] < 0.0) == face.endswith("high")


def known_conditions(scene: Scene, start: State) -> Conditions | None:
    """Compute conditions by theory; None where theory knows nothing.

    The initial state `start` determines the energy of the scene.
    """
    if column := gravity_column(scene):
        try:
            return _of_column(scene, column, start)
        except ValueError:  # as of particles that come to rest as a crystal
            return None
    if not _is_even(scene):
        return None
    heat = max(scene.face_temperatures, default=0.0)
    return even_conditions(scene, heat or kinetic_temperature(scene, start))


def _is_even(scene: Scene) -> bool:
    """Return True if a scene becomes homogeneous from any start."""
    law = scene.restitution
    uneven = [
        scene.gravity is not None,
        law is not None and (law.dissipative or law.rough),
        scene.thermostat is not None,
        len(scene.face_temperatures) > 1,
        any(not isinstance(face, Thermal) or face.slides for face in scene.faces.values()),
        bool(scene.walls),
    ]
    return not any(uneven)


def kinetic_temperature(scene: Scene, start: State) -> float:
    """Compute the temperature k_B T of a state; 0 for particles at rest."""
    moving = np.isfinite(start.masses)
    freedom = scene.dimension * moving.sum() - sum(scene.conserved_axes)
    return float(2.0 * start.translational_energy / freedom) if freedom > 0 else 0.0


def even_conditions(scene: Scene, temperature: float) -> Conditions:
    """Return the conditions of a homogeneous gas."""
    return Conditions(scene, np.ones(1), np.ones(1), np.array([temperature]))


def _of_column(scene: Scene, pulled_scene: GravityColumn, start: State) -> Conditions:
    """Compute the conditions under gravity; raise ValueError where theory knows nothing."""
    energy, heat = pulled_scene.energy_of(start), max(scene.face_temperatures, default=None)
    real, ideal = (pulled_scene.equilibrate(energy, heat, is_ideal) for is_ideal in (False, True))
    z, numbers = real.heights, real.numbers.sum(axis=0)
    share = numbers * np.gradient(z)
    share /= share.sum()
    gradient = np.abs(np.gradient(np.log(np.maximum(numbers, 1e-300)), z))
    within = np.cumsum(share) < 1.0 - _HELD
    within[0] = True
    return Conditions(
        scene,
        share,
        numbers * pulled_scene.height / scene.count,
        np.full(len(z), real.temperature),
        pulled_scene.axis,
        1.0 / max(float(gradient[within].max()), 1e-300),
        (real, ideal),
    )


def measured_conditions(scene: Scene, path: Path) -> Conditions:
    """Measure conditions in a run, along the axis on which they change most.

    The measured part of the run counts, and the change of density and temperature. Raises SceneError for a
    file without all particles.
    """
    with open_run(path, None, sheared=True) as run:
        positions = run.positions[:, run.moving]
        thermal = (run.masses[run.moving] * (run.peculiar**2).sum(axis=2)) / run.dimension
    profiles = [_along(scene, k, positions[..., k], thermal) for k in range(scene.dimension)]
    return min(profiles, key=lambda profile: profile.scale)


def _along(scene: Scene, axis: int, positions: np.ndarray, thermal: np.ndarray) -> Conditions:
    """Compute layers that are equally populated in frames (T, M), along an axis."""
    lower, upper = (float(corner[axis]) for corner in accessible(scene))
    order = np.argsort(positions, axis=None)
    layers = np.array_split(order, _LAYERS)
    sorted_positions = positions.ravel()[order]
    ends = np.cumsum([len(layer) for layer in layers])[:-1]
    edges = np.concatenate([[lower], 0.5 * (sorted_positions[ends - 1] + sorted_positions[ends]), [upper]])
    width = np.maximum(np.diff(edges), 1e-12 * (upper - lower))
    middle, share = 0.5 * (edges[1:] + edges[:-1]), np.full(_LAYERS, 1.0 / _LAYERS)
    crowding = share * (upper - lower) / width
    temperature = np.array([float(thermal.ravel()[layer].mean()) for layer in layers])
    # Particles of one frame are independent, roughly; frames are taken as not.
    error = math.sqrt(2.0 * _LAYERS / max(1, positions.shape[1]) / max(1.0, len(positions) / 8.0))
    logarithms = [np.log(np.maximum(values, 1e-300)) for values in (crowding, temperature)]
    first, second = np.triu_indices(_LAYERS, 1)
    change = np.maximum(*(np.abs(values[second] - values[first]) for values in logarithms))
    certain = np.maximum(change - _CERTAIN * error, 0.0) / (middle[second] - middle[first])
    scale = 1.0 / float(certain.max()) if certain.max() > 0.0 else math.inf
    return Conditions(scene, share, crowding, temperature, axis, scale)
