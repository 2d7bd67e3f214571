"""Scatter of an observable between seeds due to the initial energy.

If nothing exchanges energy with the particles, each run conserves its initial energy, or its enthalpy under a
loaded piston. Randomly drawn velocities have the prescribed temperature only on average. Random positions
under gravity also have random energies, even if the velocities are fixed.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

from gaspart import theory
from gaspart.accuracy.conditions import keeps_energy
from gaspart.accuracy.target import Target
from gaspart.scene.scene import Scene
from gaspart.scene.species import Species
from gaspart.theory.columns import COMPARED, Column, gravity_column, relative_change
from gaspart.theory.conditions import kinetic_temperature
from gaspart.trajectory.reading import GIVEN_START
from gaspart.yaml_text import parse_yaml

if TYPE_CHECKING:
    import xarray as xr

_STRATIFIED = 1.5
"""Assumed minimum power of the temperature if the density changes with it: under a piston, and under gravity
without a theory.
"""
_CHANGE = 0.01
"""Relative change of the energy for numerical derivatives."""
_DENSEST = 0.45
"""Maximum packing fraction at which the scatter of random positions is known."""


@dataclass(frozen=True)
class Scatter:
    """Relative standard deviation of an observable between seeds due to the initial energy.

    value : the relative standard deviation.
    drawn, placed : True if drawn velocities and random positions contribute.
    """

    value: float = 0.0
    drawn: bool = False
    placed: bool = False

    @property
    def remedy(self) -> str:
        """Change of the scene or of the run that removes the scatter."""
        if not self.placed:
            return "exact_temperature: true removes it"
        drawn = "; exact_temperature: true removes the part of the velocities" if self.drawn else ""
        return f"it is of random positions under gravity{drawn}"


def scatter_of_run(run: xr.Dataset, observable: str, face: str | None = None) -> Scatter:
    """Compute the scatter between runs of other seeds; 0 for runs from the same state, with one energy."""
    if GIVEN_START in run.attrs:
        return Scatter()
    return start_scatter(Target(Scene.from_dict(parse_yaml(run.attrs["scene"])), observable, face))


def start_scatter(target: Target) -> Scatter:
    """Compute the scatter of an observable of a scene between seeds."""
    scene = target.scene
    if not keeps_energy(scene):
        return Scatter()
    parts = _of_velocities(scene), _of_places(scene)
    if not any(parts):
        return Scatter()
    return Scatter(_of_observable(target, math.hypot(*parts)), *(part > 0.0 for part in parts))


def _of_velocities(scene: Scene) -> float:
    """Compute the standard deviation of the initial kinetic energy."""
    drawn = [kind for kind in scene.species if kind.temperature is not None and not kind.exact_temperature]
    return math.sqrt(
        sum(0.5 * scene.dimension * kind.count * (kind.temperature or 0.0) ** 2 for kind in drawn)
    )


def _of_places(scene: Scene) -> float:
    """Compute the standard deviation of the initial potential energy, reduced for excluded volume."""
    kinds = [kind for kind in scene.species if kind.count and kind.arrangement == "random" and not kind.fixed]
    square = 0.0
    for axis, pull in enumerate(scene.gravity or ()):
        for kind in kinds:
            square += kind.count * (kind.mass * pull * _range(scene, kind, axis)) ** 2 / 12.0
    return math.sqrt(square * _compressibility(scene, kinds)) if square else 0.0


def _range(scene: Scene, kind: Species, axis: int) -> float:
    """Return the length of the region along an axis in which a species is placed."""
    lower, upper = (bounds[axis] for bounds in scene.reach(kind.radius))
    if kind.region is None:
        return float(upper - lower)
    low, high = (float(corner[axis]) for corner in kind.region)
    return max(0.0, min(upper, high) - max(lower, low))


def _compressibility(scene: Scene, kinds: list[Species]) -> float:
    """Return the reduced compressibility, by which excluded volume reduces the scatter of positions."""
    d = scene.dimension
    filled = 0.0
    for kind in kinds:
        volume = math.prod(_range(scene, kind, axis) or 1.0 for axis in range(d))
        filled += kind.total_power(d) * theory.particle_volume(d, 2.0) / volume
    return float(theory.reduced_compressibility(min(filled, _DENSEST), d))


def _of_observable(target: Target, deviation: float) -> float:
    """Compute the relative standard deviation of an observable from the standard deviation of the energy."""
    scene = target.scene
    freedom = 0.5 * scene.dimension * scene.count
    power = target.declared.power
    kinetic = sum(kind.count * kind.initial_temperature(scene.dimension) for kind in scene.kinds)
    mean = 0.5 * scene.dimension * kinetic
    for _, piston in scene.pistons:
        if target.observable == "pressure":
            return 0.0  # the pressure equals the load
        mean += (piston.pressure or 0.0) * scene.container.volume
        power = max(power, _STRATIFIED, _at_piston(scene) if target.observable == "density" else 0.0)
    if not scene.gravity:
        return power * deviation / mean if mean else 0.0
    temperature = kinetic_temperature(scene, target.initial)
    if target.conditions is not None and target.conditions.columns:
        scatter = _of_column(target, deviation)
        if scatter is not None:
            return scatter
    heat = (freedom + scene.count) * temperature
    return max(power, _STRATIFIED) * deviation / heat if heat else math.inf


def _at_piston(scene: Scene) -> float:
    """Return the change of the density near a piston, divided by the mean density and the change of energy.
    The height h is proportional to the enthalpy, and fluctuates by h / sqrt(gamma N) at constant enthalpy
    (points; gamma = 1 + 2 / d). So the density falls from its mean by at most sqrt(gamma N / 2 pi) / h per
    length, where half of it is left. This half falls as 1 / h.
    """
    gamma = 1.0 + 2.0 / scene.dimension
    return math.sqrt(gamma * scene.count / (2.0 * math.pi)) - 0.5


def _of_column(target: Target, deviation: float) -> float | None:
    """Compute the standard deviation of an observable under gravity from hydrostatics, or None."""
    column = gravity_column(target.scene)
    assert column is not None
    energy = column.energy_of(target.initial)
    try:
        low, middle, high = (column.of_energy(energy * (1.0 + k * _CHANGE), False) for k in (-1, 0, 1))
    except ValueError:
        return None
    changed = _change(target, low, middle, high)
    return changed * deviation / (2.0 * _CHANGE * energy)


def _change(target: Target, low: Column, middle: Column, high: Column) -> float:
    """Compute the difference of the observable between two columns, divided by its value."""
    columns = low, high, middle
    if target.observable in COMPARED:
        return relative_change(target.observable, *columns)
    if target.declared.of_impulses:
        pressed = [top for top in (False, True) if middle.pressure(top) > 0.0]
        return max(relative_change("pressure", *columns, top) for top in pressed)
    return max(target.declared.power, 0.5) * relative_change("temperature", *columns)
