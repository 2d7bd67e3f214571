"""Numbers and rates of a gas in equilibrium: pressures, collisions, contact values, speeds."""

from __future__ import annotations

import json
import math
from importlib import import_module
from typing import Any, TypeAlias

import numpy as np

from gaspart import theory
from gaspart.analysis import bulk, observables
from gaspart.analysis.bulk import BOLTZMANN, ENSKOG, EXACT
from gaspart.analysis.flow import FLOW
from gaspart.analysis.run import Run
from gaspart.engines import Engine, engine_from_dict
from gaspart.engines.dsmc import defaults as rates
from gaspart.scene.gas import Mixture
from gaspart.theory.geometry import unit_sphere_surface
from gaspart.theory.speeds import mean_speed_factor
from gaspart.trajectory.pairs import pairs_of

# What is known of the engine of a run, and of its number of particles.
#
# A run of the DSMC engine is that of the Boltzmann or the Enskog equation, not of spheres that touch, and
# is compared with these. Where a value is that of a finite number N of particles, k_B T is that of their d
# (N - 1) degrees of freedom of flight about the centre of mass. The uncertainty contains what cells and
# steps of the engine do; it is NaN where it is not known, as of an approximation.


Expected: TypeAlias = tuple[Any, Any, str]
"""Values, their uncertainties, and the source."""
OF_NUMBER = "of this number of particles"
LEAST_OF_MIXTURE = 10
"""Least number of particles of several sizes for which a theory is stated: terms of second order in 1/N are
not known."""
SOURCES = {EXACT: "Enskog", BOLTZMANN: "Boltzmann equation", ENSKOG: "Enskog equation"}
"""Names of the kinetic theory of each equation; for particles that touch it is an approximation."""


def engine_of(run: Run) -> Engine | None:
    """Return the engine that made a run; None if the frames do not state it."""
    text = run.data.attrs.get("engine")
    return engine_from_dict(json.loads(text)) if text else None


def equation_of(run: Run) -> str:
    """Return the equation that the engine of a run solves; `EXACT` without an engine."""
    engine = engine_of(run)
    return engine.equation if engine else EXACT


def bias_of(run: Run, kind: str) -> float:
    """Return the relative error due to cells and steps, as the engine states it."""
    engine = engine_of(run)
    return engine.bias(run.scene, kind) if engine else 0.0


def partners(run: Run) -> float:
    """Return the fraction (N - 1) / N of partners.

    A particle has N - 1 others where the equation of state has N.
    """
    return 1.0 - 1.0 / run.count


def contact_of_number(run: Run, packing_fraction: float, dimension: int) -> tuple[float, float] | None:
    """Return the contact value of the N particles of a periodic gas, and its uncertainty.

    None where theory does not state it: for few particles at high density (`theory.finite_contact_value`).
    """
    lengths = np.array(run.scene.container.lengths)
    volume = packing_fraction * float(lengths.prod()) / run.count  # of a particle
    diameter = (volume / theory.particle_volume(dimension)) ** (1.0 / dimension)
    try:
        side = float(lengths.min()) / diameter
        return theory.finite_contact_value(packing_fraction, dimension, run.count, side)
    except ValueError:
        return None


def scale_of_number(run: Run, mixture: Mixture) -> float | None:
    """Return the contact value of N particles divided by the value of infinitely many.

    The ratio is taken from equal particles. None for fewer than `LEAST_OF_MIXTURE` particles, and where it is
    not known for equal ones.
    """
    eta, d = mixture.packing_fraction, mixture.dimension
    if run.count < LEAST_OF_MIXTURE or (contact := contact_of_number(run, eta, d)) is None:
        return None
    return contact[0] / float(theory.contact_value(eta, d))


_SANTOS = "Santos, Yuste and Lopez de Haro 2002, an approximation"


