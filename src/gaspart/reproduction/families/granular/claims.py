"""Claims about rough, inelastic and driven gases."""

from __future__ import annotations

from typing import Any

import numpy as np
import xarray as xr

from gaspart import theory
from gaspart.reproduction.claims import Claim, Estimate
from gaspart.reproduction.families.shared import PARTICLES, SOURCE_C
from gaspart.reproduction.table import Row, Table, each
from gaspart.theory.rough import ROUGH_START_UNCERTAINTY

HUTHMANN = (
    "[Huthmann 1997]: averages over Maxwellian velocities and spins, computed in "
    "tests/theory/test_granular.py"
)
VAN_NOIJE = "[Haff 1983]; [van Noije 1998], to first order in a2"
DIFFERENCE = 1.5
"""Error of T_tr - T_rot divided by the error of T_rot.

2 T_tr + T_rot is conserved, so both temperatures have the same fluctuation.
"""


def equipartition(dataset: xr.Dataset) -> list[Claim]:
    """Return the claims on equipartition, and on a steady ratio of temperatures.

    Energies per degree of freedom become equal, at the known rate. The ratio is steady if collisions
    dissipate energy.
    """
    still = Table(dataset, "equilibrium")
    return [
        *each(
            still,
            "T_rot / T_tr of rough discs in equilibrium, q = {equilibrium_inertia:g}",
            measured=still.equilibrium_ratio,
            expected=1.0,
            required=0.005,
            source="equipartition (exact)",
            fails_if="contacts are not reversible, or exchange the wrong share of energy",
        ),
        *(claim for gas in Table(dataset, "start") for claim in _decay(gas)),
        *map(_steady, Table(dataset, "cooling")),
        *(claim for gas in Table(dataset, "walls") for claim in _at_walls(gas)),
    ]


def _steady(gas: Row) -> Claim:
    """Return the claim on the ratio of the temperatures of cooling discs."""
    q, tangential = gas.cooling_inertia, gas.tangential
    matches = [line for line in theory.rough_cooling() if np.allclose(line[:3], (q, tangential, 1.0))]
    ratio, error = matches[0][3:] if matches else (theory.rough_ratio(q, tangential), 0.0)
    maxwell = theory.rough_ratio(q, tangential) / ratio
    return Claim(
        claim=f"T_rot / T_tr of cooling discs over theory's, tangential {tangential:g}, q = {q:g}",
        measured=gas.steady_ratio / ratio,
        expected=Estimate(1.0, error / ratio),
        required=0.03,
        source="homogeneous Boltzmann equation, direct simulation (gaspart.theory.boltzmann); Maxwellian "
        f"velocities and spins ([Huthmann 1997]) would give {maxwell:.3f}",
        allowance_source="statistical, of the direct simulation" if matches else "",
        no_verdict="" if matches else "the reference was not computed for these coefficients",
        fails_if="a ratio that is not steady, or dissipation in the wrong place",
    )


def _decay(gas: Row) -> list[Claim]:
    """Return the claims on the initial decay rate without spins, and on the complete curve."""
    q = gas.inertia
    expected = 3.0 * q / (1.0 + q) ** 2
    frames = Table(gas.dataset, "frame")
    frames = frames[np.isfinite(frames.collisions)]  # without variables that only other points have
    beyond = np.asarray(theory.rough_start_excess(q, frames.collisions))
    # where the assumption of Maxwellian velocities is least accurate
    most = np.abs(np.nan_to_num(beyond)).argmax()
    at, is_computed = frames[most], np.isfinite(beyond[most])
    s, rotation = at.collisions, at.rotation
    excess = at.translation.value - rotation.value - np.exp(-expected * s)
    return [
        Claim(
            claim=f"initial decay of T_tr - T_rot per collision of a particle over 3q/(1+q)^2, q = {q:g}",
            measured=gas.rate / expected,
            expected=1.0,
            required=0.01,
            source=f"{HUTHMANN}; exact at the start, where velocities are Maxwellian and all spins 0",
            fails_if="a wrong tangential impulse or torque",
        ),
        Claim(
            claim=f"T_tr - T_rot minus exp(-3q s/(1+q)^2) after {s:.2g} collisions of a particle, q = {q:g}",
            measured=Estimate(excess, DIFFERENCE * rotation.error, rotation.freedom),
            expected=Estimate(beyond[most], ROUGH_START_UNCERTAINTY) if is_computed else 0.0,
            required=0.005,
            source="homogeneous Boltzmann equation, direct simulation (gaspart.theory.boltzmann); "
            "Maxwellian velocities and spins ([Huthmann 1997]) would give 0",
            allowance_source="statistical, of the direct simulation",
            no_verdict="" if is_computed else "the reference was not computed for this inertia",
            fails_if="a gas that is not dilute, or energies that tend to other shares",
        ),
    ]


