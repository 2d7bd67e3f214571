"""Theory of a gas in equilibrium: pressures, collision rates, contact values and speeds."""

from __future__ import annotations

import json
import math
from importlib import import_module
from typing import Any, NamedTuple

import numpy as np

from gaspart import theory
from gaspart.analysis import observables
from gaspart.analysis.run import Run
from gaspart.analysis.run_data import FLOW
from gaspart.engines import Engine, engine_from_dict
from gaspart.scene.facts import Mixture
from gaspart.scene.scene import Scene
from gaspart.scene.species import Species
from gaspart.scene.surfaces import Thermal
from gaspart.theory import bulk, discretisation
from gaspart.theory.bulk import BOLTZMANN, ENSKOG, EXACT
from gaspart.theory.geometry import unit_sphere_surface
from gaspart.theory.speeds import mean_speed_factor
from gaspart.trajectory.correlator import pairs_of

# Theory depends on the engine of a run and on its number of particles.
#
# The DSMC engine solves the Boltzmann or the Enskog equation, so its runs are compared with these equations,
# not with hard spheres. Values for a finite number N of particles use the temperature k_B T of the d (N - 1)
# translational degrees of freedom relative to the centre of mass. `expect` adds the errors of cells and time
# steps of the engine to the uncertainty of each theory.


class Expected(NamedTuple):
    """Theory of an observable, without the errors of the engine.

    value, error : values and their uncertainties; an uncertainty is NaN if it is unknown
    source : source of the theory
    collisional : contribution of collisions to the values, which the cells and steps of an engine change.
        Default: the whole values
    """

    value: Any
    error: Any
    source: str
    collisional: Any = None


OF_NUMBER = "of this number of particles"
LEAST_OF_NUMBER = 10
"""Minimum number of particles for which a contact value of a mixture or a transport coefficient is given,
because the terms of second order in 1/N are unknown.
"""
SOURCES = {EXACT: "Enskog", BOLTZMANN: "Boltzmann equation", ENSKOG: "Enskog equation"}
"""Name of the kinetic theory for each equation. For the exact dynamics, Enskog's theory is an approximation.
"""


def engine_of(run: Run) -> Engine | None:
    """Return the engine of a run; None if the frames do not name the engine."""
    text = run.data.attrs.get("engine")
    return engine_from_dict(json.loads(text)) if text else None


def equation_of(run: Run) -> str:
    """Return the equation that a run's engine solves; `EXACT` if the engine is unknown."""
    engine = engine_of(run)
    return engine.equation if engine else EXACT


def with_discretisation(
    expected: Expected, engine: Engine | None, scene: Scene | None, kind: str
) -> Expected:
    """Add the errors of cells and steps to the uncertainty of a theory. `kind`: kind of error, as in
    `Engine.bias`.
    """
    if engine is None or scene is None or not (bias := engine.bias(scene, kind)):
        return expected
    changed = expected.value if expected.collisional is None else expected.collisional
    return expected._replace(error=np.hypot(expected.error, np.abs(changed) * bias))


def partners(run: Run) -> float:
    """Return (N - 1) / N, the number of collision partners divided by N. A particle has N - 1 partners,
    whereas the theory for an infinite system assumes N.
    """
    return 1.0 - 1.0 / run.count


RELAXED = 10.0
"""Number of changes of its speed after which a particle has an independent speed, for equal masses."""


def is_relaxed(run: Run) -> bool:
    """Return True if velocities are drawn from Maxwell's distribution or were changed often enough."""
    scene = run.scene
    kinds, masses = scene.moving_kinds, [kind.mass for kind in scene.moving_kinds]
    temperatures = {kind.initial_temperature(run.dimension) for kind in kinds} | scene.face_temperatures
    drawn = all(isinstance(kind, Species) and kind.temperature is not None for kind in kinds)
    if drawn and len(temperatures) == 1 and "initial_velocities" not in run.data:
        return True
    return changes_of_velocity(run)[0] >= RELAXED * max(masses) / min(masses)


def changes_of_velocity(run: Run) -> np.ndarray:
    """Return how often particles changed their speeds, by collisions and at thermal faces, until each frame
    (T,).
    """
    scene, data = run.scene, run.data
    fixed = data["fixed_collisions"].values if "fixed_collisions" in data else 0.0
    changes = 2.0 * (data["collisions"].values - fixed)
    for number, face in scene.faces_of(Thermal):
        changes = changes + (face.accommodation or 1.0) * data["wall_hits"].values[:, number]
    return np.asarray(changes / scene.moving_count)


