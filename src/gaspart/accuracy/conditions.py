"""Local density and temperature of a steady scene, and barometric columns under gravity.

In a homogeneous gas the local values are equal to the mean values. For a gas under gravity, the profiles
follow from hydrostatics (`gaspart.theory.columns`), if theory covers the gas. For all other gases, a pilot
run of the exact engine measures the values. The conditions are used to bound the errors of DSMC.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np

from gaspart import theory
from gaspart.analysis.observables import OBSERVABLES
from gaspart.analysis.run import open_run
from gaspart.engines.conditions import Layers
from gaspart.engines.dsmc.defaults import accessible
from gaspart.errors import SceneError
from gaspart.scene.faces import LeesEdwards, Thermal, Vibrating
from gaspart.scene.scene import Scene
from gaspart.state.state import State
from gaspart.theory.columns import Column, GravityColumn

# Columns of gas in hydrostatic equilibrium, at the temperature that corresponds to the energy of the scene.


def gravity_column(scene: Scene) -> GravityColumn | None:
    """Return the column of a scene under gravity, or None without a theory.

    Theory covers equal-sized particles that lose no energy, between hard walls or walls at one temperature.
    """
    pull = [(k, g) for k, g in enumerate(scene.gravity or ()) if g]
    kinds = [kind for kind in scene.kinds if kind.count]
    law, thermal = scene.restitution, scene.face_temperatures
    if len(pull) != 1 or scene.thermostat is not None or scene.walls or not kinds:
        return None
    if law is not None and (law.dissipative or law.rough):
        return None
    if len({kind.radius for kind in kinds}) > 1 or not all(kind.alike and not kind.fixed for kind in kinds):
        return None
    if len(thermal) > 1 or any(not isinstance(face, Thermal) or face.slides for face in scene.faces.values()):
        return None
    (k, g), (lower, upper) = pull[0], accessible(scene)
    sides = upper - lower
    masses = sorted({kind.mass for kind in kinds})
    counts = [sum(kind.count for kind in kinds if kind.mass == mass) for mass in masses]
    return GravityColumn(
        scene.dimension, k, g < 0.0, abs(g), float(sides[k]), float(np.delete(sides, k).prod()),
        np.array(masses), np.array(counts, dtype=float), 2.0 * kinds[0].radius,
    )  # fmt: skip


def compare_columns(real: Column, ideal: Column, observable: str, top: bool | None) -> float:
    """Compute the relative difference of an observable between a column of ideal and of real gas.

    `top` is used only for a pressure: True for the wall at the top, None for all walls together.
    """
    differences = {
        "collision_rate": abs(ideal.collisions / real.collisions - 1.0),
        "temperature": abs(ideal.temperature / real.temperature - 1.0),
        "density": _of_profiles(real, ideal),
    }
    if OBSERVABLES[observable].of_impulses and top is not None:
        exact = real.pressure(top)
        return abs(ideal.pressure(top) / exact - 1.0) if exact > 0.0 else math.inf
    return differences.get(observable, max(differences.values()))


def _of_profiles(real: Column, ideal: Column) -> float:
    """Compute the root mean square of the difference of two density profiles, relative to the first."""
    exact = real.numbers.sum(axis=0)
    other = np.interp(real.heights, ideal.heights, ideal.numbers.sum(axis=0), right=0.0)
    return float(np.sqrt(((other - exact) ** 2).sum() / (exact**2).sum()))


_LAYERS = 12
"""Number of layers per axis in a measured profile; all layers contain equally many particles."""
_CERTAIN = 4.0
"""Difference between two layers, in standard errors, beyond which the profile has a gradient."""
_HELD = 0.02
"""Smallest fraction of the particles in a layer that counts in the shortest length scale."""


@dataclass(frozen=True)
class Conditions(Layers):
    """Local state of a scene in layers, and the columns from theory.

    columns : columns : columns of the real gas and of the ideal gas under gravity.
    """

    columns: tuple[Column, Column] | None = None

    @property
    def quickened(self) -> float:
        """Collision rate divided by the rate in a homogeneous gas at the initial temperature."""
        kinds = self.scene.moving_kinds
        d = self.scene.dimension
        start = sum(kind.count * kind.initial_temperature(d) for kind in kinds) / self.scene.count
        hotter = np.sqrt(self.temperature / (start or math.inf))
        mean = (self.share * self.crowding * self.contact * hotter).sum()
        return float(mean / even_conditions(self.scene, 1.0).contact[0])

    @cached_property
    def memory(self) -> float:
        """Effect of correlated collisions on the transport coefficients of spheres, |D / D_Enskog - 1|.

        For discs the transport coefficients depend on the size of the system, so the value for spheres at the
        same packing fraction is used as an estimate.
        """
        densest = min(float(self.filled.max()), theory.ERPENBECK_WOOD_HIGHEST)
        return abs(float(theory.erpenbeck_wood_ratio(densest)) - 1.0) if densest > 0.0 else 0.0

    def of_points(self, observable: str, face: str | None) -> float | None:
        """Compute the relative difference of an observable between point particles and finite particles.

        `face` is the wall at which a pressure acts. Returns None if theory does not cover the column.
        """
        return compare_columns(*self.columns, observable, self._top(face)) if self.columns else None

    def _top(self, face: str | None) -> bool | None:
        """Return True if a face of the container is at the top of a column.

        Return None for a face that is not perpendicular to the axis of the column.
        """
        scene, axis = self.scene, self.axis
        if face is None or axis is None or face[0] != "xyz"[axis] or scene.gravity is None:
            return None
        return (scene.gravity[axis] < 0.0) == face.endswith("high")


def known_conditions(scene: Scene, start: State) -> Conditions | None:
    """Compute the local conditions from theory, or return None if theory does not cover the scene.

    The energy of the scene is computed from the initial state `start`.
    """
    if column := gravity_column(scene):
        try:
            return _of_column(scene, column, start)
        except ValueError:  # for example, particles that come to rest as a crystal
            return None
    if not _is_even(scene):
        return None
    heat = max(scene.face_temperatures, default=0.0)
    return even_conditions(scene, heat or kinetic_temperature(scene, start))


def _is_even(scene: Scene) -> bool:
    """Return True if a scene becomes homogeneous from any initial state."""
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
    """Compute the conditions under gravity; raise ValueError if theory does not cover the scene."""
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
    """Measure the local conditions in a run, along the axis with the largest gradient.

    Only frames after the discarded part are used. Density and temperature both count in the gradient. Raises
    SceneError for a file that does not store all particles.
    """
    with open_run(path, None, sheared=True) as run:
        positions = run.positions[:, run.moving]
        thermal = (run.masses[run.moving] * (run.peculiar**2).sum(axis=2)) / run.dimension
    profiles = [_along(scene, k, positions[..., k], thermal) for k in range(scene.dimension)]
    return min(profiles, key=lambda profile: profile.scale)


def _along(scene: Scene, axis: int, positions: np.ndarray, thermal: np.ndarray) -> Conditions:
    """Compute layers along an axis that contain equally many particles of the frames (T, M)."""
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
    # Particles of one frame are treated as independent, but frames are treated as fully correlated.
    error = math.sqrt(2.0 * _LAYERS / max(1, positions.shape[1]) / max(1.0, len(positions) / 8.0))
    logarithms = [np.log(np.maximum(values, 1e-300)) for values in (crowding, temperature)]
    first, second = np.triu_indices(_LAYERS, 1)
    change = np.maximum(*(np.abs(values[second] - values[first]) for values in logarithms))
    certain = np.maximum(change - _CERTAIN * error, 0.0) / (middle[second] - middle[first])
    scale = 1.0 / float(certain.max()) if certain.max() > 0.0 else math.inf
    return Conditions(scene, share, crowding, temperature, axis, scale)


# Energy of a scene: sources, sinks, and whether a steady state exists.


def require_steady(scene: Scene) -> None:
    """Raise SceneError if a scene is empty, cools or heats.

    In a scene without a steady state the observables depend on time.
    """
    if not scene.count:
        raise SceneError("count", 0, "advice is for a gas: the scene is empty")
    law = scene.restitution
    loses = law is not None and law.dissipative
    if law is not None and loses and not is_driven(scene):
        rule = "loses energy that nothing returns: there is no steady state to measure; give a duration"
        raise SceneError("restitution.normal", law.normal, rule)
    moved = any(isinstance(face, Vibrating | LeesEdwards) for face in scene.faces.values())
    if (moved or scene.thermostat is not None) and not loses and not at_temperature(scene):
        rule = "nothing takes the energy that the scene is given: there is no steady state; give a duration"
        raise SceneError("restitution", None, rule)


def is_driven(scene: Scene) -> bool:
    """Return True if an external source exchanges energy with the particles.

    The source is a thermostat, a face with a temperature, or a moving face.
    """
    moves = any(face.moves for face in scene.faces.values())
    return scene.thermostat is not None or moves or at_temperature(scene)


def at_temperature(scene: Scene) -> bool:
    """Return True if a face or an interior wall draws velocities from a thermal distribution."""
    return bool(scene.face_temperatures)


def keeps_energy(scene: Scene) -> bool:
    """Return True if a run conserves its initial energy, or its enthalpy under a loaded piston."""
    loaded = [piston for _, piston in scene.pistons if piston.pressure is not None]
    moved = any(face.moves for face in scene.faces.values() if face not in loaded)
    exchanged = moved or at_temperature(scene) or scene.thermostat is not None or scene.is_open
    return not exchanged and not scene.dissipates
