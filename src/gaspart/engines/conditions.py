"""Local density and temperature of a steady scene, from which engines bound their errors."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from gaspart.engines.dsmc.defaults import accessible
from gaspart.scene.limits import ball_volume
from gaspart.scene.scene import Scene
from gaspart.theory.discretisation import contact_values

_FREE = 0.02
"""Minimum fraction of the volume that is accessible to a pair where its contact value is evaluated."""


@dataclass(frozen=True)
class Layers:
    """Layers of a steady scene across an axis, from wall to wall.

    Attributes
    ----------
    scene : scene
    share : array (S,), fraction of all particles in each layer
    crowding : (S,), density divided by the density of a gas that fills the accessible volume homogeneously
    temperature : (S,), k_B T
    axis : axis of the layers, None for a homogeneous gas
    scale : shortest length along the axis over which density or temperature changes by a factor e
    """

    scene: Scene
    share: np.ndarray
    crowding: np.ndarray
    temperature: np.ndarray
    axis: int | None = None
    scale: float = math.inf

    @cached_property
    def free(self) -> np.ndarray:
        """Accessible lengths for centres, shape (d,)."""
        lower, upper = accessible(self.scene)
        return np.asarray(upper - lower)

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
        """Contact value of an infinite gas, the maximum over all pairs of kinds, shape (S,)."""
        radii, _, numbers = self._kinds
        d = self.scene.dimension
        return np.array([float(contact_values(numbers * ratio, radii, d).max()) for ratio in self.crowding])

    @cached_property
    def contact_of_few(self) -> np.ndarray:
        """Contact value for the number of particles, shape (S,); inf if no pair fits.

        A particle of a pair in contact does not exclude volume from itself. So the result is the contact
        value of the other particles times 1 / (1 - v / V). Here v is the volume from which one particle of
        the pair excludes the centre of the other. The factor is exact for two particles. To first order in
        the packing fraction of spheres the result is 1 + (5/2 + 3/N) eta: 4 eta for two particles, 5/2 eta
        for many.
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
        sigma = radii[:, None] + radii
        section = math.pi * sigma**2 if d == 3 else 2.0 * sigma
        most = float((section * numbers).sum(axis=1).max())
        return np.asarray(1.0 / (math.sqrt(2.0) * most * self.crowding * self.contact))

    @cached_property
    def speed(self) -> np.ndarray:
        """Mean speed of the lightest particles, shape (S,)."""
        _, masses, _ = self._kinds
        mean = 8.0 / math.pi if self.scene.dimension == 3 else math.pi / 2.0
        return np.sqrt(mean * self.temperature / masses.min())

    @property
    def contrast(self) -> float:
        """Shortest mean free path of a homogeneous gas divided by the shortest one in these layers."""
        radii, _, numbers = self._kinds
        even = float(contact_values(numbers, radii, self.scene.dimension).max())
        return float((self.crowding * self.contact).max() / even)

    @cached_property
    def surfaces(self) -> float:
        """Fraction of contacts with a missing neighbour because of a wall, to first order.

        It is the largest diameter divided by the accessible length, summed over the axes with walls.
        """
        sides = np.where(self.scene.container.periodic, math.inf, self.free)
        if self.axis is not None and math.isfinite(sides[self.axis]):
            sides[self.axis] = min(sides[self.axis], self.scale)
        return float((2.0 * self.scene.largest_radius / np.maximum(sides, 1e-300)).sum())