def is_mixed(run: Run, changes: float = RELAXED) -> bool:
    """Return True if particles change their speeds so often that means do not depend on the start."""
    return bool(np.ptp(changes_of_velocity(run)) >= changes)


def contact_of_number(run: Run, packing_fraction: float, dimension: int) -> tuple[float, float] | None:
    """Return the contact value of the N particles of a periodic gas, and its uncertainty. Return None if the
    theory does not apply: for few particles at a high density (`theory.finite_contact_value`).
    """
    lengths = np.array(run.scene.container.lengths)
    volume = packing_fraction * float(lengths.prod()) / run.count  # volume of a particle
    diameter = (volume / theory.particle_volume(dimension)) ** (1.0 / dimension)
    try:
        side = float(lengths.min()) / diameter
        return theory.finite_contact_value(packing_fraction, dimension, run.count, side)
    except ValueError:
        return None


def scale_of_number(run: Run, mixture: Mixture) -> float | None:
    """Return the contact value for N particles divided by the value for infinitely many particles. For a
    mixture, the ratio for equal particles is used. Return None for fewer than `LEAST_OF_NUMBER` particles, or
    if the ratio for equal particles is unknown.
    """
    eta, d = mixture.packing_fraction, mixture.dimension
    if run.count < LEAST_OF_NUMBER or (contact := contact_of_number(run, eta, d)) is None:
        return None
    return contact[0] / float(theory.contact_value(eta, d))


_SANTOS = "Santos, Yuste and Lopez de Haro 2002, an approximation"


def compressibility_factor(run: Run) -> Expected | None:
    """Compute the expected Z at fixed energy: 1 for the Boltzmann equation, exact for Enskog's with N (N - 1)
    / 2 pairs.
    """
    equation = equation_of(run)
    if equation == BOLTZMANN:
        return Expected(1.0, 0.0, "Boltzmann equation: particles without extent", 0.0)
    gas, mixture = run.moving_fluid, run.mixture
    if equation == ENSKOG:
        if mixture is None:
            return None
        beyond = _pairs_of_enskog(mixture)
        return Expected(1.0 + beyond, 0.0, f"Enskog equation, {OF_NUMBER}", beyond)
    if gas is not None:
        eta, d = gas.packing_fraction, gas.dimension
        if (contact := contact_of_number(run, eta, d)) is None:
            return None
        scale = 2.0 ** (d - 1) * eta * partners(run)
        beyond, error = scale * contact[0], scale * contact[1]
        return Expected(1.0 + beyond, error, f"equation of state of the fluid, {OF_NUMBER}", beyond)
    if mixture is None or run.scene.gas is not None:
        return None
    if (scale := scale_of_number(run, mixture)) is None:
        return None
    beyond = (theory.mixture_compressibility_factor(*mixture.sizes) - 1.0) * scale * partners(run)
    return Expected(1.0 + beyond, math.nan, f"{_SANTOS}, corrected for the number of particles", beyond)


