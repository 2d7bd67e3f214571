"""Local density and temperature of a steady scene, and barometric columns under gravity.

In a homogeneous gas the local values are equal to the mean values. For a gas under gravity, the profiles
follow from hydrostatics (`gaspart.theory.columns`), if theory covers the gas. For all other gases, a pilot
run of the exact engine measures the values. The errors of DSMC are estimated from these conditions.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from gaspart.scene.scene import Scene
from gaspart.scene.sizes import ball_volume
from gaspart.scene.surfaces import Thermal
from gaspart.state.state import State
from gaspart.theory.columns import Column, GravityColumn, compare_columns, gravity_column
from gaspart.theory.diffusion import ERPENBECK_WOOD_HIGHEST, erpenbeck_wood_ratio
from gaspart.theory.discretisation import contact_values
from gaspart.theory.rates import MEAN_SQUARE, cross_sections

_FREE = 0.02
"""Minimum accessible fraction of the volume for which a contact value is evaluated."""
_HELD = 0.02
"""Fraction of all particles, in the uppermost layers, that the shortest length scale does not include."""


@dataclass(frozen=True)
class Conditions:
    """Layers of a steady scene across an axis, from wall to wall."""

    scene: Scene
    share: np.ndarray
    crowding: np.ndarray
    temperature: np.ndarray
    axis: int | None = None
    scale: float = math.inf
    columns: tuple[Column, Column] | None = None

    @cached_property
    def free(self) -> np.ndarray:
        """Side lengths of the region that centres can reach, shape (d,)."""
        lower, upper = self.scene.reach(self.scene.smallest_radius)
        return np.subtract(upper, lower)

    @cached_property
    def _kinds(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Radii, masses and mean number densities (K,) of the kinds of moving particles."""
        kinds = self.scene.moving_kinds
        radii = np.array([kind.radius for kind in kinds])
        masses = np.array([kind.mass for kind in kinds])
        return radii, masses, np.array([kind.count for kind in kinds]) / float(self.free.prod())

    @cached_property
    def filled(self) -> np.ndarray:
        """Packing fraction in the accessible volume, shape (S,)."""
        radii, _, numbers = self._kinds
        d = self.scene.dimension
        return self.crowding * ball_volume(d) * float((numbers * radii**d).sum())

    @cached_property
    def contact(self) -> np.ndarray:
        """Contact value in an infinite gas, maximum over all pairs of kinds, shape (S,)."""
        radii, _, numbers = self._kinds
        d = self.scene.dimension
        return np.array([float(contact_values(numbers * ratio, radii, d).max()) for ratio in self.crowding])

    @cached_property
    def contact_of_few(self) -> np.ndarray:
        """Contact value in a gas of N particles, shape (S,); inf if no pair fits. So the result is the
        contact value of the other particles times 1 / (1 - v / V). Here v is the volume from which one
        particle of the pair excludes the centre of the other. The factor is exact for two particles. To first
        order in the packing fraction eta of spheres the result is 1 + (5/2 + 3/N) eta: 1 + 4 eta for two
        particles, and 1 + 5/2 eta for many.
        """
        radii, _, numbers = self._kinds
        d, count = self.scene.dimension, self.scene.count
        pair = ball_volume(d) * (2.0 * float(radii.max())) ** d / float(self.free.prod())
        others = max(0.0, count - 2.0) / count
        room = np.maximum(0.0, 1.0 - pair * self.crowding)
        rest = [float(contact_values(others * numbers * ratio, radii, d).max()) for ratio in self.crowding]
        return np.where(room > _FREE, np.array(rest) / np.maximum(room, _FREE), math.inf)

    @cached_property
    def virial(self) -> np.ndarray:
        """Local value of Z - 1, shape (S,)."""
        return 2.0 ** (self.scene.dimension - 1) * self.filled * self.contact_of_few

    @cached_property
    def path(self) -> np.ndarray:
        """Mean free path of the kind with the shortest mean free path, shape (S,)."""
        radii, _, numbers = self._kinds
        d = self.scene.dimension
        most = float((cross_sections(radii, d) * numbers).sum(axis=1).max())
        return np.asarray(1.0 / (math.sqrt(2.0) * most * self.crowding * self.contact))

    @cached_property
    def speed(self) -> np.ndarray:
        """Mean speed of the lightest particles, shape (S,)."""
        _, masses, _ = self._kinds
        return np.sqrt(MEAN_SQUARE[self.scene.dimension] * self.temperature / masses.min())

    @property
    def contrast(self) -> float:
        """Shortest mean free path in a homogeneous gas divided by the shortest in the layers."""
        radii, _, numbers = self._kinds
        even = float(contact_values(numbers, radii, self.scene.dimension).max())
        return float((self.crowding * self.contact).max() / even)

    @cached_property
    def surfaces(self) -> float:
        """Largest diameter over accessible length, summed over walled axes: contacts at which a wall replaces
        a neighbour.
        """
        sides = np.where(self.scene.container.periodic, math.inf, self.free)
        if self.axis is not None and math.isfinite(sides[self.axis]):
            sides[self.axis] = min(sides[self.axis], self.scale)
        return float((2.0 * self.scene.largest_radius / np.maximum(sides, 1e-300)).sum())

    @property
    def quickened(self) -> float:
        """Collision rate divided by the collision rate in a homogeneous gas at the initial temperature."""
        kinds = self.scene.moving_kinds
        d = self.scene.dimension
        start = sum(kind.count * kind.initial_temperature(d) for kind in kinds) / self.scene.count
        hotter = np.sqrt(self.temperature / (start or math.inf))
        mean = (self.share * self.crowding * self.contact * hotter).sum()
        return float(mean / even_conditions(self.scene, 1.0).contact[0])

    @cached_property
    def memory(self) -> float:
        """Effect of correlated collisions on the transport coefficients of spheres, |D / D_Enskog - 1|. The
        value for spheres also estimates discs, whose transport coefficients depend on the size of the system.
        """
        densest = min(float(self.filled.max()), ERPENBECK_WOOD_HIGHEST)
        return abs(float(erpenbeck_wood_ratio(densest)) - 1.0) if densest > 0.0 else 0.0

    def of_points(self, observable: str, face: str | None) -> float | None:
        """Compute the relative difference between point and finite particles of an observable; None without
        theory.
        """
        return compare_columns(*self.columns, observable, self._top(face)) if self.columns else None

    def _top(self, face: str | None) -> bool | None:
        """Return True if a face is at the top of a column, None if it is not perpendicular to the column's
        axis.
        """
        scene, axis = self.scene, self.axis
        if face is None or axis is None or face[0] != "xyz"[axis] or scene.gravity is None:
            return None
        return (scene.gravity[axis] < 0.0) == face.endswith("high")


def known_conditions(scene: Scene, start: State) -> Conditions | None:
    """Compute the local conditions from theory; None if theory does not cover the scene."""
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
    """Return True if a scene becomes homogeneous whatever its initial state."""
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
