"""Claims about pressure on walls, gases behind a piston, and estimators."""

from __future__ import annotations

from typing import Any

import numpy as np
import xarray as xr

from gaspart import theory
from gaspart.analysis.statistics import combine_estimates, fit_power_law, mean_of
from gaspart.reproduction.claims import Claim, Estimate
from gaspart.reproduction.families.shared import PARTICLES
from gaspart.reproduction.table import Row, Table, each

RELATIVE_ERROR = 1e-3
"""Largest relative standard error of a pressure for which a mean of comparisons is conclusive."""
THEORY: dict[str, Any] = {
    "source": "bulk equation of state; surfaces, edges and corners of the container to fifth order in the "
    "density, by cluster integrals (gaspart.theory.film); canonical ensemble to first order in 1/N",
    "allowance_source": "surfaces, edges and corners: a sixth order as large as the larger of the two before",
    "fails_if": "wall collisions are missed or counted twice, or the wrong area, volume or density is taken",
}
LESS_CERTAIN = "surfaces and edges are less certain than the measurement, by an estimate of what is left out"
"""Reason for no verdict if the estimated uncertainty of theory exceeds the measurement's."""


def wall_pressure(dataset: xr.Dataset) -> list[Claim]:
    """Return the claims on the wall pressure, with surface terms of the container.

    The wall pressure equals the bulk pressure with these terms, and is proportional to T. Without these terms
    the deviation is far larger than the error.
    """
    table = Table(dataset, "point")
    table = table.assign(particles=[PARTICLES[dimension] for dimension in table.dimension])
    slits, closed = table[table.axes < table.dimension], table[table.axes == table.dimension]
    claims = [claim for _, part in slits.by("dimension") for claim in _between_walls(part)]
    theory = closed.expected.value
    measured, expected = closed.pressure / theory, closed.expected / theory
    claims += each(
        closed,
        "pressure of {count} {particles} in a closed container over theory's, "
        "packing fraction {packing_fraction:.2g}",
        measured=measured,
        expected=expected,
        required=RELATIVE_ERROR,
        no_verdict=np.where(expected.error > measured.error, LESS_CERTAIN, ""),
        **THEORY,
    )
    small = (closed.count == np.where(closed.dimension == 2, 100, 125)) & (
        abs(closed.packing_fraction - 0.1) < 0.005
    )
    for _, naive in closed[small].by("dimension"):
        claims += _naive(naive[:1])
    return claims + _temperature(table)


def _between_walls(slits: Table) -> list[Claim]:
    ratio, expected = slits.pressure / slits.expected.value, slits.expected / slits.expected.value
    mean = combine_estimates(Estimate(ratio.value, ratio.error))
    measured, allowance = Estimate(mean.value, mean.error), ratio.weights @ expected.error
    name = f"pressure of {slits.particles[0]} between two walls"
    return [
        Claim(
            claim=f"{name} over theory's, mean of {len(slits)} slits",
            measured=measured,
            expected=Estimate(1.0, allowance),
            required=RELATIVE_ERROR,
            no_verdict=LESS_CERTAIN if slits.dimension[0] == 2 and allowance > measured.error else "",
            **THEORY,
        ),
        Claim.joint(
            claim=f"{name} against theory's",
            deviations=(slits.pressure - slits.expected).deviation,
            source=THEORY["source"],
            fails_if="an error that grows with density, or wrong error bars",
        ),
    ]


def _naive(closed: Table) -> list[Claim]:
    return each(
        closed,
        "bulk pressure at N/V over that on the walls of {count} {particles}, packing fraction 0.1",
        Claim.at_most,
        measured=closed.bulk_pressure / closed.pressure,
        bound=np.where(closed.dimension == 2, 0.95, 0.8),
        required=0.01,
        source="the accessible volume is smaller than the container's: -7 % (discs), -34 % (spheres)",
        fails_if="the pressure on walls does not depend on the particles' size",
    )