def _enskog_contacts(mixture: Mixture) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return numbers (S,), contact distances (S, S) and contact values (S, S) of the Enskog model."""
    numbers, diameters = (np.array(each, dtype=float) for each in (mixture.counts, mixture.diameters))
    filled = float((numbers * theory.particle_volume(mixture.dimension) * diameters**mixture.dimension).sum())
    densities = numbers * mixture.packing_fraction / filled
    distances = 0.5 * np.add.outer(diameters, diameters)
    return numbers, distances, discretisation.contact_values(densities, 0.5 * diameters, mixture.dimension)


def _pairs_of_enskog(mixture: Mixture) -> float:
    """Compute Z - 1 of a mixture in the Enskog model. Z - 1 = (S / 2 d N V) sum over pairs N_i (N_j -
    delta_ij) sigma_ij^d g_ij, where S is the surface of a unit sphere.
    """
    d, (numbers, distances, contacts) = mixture.dimension, _enskog_contacts(mixture)
    diameters = np.diag(distances)
    volume = float((numbers * theory.particle_volume(d) * diameters**d).sum()) / mixture.packing_fraction
    pairs = numbers[:, None] * (numbers - np.eye(len(numbers)))
    surface = unit_sphere_surface(d)
    return surface / (2.0 * d * numbers.sum() * volume) * float((pairs * distances**d * contacts).sum())


def collision_rate(run: Run) -> Expected | None:
    """Compute the expected collision rate at fixed energy; it is exact apart from the contact value."""
    gas, equation = run.moving_fluid, equation_of(run)
    if gas is None or not is_relaxed(run):
        return None
    eta, d = gas.packing_fraction, gas.dimension
    value = bulk.collision_rate(gas, equation) * mean_speed_factor(d * (run.count - 1)) * partners(run)
    if equation != EXACT:
        return Expected(value, 0.0, f"{SOURCES[equation]}, {OF_NUMBER}")
    if (contact := contact_of_number(run, eta, d)) is None:
        return None
    value /= bulk.contact_value(gas, equation)
    return Expected(value * contact[0], value * contact[1], "Enskog's rate, exact in equilibrium")


def contact_values(run: Run) -> Expected | None:
    """Compute the expected contact values g_ij of a finite number of particles."""
    mixture = _mixture_of_species(run)
    if mixture is None or (scale := scale_of_number(run, mixture)) is None:
        return None
    values = theory.mixture_contact_values(*mixture.sizes) * scale
    return Expected(_by_pair(run, values), np.nan, f"contact values of {_SANTOS}")


def pair_rates(run: Run) -> Expected | None:
    """Compute the expected rate of collisions of a particle of a pair's first species with the second's
    others.
    """
    mixture = None if run.is_subset else _mixture_of_species(run)
    if mixture is None or (scale := scale_of_number(run, mixture)) is None:
        return None
    rates = theory.mixture_collision_rates(*mixture.sizes, temperature=run.temperature, masses=mixture.masses)
    rates = rates * (1.0 - np.diag(1.0 / np.array(mixture.counts)))
    rates *= scale * mean_speed_factor(run.freedom)
    return Expected(_by_pair(run, rates), np.nan, f"contact values of {_SANTOS}")


def _by_pair(run: Run, values: np.ndarray) -> np.ndarray:
    """Return the elements (pair,) of a matrix (S, S) of species."""
    return np.array([values[pair] for pair in pairs_of(run.scene)])


def _mixture_of_species(run: Run) -> Mixture | None:
    """Return the mixture of a run, if its species are distinct and relaxed, with one size each."""
    mixture = run.mixture
    if mixture is None or len(mixture.counts) != len(run.scene.species) or equation_of(run) != EXACT:
        return None
    return mixture if is_relaxed(run) else None


def wall_pressure(run: Run, touched: np.ndarray) -> Expected | None:
    """Compute the expected pressure on each wall (face,), at fixed distances of the walls. For point
    particles it is N k_B T divided by the accessible volume. `touched` (d,) are the side lengths of the
    accessible volume. Particles that hardly collide keep the energies along the axes that they have at the
    start: the scatter of these energies is part of the uncertainty.
    """
    gas, equation = run.scene.gas, equation_of(run)
    if gas is None or equation == ENSKOG:
        return None
    scatter = 0.0 if is_mixed(run) else math.sqrt(2.0 * (1.0 - 1.0 / gas.dimension) / run.count)
    if equation == BOLTZMANN:
        value = run.count * run.temperature / float(touched.prod())
        return Expected(value, scatter * value, "Boltzmann equation: an ideal gas", 0.0)
    if run.scene.centres_to_walls:
        return None
    sides = (np.array(run.scene.container.lengths) / gas.diameter)[~run.periodic]
    density = gas.count / float((touched / gas.diameter).prod())
    try:
        parts = [
            theory.wall_pressure(np.roll(sides, -first), density, gas.count, gas.dimension, len(sides))
            for first in range(len(sides))
        ]
    except ValueError:  # above the density range of the theory
        return None
    value, error = np.repeat(parts, 2, axis=0).T
    error = np.hypot(error, scatter * value)
    unit = run.temperature / gas.diameter**gas.dimension
    ideal = run.count * run.temperature / float(touched.prod())
    return Expected(value * unit, error * unit, "fluid between hard walls", value * unit - ideal)


def wall_force(run: Run) -> Expected | None:
    """Compute the expected force on each face: the expected pressure times the area of the face."""
    touched = np.subtract(*run.scene.reach(run.scene.largest_moving_radius)[::-1])
    pressure = wall_pressure(run, touched)
    if pressure is None:
        return None
    areas = np.array([np.delete(touched, axis).prod() for axis in run.scene.walled_axes]).repeat(2)
    share = None if pressure.collisional is None else pressure.collisional * areas
    return Expected(pressure.value * areas, pressure.error * areas, pressure.source, share)


def pressure_tensor(run: Run, temperature: float) -> Expected | None:
    """Compute the expected pressure tensor. The diagonal components are n k_B T [(1 - 1/N) + Z_N - 1]. The
    term 1 - 1/N is the kinetic part: velocities are relative to the centre of mass.
    """
    gas, equation = run.fluid, equation_of(run)
    if gas is None or not is_mixed(run):
        return None
    eta, d = gas.packing_fraction, gas.dimension
    unit = np.eye(d).ravel()
    ideal = gas.count / run.scene.container.volume * temperature * partners(run)
    if equation != EXACT:
        beyond = ideal * bulk.excess(gas, equation)
        source = f"{SOURCES[equation]}, {OF_NUMBER}"
        return Expected((ideal + beyond) * unit, math.nan, source, beyond * unit)
    if (contact := contact_of_number(run, eta, d)) is None:
        return None
    scale = 2.0 ** (d - 1) * eta
    beyond, error = ideal * scale * contact[0], ideal * scale * contact[1]
    source = f"equation of state, {OF_NUMBER}"
    return Expected((ideal + beyond) * unit, error * np.ones(d * d), source, beyond * unit)


def speeds(run: Run, edges: np.ndarray, mass: float | None, fixed: bool) -> Expected | None:
    """Compute Maxwell's density (bins,) of speeds; None unless all particles have the same mass. The bins lie
    between `edges`. If `fixed` is True, the kinetic energy is constant, and the exact distribution for the
    finite number of particles is used. Spins share in a constant energy: the distribution is exact with their
    degrees of freedom. If a potential shares in it, the distribution lies between the one at a constant
    kinetic energy and Maxwell's, whose difference is the uncertainty.
    """
    scene = run.scene
    if mass is None or not scene.has_equilibrium or not (is_relaxed(run) and is_mixed(run)):
        return None
    shared = _densities(run, edges, mass, None)
    if scene.face_temperatures:
        return Expected(shared, 0.0, "Maxwell's distribution", 0.0)
    of_spins = scene.rough * run.count * (run.dimension * (run.dimension - 1) // 2)
    alone = _densities(run, edges, mass, int(run.freedom) + of_spins)
    if fixed or scene.features <= {"roughness", "centres_to_walls", "polydispersity"}:
        return Expected(alone, 0.0, "Maxwell's distribution, of this number at fixed energy", 0.0)
    return Expected(shared, np.abs(shared - alone), "Maxwell's distribution", 0.0)


def _densities(run: Run, edges: np.ndarray, mass: float, freedoms: int | None) -> np.ndarray:
    """Return densities (bins,) of speeds in equilibrium, at a constant energy if `freedoms` share it."""
    law = theory.maxwell_cdf(edges, run.dimension, run.temperature, mass, freedoms)
    return np.asarray(np.diff(law) / np.diff(edges))


# Description of an observable of a run: units, label, and expected value.


def expect(name: str, run: Run, *arguments: Any, **keywords: Any) -> Expected | None:
    """Return the theory of an observable of a run, with the errors of the engine; None if no theory
    exists.
    """
    declared = observables.OBSERVABLES[name]
    if not declared.theory or run.about != FLOW:  # the theory describes motion relative to the flow
        return None
    module, function = declared.theory.split(".")
    compute = getattr(import_module(f"gaspart.analysis.expected.{module}"), function)
    expected: Expected | None = compute(run, *arguments, **keywords)
    if expected is None or not declared.discretised:
        return expected
    return with_discretisation(expected, engine_of(run), run.scene, declared.discretised)


def describe(name: str, run: Run, *arguments: Any, **keywords: Any) -> dict[str, Any]:
    """Return units and label of an observable, and its theory for a run, if any; see `expect`."""
    about: dict[str, Any] = dict(observables.about(name, run.dimension))
    if (expected := expect(name, run, *arguments, **keywords)) is None:
        return about
    return {**about, "theory": (expected.value, expected.error), "source": expected.source}