def compressibility_factor(run: Run) -> Expected | None:
    """Compute the expected Z at fixed energy.

    It is 1 by the Boltzmann equation; by the Enskog equation it is exact for its N (N - 1) / 2 pairs.
    """
    equation = equation_of(run)
    if equation == BOLTZMANN:
        return 1.0, 0.0, "Boltzmann equation: particles without extent"
    gas, mixture = run.moving_fluid, run.mixture
    if equation == ENSKOG:
        if mixture is None:
            return None
        beyond = _pairs_of_enskog(mixture)
        return 1.0 + beyond, beyond * bias_of(run, "rates"), f"Enskog equation, {OF_NUMBER}"
    if gas is not None:
        eta, d = gas.packing_fraction, gas.dimension
        if (contact := contact_of_number(run, eta, d)) is None:
            return None
        scale = 2.0 ** (d - 1) * eta * partners(run)
        return 1.0 + scale * contact[0], scale * contact[1], f"equation of state of the fluid, {OF_NUMBER}"
    if mixture is None or run.scene.gas is not None:
        return None
    if (scale := scale_of_number(run, mixture)) is None:
        return None
    value = 1.0 + (theory.mixture_compressibility_factor(*mixture.sizes) - 1.0) * scale * partners(run)
    return value, math.nan, f"{_SANTOS}, corrected for the number of particles"