def _temperature(table: Table) -> list[Claim]:
    claims = []
    for *_, part in table.by("axes", "dimension", table.density.round(9)):
        if part.temperature.max() < 2.0 * part.temperature.min():
            continue
        pressure = part.pressure * part.temperature
        law = fit_power_law(part.temperature, pressure.value, pressure.error)
        claims.append(
            Claim(
                claim=f"exponent of P against T at packing fraction {part.packing_fraction[0]:.3g}",
                kind="identity",
                measured=Estimate(law.exponent, law.exponent_error),
                expected=1.0,
                required=2e-3,
                source="hard particles have no energy scale (exact)",
                fails_if="the program has a hidden energy or time scale",
            )
        )
    return claims


ENSEMBLE = "the ensemble of constant pressure and enthalpy ([Andersen 1980])"


def exponents(path: Row) -> np.ndarray:
    """Compute 1 + 2/d times ln of the temperature ratio, divided by theory.

    The shape is (path_replica, frame). Viscous heating is subtracted first.
    """
    dimension, first = path.dimension, path.packing_fraction
    eta = np.minimum(first / path.volume, theory.HIGHEST_PACKING_FRACTION[dimension])
    expected = theory.adiabatic_temperature(eta, first, dimension)
    with np.errstate(divide="ignore", invalid="ignore"):
        ratio = (np.log(path.temperature) - path.heating) / np.log(expected)
    return np.asarray(1.0 + 2.0 / dimension * ratio)


def piston(ds: xr.Dataset) -> list[Claim]:
    """Return the claims on adiabatic exponents, states at constant pressure, free expansions."""
    paths, states, gases = (Table.from_prefixed(ds, kind) for kind in ("path", "state", "expansion"))
    return [
        *(claim for path in paths for claim in _of_path(path)),
        *(_equation_of_state(state) for state in states),
        *(_fluctuation(state) for state in states),
        *([_equipartition(states)] if states else []),
        *(claim for gas in gases for claim in _of_expansion(gas)),
    ]


def _of_path(path: Row) -> list[Claim]:
    estimates, least = exponents(path), path.volume.mean(axis=0).argmin()
    return [
        Claim(
            claim=f"adiabatic exponent of {PARTICLES[path.dimension]}, {how}",
            measured=mean_of(estimates[:, frame]),
            expected=1.0 + 2.0 / path.dimension,
            required=0.01,
            source="d/2 N k_B dT = -P dV, P that of the equation of state (exact for slow changes), and the "
            "heat of Enskog's longitudinal viscosity in the flow that follows the piston",
            fails_if="a piston that gives the gas another work than it loses, or flow that heats it more",
        )
        for how, frame in (("compressed to the least volume", least), ("expanded again, last frame", -1))
    ]


def _name(state: Row) -> str:
    return f"{PARTICLES[state.dimension]}, packing fraction {state.density.mean():.2f}"


def _equation_of_state(state: Row) -> Claim:
    eta, dimension = state.density.mean(), state.dimension
    return Claim(
        claim=f"compressibility factor at constant pressure over the reference, {_name(state)}",
        measured=mean_of(state.factor / theory.compressibility_factor(state.density, dimension)),
        expected=float(theory.constant_enthalpy_factor(eta, dimension, state.count)),
        required=0.005,
        source=f"the equation of state of the infinite fluid, with the volume's fluctuations in {ENSEMBLE}, "
        "to first order in 1/N",
        fails_if="a load that is not the pressure of the gas, or a density disturbed by the walls",
    )


def _fluctuation(state: Row) -> Claim:
    eta, dimension = state.density.mean(), state.dimension
    expected = float(theory.speed_of_sound(eta, dimension)) ** -2
    return Claim(
        claim=f"variance of the volume over that of theory, {_name(state)}",
        measured=mean_of(state.fluctuation) / expected,
        expected=1.0,
        required=0.15,
        source=f"k_B T times the adiabatic compressibility, that is 1 / (m c^2), in {ENSEMBLE}",
        alternative=float(isothermal_variance(eta, dimension)) / expected,
        fails_if="volumes that are not those of this ensemble, such as those of constant temperature",
    )


def isothermal_variance(packing_fraction: float | np.ndarray, dimension: int) -> np.ndarray:
    """Compute N times the relative variance of the volume at constant temperature.

    This variance follows from the speed of sound without the adiabatic term.
    """
    adiabatic = theory.speed_of_sound(packing_fraction, dimension) ** 2
    heating = 2.0 / dimension * theory.compressibility_factor(packing_fraction, dimension) ** 2
    return np.asarray(1.0 / (adiabatic - heating))


