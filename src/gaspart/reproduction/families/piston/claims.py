"""Claims about gases behind a piston."""

from __future__ import annotations

import numpy as np
import xarray as xr

from gaspart import theory
from gaspart.analysis.statistics import mean_of
from gaspart.reproduction.claims import Claim, Estimate
from gaspart.reproduction.families.shared.claims import PARTICLES, rows

ENSEMBLE = "the ensemble of constant pressure and enthalpy ([Andersen 1980])"


def exponents(path: xr.Dataset) -> np.ndarray:
    """(path_replica, frame) 1 + 2/d times the logarithm of the temperature ratio over that of theory.

    What viscosity heats is subtracted first.
    """
    dimension, first = int(path["path_dimension"]), float(path["path_packing_fraction"])
    eta = np.minimum(first / path["path_volume"].values, theory.HIGHEST_PACKING_FRACTION[dimension])
    expected = theory.adiabatic_temperature(eta, first, dimension)
    with np.errstate(divide="ignore", invalid="ignore"):
        ratio = (np.log(path["path_temperature"].values) - path["path_heating"].values) / np.log(expected)
    return 1.0 + 2.0 / dimension * ratio


def piston(ds: xr.Dataset) -> list[Claim]:
    """Adiabatic exponents, states at constant pressure, and free expansions."""
    claims = [claim for path in rows(ds, "path") for claim in _of_path(path)]
    states = rows(ds, "state")
    claims += [_equation_of_state(state) for state in states]
    claims += [_fluctuation(state) for state in states]
    if states:
        energies = [mean_of(state["state_energy"].values) for state in states]
        claims += [_equipartition(energies)]
    return claims + [claim for gas in rows(ds, "expansion") for claim in _of_expansion(gas)]


def _of_path(path: xr.Dataset) -> list[Claim]:
    dimension, found = int(path["path_dimension"]), exponents(path)
    least = int(path["path_volume"].mean("path_replica").values.argmin())
    return [
        Claim(
            claim=f"adiabatic exponent of {PARTICLES[dimension]}, {how}",
            measured=mean_of(found[:, frame]),
            expected=1.0 + 2.0 / dimension,
            required=0.01,
            source="d/2 N k_B dT = -P dV, P that of the equation of state (exact for slow changes), and the "
            "heat of Enskog's longitudinal viscosity in the flow that follows the piston",
            fails_if="a piston that gives the gas another work than it loses, or flow that heats it more",
        )
        for how, frame in (("compressed to the least volume", least), ("expanded again, last frame", -1))
    ]


def _name(state: xr.Dataset) -> str:
    dimension = int(state["state_dimension"])
    return f"{PARTICLES[dimension]}, packing fraction {float(state['state_density'].mean()):.2f}"


def _equation_of_state(state: xr.Dataset) -> Claim:
    dimension, eta = int(state["state_dimension"]), state["state_density"].values
    count = float(state["state_count"])
    expected = theory.compressibility_factor(eta, dimension)
    return Claim(
        claim=f"compressibility factor at constant pressure over the reference, {_name(state)}",
        measured=mean_of(state["state_factor"].values / expected),
        expected=float(theory.constant_enthalpy_factor(float(eta.mean()), dimension, count)),
        required=0.005,
        source=f"the equation of state of the infinite fluid, with the volume's fluctuations in {ENSEMBLE}, "
        "to first order in 1/N",
        fails_if="a load that is not the pressure of the gas, or a density disturbed by the walls",
    )


def _fluctuation(state: xr.Dataset) -> Claim:
    dimension, eta = int(state["state_dimension"]), float(state["state_density"].mean())
    expected = float(theory.speed_of_sound(eta, dimension)) ** -2
    return Claim(
        claim=f"variance of the volume over that of theory, {_name(state)}",
        measured=mean_of(state["state_fluctuation"].values) / expected,
        expected=1.0,
        required=0.15,
        source=f"k_B T times the adiabatic compressibility, that is 1 / (m c^2), in {ENSEMBLE}",
        alternative=isothermal_variance(eta, dimension) / expected,
        fails_if="volumes that are not those of this ensemble, such as those of constant temperature",
    )


def isothermal_variance(packing_fraction: float, dimension: int) -> float:
    """N times the relative variance of the volume at constant temperature: that of the speed of sound without
    the adiabatic term."""
    adiabatic = float(theory.speed_of_sound(packing_fraction, dimension)) ** 2
    heating = 2.0 / dimension * float(theory.compressibility_factor(packing_fraction, dimension)) ** 2
    return 1.0 / (adiabatic - heating)


def _equipartition(energies: list[Estimate]) -> Claim:
    return Claim.joint(
        claim="kinetic energy of the piston over k_B T / 2 at each state",
        deviations=[(energy - 1.0).deviation for energy in energies],
        source="equipartition",
        fails_if="contacts with the piston that are not elastic, or energy that its load loses",
    )


def _of_expansion(gas: xr.Dataset) -> list[Claim]:
    which = f"free expansion of {PARTICLES[int(gas['expansion_dimension'])]}"
    return [
        Claim(
            claim=f"kinetic energy after over before, {which}",
            measured=Estimate(gas["expansion_heat"].mean(), 1e-12),
            expected=1.0,
            required=1e-9,
            kind="identity",
            source="no wall does work",
            fails_if="contacts that are not elastic",
        ),
        Claim(
            claim=f"mean speed after over that of equilibrium at the first temperature, {which}",
            measured=mean_of(gas["expansion_speed"].values),
            expected=1.0,
            required=0.005,
            source="the energy of hard particles does not depend on the volume: the temperature stays; "
            "velocities uniform on the sphere of this energy",
            fails_if="a gas whose flow has not become heat, or that has cooled",
        ),
        Claim(
            claim=f"share of the particles in the half that was empty, {which}",
            measured=mean_of(gas["expansion_share"].values),
            expected=0.5,
            required=0.01,
            source="equilibrium",
            fails_if="a gas that has not filled its container",
        ),
    ]
