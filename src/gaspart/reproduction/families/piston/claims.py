"""Claims about gases behind a piston."""

from __future__ import annotations

import numpy as np
import xarray as xr

from gaspart import theory
from gaspart.analysis.statistics import mean_of
from gaspart.reproduction.claims import Claim, Estimate
from gaspart.reproduction.families.shared import PARTICLES
from gaspart.reproduction.table import Row, Table

ENSEMBLE = "the ensemble of constant pressure and enthalpy ([Andersen 1980])"


def exponents(path: Row) -> np.ndarray:
    """Compute 1 + 2/d times the logarithm of the temperature ratio over theory's.

    The shape is (path_replica, frame). The heat of viscosity is subtracted first.
    """
    dimension, first = path.dimension, path.packing_fraction
    eta = np.minimum(first / path.volume, theory.HIGHEST_PACKING_FRACTION[dimension])
    expected = theory.adiabatic_temperature(eta, first, dimension)
    with np.errstate(divide="ignore", invalid="ignore"):
        ratio = (np.log(path.temperature) - path.heating) / np.log(expected)
    return np.asarray(1.0 + 2.0 / dimension * ratio)


def piston(ds: xr.Dataset) -> list[Claim]:
    """Return the claims on adiabatic exponents, states at constant pressure, and free expansions."""
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

    It follows from the speed of sound without the adiabatic term.
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