def _equipartition(states: Table) -> Claim:
    return Claim.joint(
        claim="kinetic energy of the piston over k_B T / 2 at each state",
        deviations=[(mean_of(state.energy) - 1.0).deviation for state in states],
        source="equipartition",
        fails_if="contacts with the piston that are not elastic, or energy that its load loses",
    )


def _of_expansion(gas: Row) -> list[Claim]:
    which = f"free expansion of {PARTICLES[gas.dimension]}"
    return [
        Claim(
            claim=f"kinetic energy after over before, {which}",
            measured=Estimate(gas.heat.mean(), 1e-12),
            expected=1.0,
            required=1e-9,
            kind="identity",
            source="no wall does work",
            fails_if="contacts that are not elastic",
        ),
        Claim(
            claim=f"mean speed after over that of equilibrium at the first temperature, {which}",
            measured=mean_of(gas.speed),
            expected=1.0,
            required=0.005,
            source="the energy of hard particles does not depend on the volume: the temperature stays; "
            "velocities uniform on the sphere of this energy",
            fails_if="a gas whose flow has not become heat, or that has cooled",
        ),
        Claim(
            claim=f"share of the particles in the half that was empty, {which}",
            measured=mean_of(gas.share),
            expected=0.5,
            required=0.01,
            source="equilibrium",
            fails_if="a gas that has not filled its container",
        ),
    ]


_DILUTE, _NARROW = 0.1, 0.15


def estimators(dataset: xr.Dataset) -> list[Claim]:
    """Return the claims that counts and impulses agree, and that their mixture is better.

    The mixture has the smaller variance, much smaller in a dilute gas. The pressure estimator with known
    means has a smaller variance, too.
    """
    cases = Table(dataset, "case")
    narrow = cases[cases.width < _NARROW]
    dilute, dense = narrow[narrow.packing_fraction < _DILUTE], narrow[narrow.packing_fraction >= _DILUTE]
    once = narrow[narrow.width == narrow.width.min()]
    return [
        *_densities(cases, dilute, dense),
        *each(
            once,
            "pressure by impulses over that with what is known, less 1, at {packing_fraction:.2g}",
            measured=once.pressures_apart,
            expected=0.0,
            required=0.01,
            source="what is taken off has the mean 0 in equilibrium",
            fails_if="directions have unequal parts of the energy, or coefficients follow from the noise",
        ),
        *each(
            once[once.packing_fraction < _DILUTE],
            "squared error of the pressure over that with what is known, at {packing_fraction:.2g}",
            Claim.at_least,
            measured=once[once.packing_fraction < _DILUTE].pressure,
            bound=8.0,
            required=4.0,
            source="without contacts nothing else fluctuates (requirement)",
            fails_if="the energy along the axis is not what the wall is given",
        ),
    ]


def _densities(cases: Table, dilute: Table, dense: Table) -> list[Claim]:
    """Return the claims on densities."""
    return [
        *each(
            cases,
            "mean square of counts less impulses over errors, at {packing_fraction:.2g} in bins of {width:g}",
            measured=cases.mean_square,
            expected=1.0,
            required=0.4,
            source="both are unbiased; errors by blocks, Student's distribution",
            fails_if="impulses are missed, or the temperature of a particle depends on its place",
        ),
        *each(
            dilute,
            "variance of counts over that of the mixture, at {packing_fraction:.2g} in bins of {width:g}",
            Claim.at_least,
            measured=dilute.mixture,
            bound=20.0,
            required=4.0,
            source="the noise of counting is absent (requirement)",
            fails_if="impulses have noise of their own, or weights are too small",
        ),
        *each(
            dense,
            "variance of counts over that of the mixture, at {packing_fraction:.2g} in bins of {width:g}",
            Claim.at_least,
            measured=dense.mixture,
            bound=1.3,
            required=0.2,
            source="a mixture is never worse than counts (requirement)",
            fails_if="weights are chosen by noise",
        ),
    ]