def _enskog_contacts(mixture: Mixture) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return numbers (S,), contact distances (S, S) and contact values (S, S) of the Enskog model."""
    numbers, diameters = (np.array(each, dtype=float) for each in (mixture.counts, mixture.diameters))
    filled = float((numbers * theory.particle_volume(mixture.dimension) * diameters**mixture.dimension).sum())
    densities = numbers * mixture.packing_fraction / filled
    distances = 0.5 * np.add.outer(diameters, diameters)
    return numbers, distances, rates.contact_values(densities, 0.5 * diameters, mixture.dimension)


def _pairs_of_enskog(mixture: Mixture) -> float:
    """Compute Z - 1 of the Enskog model.

    Z - 1 = (S / 2 d N V) sum over pairs N_i (N_j - delta_ij) sigma_ij^d g_ij, with S the surface of a unit
    sphere.
    """
    d, (numbers, distances, contacts) = mixture.dimension, _enskog_contacts(mixture)
    diameters = np.diag(distances)
    volume = float((numbers * theory.particle_volume(d) * diameters**d).sum()) / mixture.packing_fraction
    pairs = numbers[:, None] * (numbers - np.eye(len(numbers)))
    surface = unit_sphere_surface(d)
    return surface / (2.0 * d * numbers.sum() * volume) * float((pairs * distances**d * contacts).sum())


def collision_rate(run: Run) -> Expected | None:
    """Compute the expected collision rate at fixed energy; exact but for the contact value."""
    gas, equation = run.moving_fluid, equation_of(run)
    if gas is None:
        return None
    eta, d = gas.packing_fraction, gas.dimension
    value = bulk.collision_rate(gas, equation) * mean_speed_factor(d * (run.count - 1)) * partners(run)
    if equation != EXACT:
        return value, value * bias_of(run, "rates"), f"{SOURCES[equation]}, {OF_NUMBER}"
    if (contact := contact_of_number(run, eta, d)) is None:
        return None
    value /= bulk.contact_value(gas, equation)
    return value * contact[0], value * contact[1], "Enskog's rate, exact in equilibrium"


def contact_values(run: Run) -> Expected | None:
    """Compute the expected g_ij of N particles, with N_i (N_j - delta_ij) pairs."""
    mixture = _mixture_of_species(run)
    if mixture is None or (scale := scale_of_number(run, mixture)) is None:
        return None
    values = theory.mixture_contact_values(*mixture.sizes) * scale
    return [values[pair] for pair in pairs_of(run.scene)], np.nan, f"contact values of {_SANTOS}"


def pair_rates(run: Run) -> Expected | None:
    """Compute the expected collisions of a particle of the first species of each pair.

    It has N_j - delta_ij partners.
    """
    mixture = None if run.is_subset else _mixture_of_species(run)
    if mixture is None or (scale := scale_of_number(run, mixture)) is None:
        return None
    rates = theory.mixture_collision_rates(*mixture.sizes, temperature=run.temperature, masses=mixture.masses)
    rates = rates * (1.0 - np.diag(1.0 / np.array(mixture.counts)))
    rates *= scale * mean_speed_factor(run.freedom)
    return [rates[pair] for pair in pairs_of(run.scene)], np.nan, f"contact values of {_SANTOS}"


def _mixture_of_species(run: Run) -> Mixture | None:
    """Return the mixture, if each species is of one size and differs from the others."""
    mixture = run.mixture
    if mixture is None or len(mixture.counts) != len(run.scene.species) or equation_of(run) != EXACT:
        return None
    return mixture


def wall_pressure(run: Run, touched: np.ndarray) -> Expected | None:
    """Compute the expected pressure on walls of one distance.

    It is the pressure of the fluid between hard walls; for points N k_B T divided by the volume that centres
    can reach. `touched` (d,) are the sides of this volume.
    """
    walled, lengths = ~run.periodic, np.array(run.scene.container.lengths)
    gas, equation = run.scene.gas, equation_of(run)
    if gas is None or equation == ENSKOG:
        return None
    if equation == BOLTZMANN:
        return run.count * run.temperature / float(touched.prod()), 0.0, "Boltzmann equation: an ideal gas"
    sides = lengths[walled]
    if run.scene.centres_to_walls or np.ptp(sides) > 1e-9 * sides.max():
        return None
    density = gas.count / float((touched / gas.diameter).prod())
    try:
        value, error = theory.wall_pressure(
            sides[0] / gas.diameter, density, gas.count, gas.dimension, int(walled.sum())
        )
    except ValueError:  # denser than theory goes
        return None
    unit = run.temperature / gas.diameter**gas.dimension
    return value * unit, error * unit, "fluid between hard walls"


def wall_force(run: Run) -> Expected | None:
    """Compute the expected pressure times the area of each face."""
    touched = np.subtract(*run.scene.reach(run.scene.largest_moving_radius)[::-1])
    pressure = wall_pressure(run, touched)
    if pressure is None:
        return None
    areas = np.array([np.delete(touched, axis).prod() for axis in run.scene.walled_axes]).repeat(2)
    return pressure[0] * areas, pressure[1] * areas, pressure[2]


def pressure_tensor(run: Run, temperature: float) -> Expected | None:
    """Compute the expected pressure tensor.

    The diagonal is n k_B T [(1 - 1/N) + Z_N - 1], where the first term is the flight of N - 1 particles about
    the centre of mass.
    """
    gas, equation = run.fluid, equation_of(run)
    if gas is None:
        return None
    eta, d = gas.packing_fraction, gas.dimension
    ideal = gas.count / run.scene.container.volume * temperature * partners(run)
    if equation != EXACT:
        pressure = ideal * (1.0 + bulk.excess(gas, equation))
        return pressure * np.eye(d).ravel(), math.nan, f"{SOURCES[equation]}, {OF_NUMBER}"
    if (contact := contact_of_number(run, eta, d)) is None:
        return None
    scale = 2.0 ** (d - 1) * eta
    pressure, error = ideal * (1.0 + scale * contact[0]), ideal * scale * contact[1]
    return pressure * np.eye(d).ravel(), error * np.ones(d * d), f"equation of state, {OF_NUMBER}"


def speeds(run: Run, edges: np.ndarray, mass: float | None, fixed: bool) -> Expected | None:
    """Compute Maxwell's density (bins,) between edges, for particles of one mass; None for others.

    If `fixed`, the kinetic energy does not change, and the law of this number of particles is exact.
    """
    if mass is None:
        return None
    law = theory.maxwell_cdf(edges, run.dimension, run.temperature, mass, int(run.freedom) if fixed else None)
    source = f"Maxwell's distribution{', of this number at fixed energy' if fixed else ''}"
    return np.diff(law) / np.diff(edges), 0.0, source


# An observable of a run as its result states it: units, label, and what theory expects.


def describe(name: str, run: Run, *arguments: Any, **keywords: Any) -> dict[str, Any]:
    """Return units and label of an observable, and its theory for a run.

    The theory, if there is one, has values, their uncertainties, and a source. `arguments` and `keywords` are
    the arguments of its function of theory in addition to the run.
    """
    about: dict[str, Any] = dict(observables.about(name, run.dimension))
    stated = observables.OBSERVABLES[name].theory
    if not stated or run.about != FLOW:  # theory is about the flow
        return about
    module, function = stated.split(".")
    expect = getattr(import_module(f"gaspart.analysis.expected.{module}"), function)
    if (expected := expect(run, *arguments, **keywords)) is None:
        return about
    value, error, source = expected
    return {**about, "theory": (value, error), "source": source}