def _at_walls(gas: Row) -> list[Claim]:
    """Return the claims on energy exchanged only at rough walls.

    The claims concern the fraction of the energy exchanged per hit, and equipartition at the end.
    """
    which = f"{PARTICLES[gas.wall_dimension]} between rough walls, q = {gas.wall_inertia:g}"
    return [
        Claim(
            claim=f"energy that the first hits turn into spin over theory's, {which}",
            measured=gas.exchange,
            expected=1.0,
            required=0.01,
            source=f"{SOURCE_C}, Eq. 40, without collisions: 4q/(1+q)^2 of the tangential energy at a "
            "particle's first hit (exact, gaspart.theory.rough_wall_difference)",
            fails_if="a wrong impulse or torque at walls",
        ),
        Claim(
            claim=f"T_rot / T_tr along the walls in the end over theory's, {which}",
            measured=gas.wall_ratio,
            expected=1.0,
            required=0.01,
            source="the same: 1 within 0.003, equipartition without collisions, as hits at different times "
            "lose each other's phase",
            fails_if="hits that are not reversible, or turn velocity and spin by angles that repeat",
        ),
    ]


def cooling(dataset: xr.Dataset) -> list[Claim]:
    """Return the claims on Haff's law, its rate and exponent, and on clusters that end it."""
    claims = []
    for gas in Table(dataset, "gas"):
        dimension, e = gas.dimension, gas.restitution
        which = f"{PARTICLES[dimension]}, restitution {e:g}"
        finite = float(theory.cooling_rate_finite_size_factor(gas.count, dimension))
        claims += [
            Claim(
                claim=f"-d ln T / ds over (1 - e^2)/d (1 + a2/4), {which}",
                measured=gas.rate / theory.cooling_rate(e, dimension),
                expected=finite,
                required=0.005,
                source=f"{VAN_NOIJE}; times d N/(d N - d + 1), at one energy and total momentum zero (exact)",
                alternative=finite / (1.0 + 0.25 * float(theory.fourth_cumulant(e, dimension))),
                fails_if="contacts that dissipate too much or too little, as without a2",
            ),
            Claim(
                claim=f"exponent of T against 1 + t/t_H, {which}",
                measured=gas.exponent,
                expected=-2.0,
                required=0.02,
                source=VAN_NOIJE,
                fails_if="a gas that does not stay homogeneous, or collisions that do not slow down as "
                "sqrt(T)",
            ),
        ]
    return claims + _clusters(Table(dataset, "clusters"))


def elastic_variance(gases: Table) -> float:
    """Compute the variance of the particle number in a cell of an elastic gas in equilibrium."""
    elastic = gases[gases.cluster_restitution == 1.0]
    return float(np.nanmean(elastic.variance.value[:, 1:]))


