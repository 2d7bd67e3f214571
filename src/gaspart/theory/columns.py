"""Column of a gas in equilibrium under gravity: hydrostatics for a prescribed energy.

The temperature of a column is the temperature at which the column has the prescribed energy.

Heights are measured from the lowest possible position of a centre. Hard spheres and discs follow the
reference equation of state. If `ideal` is True, the gas is ideal, as for the Boltzmann equation.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from gaspart.scene.scene import Scene
from gaspart.scene.surfaces import Thermal
from gaspart.state.state import State
from gaspart.theory.geometry import particle_volume
from gaspart.theory.gravity import hydrostatic_profiles
from gaspart.theory.state import compressibility_factor, contact_value

_POINTS = 1200
_SCALES = 25.0
"""Height above the floor beyond which the density of a column is negligible, in scale heights."""
_ROUNDS = 40
COMPARED = ("collision_rate", "temperature", "density")
"""Observables, besides pressures, for which columns are compared."""


@dataclass(frozen=True)
class Column:
    """Column of a gas in equilibrium under gravity.

    heights : (Z,), heights.
    numbers : (S, Z), number of particles per unit of height, for each particle mass.
    masses : (S,), different masses of particles.
    temperature : temperature.
    pull : acceleration of gravity.
    area : area of the cross-section.
    diameter, dimension : diameter of the particles, and dimension.
    ideal : True for an ideal gas (see the module).
    """

    heights: np.ndarray
    numbers: np.ndarray
    masses: np.ndarray
    temperature: float
    pull: float
    area: float
    diameter: float
    dimension: int
    ideal: bool

    @cached_property
    def filled(self) -> np.ndarray:
        """Packing fraction (Z,) at each height."""
        return self.numbers.sum(axis=0) / self.area * particle_volume(self.dimension, self.diameter)

    @property
    def energy(self) -> float:
        """Total energy of all particles, kinetic and potential."""
        total = np.trapezoid(self.numbers, self.heights, axis=1)
        raised = np.trapezoid(self.numbers * self.heights, self.heights, axis=1)
        kinetic = 0.5 * self.dimension * self.temperature * total.sum()
        return float(kinetic + self.pull * (self.masses @ raised))

    @property
    def collisions(self) -> float:
        """Total collision rate, up to a factor that columns of the same scene share."""
        contact = 1.0 if self.ideal else contact_value(self.filled, self.dimension)
        speed = np.sqrt(1.0 / self.masses[:, None] + 1.0 / self.masses)
        pairs = np.einsum("iz,jz,ij->z", self.numbers, self.numbers, speed) * contact
        return math.sqrt(self.temperature) * float(np.trapezoid(pairs, self.heights))

    def pressure(self, top: bool) -> float:
        """Compute the pressure on the floor or, if `top` is True, at the top."""
        at = -1 if top else 0
        ratio = 1.0 if self.ideal else compressibility_factor(self.filled[at], self.dimension)
        return float(self.numbers[:, at].sum() / self.area * self.temperature * ratio)


@dataclass(frozen=True)
class GravityColumn:
    """Scene with gravity along one walled axis, for which columns are computed.

    axis : index of the axis of gravity.
    low : True if the floor is the lower wall.
    pull : acceleration of gravity.
    height : height that is accessible to centres.
    area : area of the cross-section.
    masses, counts : (S,), masses and numbers of particles of each kind.
    diameter : diameter of the particles.
    """

    dimension: int
    axis: int
    low: bool
    pull: float
    height: float
    area: float
    masses: np.ndarray
    counts: np.ndarray
    diameter: float

    def column(self, temperature: float, ideal: bool) -> Column:
        """Compute the column of a temperature; ValueError beyond the range of the equation of state of the
        fluid.
        """
        d, weights = self.dimension, self.masses * self.pull / temperature
        top = min(self.height, self._reaches(temperature))
        z = np.linspace(0.0, top, _POINTS)
        per_area = self.counts / self.area
        if ideal:
            densities = np.exp(-weights[:, None] * z)
            densities *= (per_area / np.trapezoid(densities, z, axis=1))[:, None]
        else:
            densities = hydrostatic_profiles(z, per_area, weights, d, self.diameter)
        shape = self.masses, temperature, self.pull, self.area, self.diameter, d, ideal
        return Column(z, densities * self.area, *shape)

    def _reaches(self, temperature: float) -> float:
        """Return an upper limit of the gas height: a close-packed bed plus an atmosphere of the lightest
        particles.
        """
        volume = self.counts.sum() * particle_volume(self.dimension, self.diameter) / self.area
        return 2.0 * float(volume) + _SCALES * temperature / float(self.masses.min() * self.pull)

    def of_energy(self, energy: float, ideal: bool) -> Column:
        """Compute the column of a total energy; ValueError as for `column`, or if no temperature has this
        energy.
        """
        if not energy > 0.0:
            raise ValueError(f"energy: {energy} (must be positive)")
        low, high = 0.0, 2.0 * energy / (self.dimension * float(self.counts.sum()))
        for _ in range(_ROUNDS):
            middle = 0.5 * (low + high)
            try:
                colder = self.column(middle, ideal).energy < energy
            except ValueError:  # at this temperature the floor would be denser than the fluid
                colder = True
            low, high = (middle, high) if colder else (low, middle)
        return self.column(high, ideal)

    def energy_of(self, state: State) -> float:
        """Compute the kinetic and potential energy of a state, with the floor at height 0."""
        position, length = state.positions[:, self.axis], float(state.lengths[self.axis])
        heights = (position if self.low else length - position) - 0.5 * (length - self.height)
        return float(state.translational_energy + self.pull * (state.masses @ heights))

    def equilibrate(self, energy: float, heat: float | None, ideal: bool) -> Column:
        """Compute the equilibrium column from the temperature `heat` of its faces, or from its energy."""
        return self.column(heat, ideal) if heat else self.of_energy(energy, ideal)


def gravity_column(scene: Scene) -> GravityColumn | None:
    """Return the column of a scene under gravity; None if there is no theory for it. Theory covers
    equal-sized particles that lose no energy, between hard walls or walls at one temperature across gravity.
    Along a periodic axis gravity drives a flow, and the gas is uniform.
    """
    pull = [(k, g) for k, g in enumerate(scene.gravity or ()) if g]
    kinds = [kind for kind in scene.kinds if kind.count]
    law, thermal = scene.restitution, scene.face_temperatures
    if len(pull) != 1 or scene.driven_axes or scene.thermostat is not None or scene.walls or not kinds:
        return None
    if law is not None and (law.dissipative or law.rough):
        return None
    if len({kind.radius for kind in kinds}) > 1 or not all(kind.alike and not kind.fixed for kind in kinds):
        return None
    if len(thermal) > 1 or any(not isinstance(face, Thermal) or face.slides for face in scene.faces.values()):
        return None
    (k, g), (lower, upper) = pull[0], map(np.array, scene.reach(scene.smallest_radius))
    sides = upper - lower
    masses = sorted({kind.mass for kind in kinds})
    counts = [sum(kind.count for kind in kinds if kind.mass == mass) for mass in masses]
    return GravityColumn(
        scene.dimension, k, g < 0.0, abs(g), float(sides[k]), float(np.delete(sides, k).prod()),
        np.array(masses), np.array(counts, dtype=float), 2.0 * kinds[0].radius,
    )  # fmt: skip


def relative_change(
    observable: str, low: Column, high: Column, middle: Column, top: bool | None = None
) -> float:
    """Compute the change of an observable between two columns, relative to a third column. `observable`: one
    of `COMPARED`, or "pressure". For a density, the root mean square of the change is computed. `top`: for a
    pressure, True for the top and False for the floor.
    """
    if observable == "density":
        profiles = [
            np.interp(middle.heights, column.heights, column.numbers.sum(axis=0), right=0.0)
            for column in (low, high, middle)
        ]
        return float(np.sqrt(((profiles[1] - profiles[0]) ** 2).sum() / (profiles[2] ** 2).sum()))
    first, second, value = (_value(column, observable, top) for column in (low, high, middle))
    return abs(second - first) / value if value > 0.0 else math.inf


def _value(column: Column, observable: str, top: bool | None) -> float:
    """Return the pressure, the collision rate or the temperature of a column."""
    if top is not None:
        return column.pressure(top)
    return column.collisions if observable == "collision_rate" else column.temperature


def compare_columns(real: Column, ideal: Column, observable: str, top: bool | None) -> float:
    """Compute the relative difference of an observable between a real and an ideal column. `top` selects the
    wall of a pressure; None is all walls, for which the result is the maximum over several observables.
    """
    if observable == "pressure" and top is not None:
        return relative_change(observable, real, ideal, real, top)
    differences = {name: relative_change(name, real, ideal, real) for name in COMPARED}
    return differences.get(observable, max(differences.values()))