def _clusters(gases: Table) -> list[Claim]:
    """Return the claims on the final gas, which is inhomogeneous and hotter than Haff's law.

    The elastic gas is unchanged.
    """
    usual = elastic_variance(gases)
    claims = []
    for gas in gases[gases.cluster_restitution != 1.0]:
        end = f"in the end, restitution {gas.cluster_restitution:g}"
        claims += [
            _claim_growth(
                f"variance of the number in a cell over the elastic gas's, {end}",
                gas.variance[-1] / usual,
                least=3.0,
                source="[Goldhirsch 1993]: a large inelastic gas forms clusters",
                fails_if="a gas that stays homogeneous",
            ),
            _claim_growth(
                f"T over Haff's law, {end}",
                gas.cluster_excess[-1],
                least=2.0,
                source="vortices and clusters hold energy that contacts do not reach (same source)",
                fails_if="a gas that continues to cool by Haff's law",
            ),
        ]
    return claims


def _claim_growth(subject: str, ratio: Estimate, least: float, **others: Any) -> Claim:
    """Return the claim that the logarithm of a ratio is at least ln(`least`).

    The logarithm is 0 for an unchanged gas.
    """
    bound = np.log(least)
    return Claim.at_least(
        claim=f"ln of {subject}",
        measured=Estimate(np.log(ratio.value), ratio.error / ratio.value),
        bound=bound,
        required=bound / 3.0,  # distinguishes an unchanged gas with 3 sigma
        **others,
    )


BALANCE = (
    "kicks against contacts at Enskog's rate; [van Noije 1998], first order in a2; no correlations, "
    "which amount to less than 0.2 % at this density"
)
HEATED = (
    "[van Noije 1998], first order in a2, derived again from the moments of the cooling gas; exact "
    "correction for the number of particles"
)


def driven_gas(ds: xr.Dataset) -> list[Claim]:
    """Return the claims on the steady temperature and the deviation from Maxwell velocities.

    At this temperature, collisions dissipate the energy that the random kicks supply.
    """
    gases = Table(ds, "gas")
    claims = [claim for gas in gases for claim in _of_gas(gas)]
    return claims + [_claim_cumulants(own, dimension) for dimension, own in gases.by("dimension")]


def _of_gas(gas: Row) -> list[Claim]:
    e, dimension, power = gas.restitution, gas.dimension, gas.power
    which = f"{PARTICLES[dimension]}, restitution {e:g}"
    return [
        Claim(
            claim=f"steady temperature over that of the energy balance, {which}",
            measured=gas.temperature
            / float(theory.driven_temperature(e, dimension, power, gas.packing_fraction)),
            expected=1.0,
            required=0.015,
            source=BALANCE,
            fails_if="kicks that give another energy, or contacts that lose another",
        ),
        Claim(
            claim=f"fourth cumulant of the velocities, {which}",
            measured=gas.cumulant,
            expected=float(
                theory.finite_size_cumulant(theory.driven_cumulant(e, dimension), gas.count, dimension)
            ),
            required=0.01,
            source=HEATED,
            fails_if="a distribution that is not that of the heated gas",
        ),
        Claim(
            kind="identity",
            claim=f"energy given by kicks over the power of the thermostat, {which}",
            measured=gas.given / (power * (1.0 - 1.0 / gas.count)),
            expected=1.0,
            required=0.02,
            source="exact, less the share 1/N of the centre of mass",
            fails_if="kicks of the wrong width, or too few of them",
        ),
    ]


def _claim_cumulants(gases: Table, dimension: int) -> Claim:
    """Return the claim on the cumulants of all gases of a dimension, by least squares.

    A single gas is not conclusive.
    """
    heated, cooling = (
        theory.finite_size_cumulant(of(gases.restitution, dimension), gases.count, dimension)
        for of in (theory.driven_cumulant, theory.fourth_cumulant)
    )
    weight = (cooling - heated) / gases.cumulant.error**2
    norm = float(weight @ (cooling - heated))
    return Claim(
        claim=f"fourth cumulants of {PARTICLES[dimension]} from those of the heated gas (0) to those of the "
        "cooling gas (1)",
        measured=Estimate(weight @ (gases.cumulant.value - heated) / norm, norm**-0.5),
        expected=0.0,
        required=0.5,
        source=HEATED,
        alternative=1.0,
        follows=True,
        fails_if="the distribution of the cooling gas",
    )
