"""Claims about speeds: kinetic theory during relaxation, Maxwell's distribution in equilibrium."""

from __future__ import annotations

import xarray as xr

from gaspart import theory
from gaspart.reproduction.claims import Claim, Estimate
from gaspart.reproduction.table import Row, Table
from gaspart.theory.speeds import RELAXATION_UNCERTAINTY, Relaxation

ENGINE_TITLES = {"step": "time-stepped", "event": "event-driven"}
BOLTZMANN = "homogeneous Boltzmann equation from equal speeds (gaspart.theory.boltzmann)"
MONTE_CARLO = "statistical error of the Monte Carlo solution"
MAXWELL = "Maxwell's distribution (exact)"
KOLMOGOROV_LIMIT, KOLMOGOROV_SCATTER = 1.818, 0.26
"""Statistics of sqrt(n) times the Kolmogorov distance: it exceeds 1.818 with probability 0.0027, and has a
standard deviation of 0.26."""


def speed_relaxation(dataset: xr.Dataset) -> list[Claim]:
    """Return the claims on kurtosis, never-hit fraction and collisions, for each engine.

    There is a claim at each time of source A's figure 11.
    """
    claims = []
    for gas in Table(dataset, "engine"):
        by, relaxation = f"{ENGINE_TITLES[gas.engine]} engine", theory.relaxation(gas.dimension)
        frames = Table(gas.dataset, "frame")
        claims += [
            *(claim for frame in frames[gas.shown] for claim in _at_time(frame, by, relaxation)),
            _collisions(frames[-1], by, relaxation),
            Claim(
                claim=f"initial slope of the kurtosis per collision and particle ({by})",
                measured=gas.initial_slope,
                expected=theory.initial_kurtosis_slope(gas.dimension),
                required=0.015,
                source="Boltzmann's collision integral (exact)",
                fails_if="the first collisions do not scatter as hard spheres do",
            ),
            Claim.at_most(
                claim=f"relative drift of the energy ({by})",
                kind="identity",
                measured=Estimate(gas.temperature_drift.value.max()),
                bound=1e-12,
                required=1e-12,
                source="elastic collisions (exact)",
                fails_if="an impulse that is not elastic to rounding",
            ),
        ]
    return claims


def _at_time(frame: Row, by: str, relaxation: Relaxation) -> list[Claim]:
    """Return the claims at a time.

    The scatter of the runs includes the scatter of the number of collisions.
    """
    collisions = frame.collisions.value
    when = f"at t = {frame.time:g} ({by})"
    return [
        Claim(
            claim=f"kurtosis of the speeds {when}",
            measured=frame.kurtosis,
            expected=Estimate(relaxation.kurtosis(collisions), RELAXATION_UNCERTAINTY),
            required=0.01,
            source=BOLTZMANN,
            allowance_source=MONTE_CARLO,
            fails_if="collisions that do not scatter isotropically, or a wrong count of them",
        ),
        Claim(
            claim=f"fraction of particles never hit {when}",
            measured=frame.never_hit,
            expected=Estimate(relaxation.never_hit(collisions), RELAXATION_UNCERTAINTY),
            required=0.005,
            source=BOLTZMANN,
            allowance_source=MONTE_CARLO,
            fails_if="collisions that prefer some particles, or a wall that changes a speed",
        ),
    ]


def _collisions(last: Row, by: str, relaxation: Relaxation) -> Claim:
    expected = relaxation.collisions(last.collision_rate * last.time)
    return Claim(
        claim=f"collisions per particle until t = {last.time:g} ({by})",
        measured=last.collisions,
        expected=Estimate(expected, 3.0 * RELAXATION_UNCERTAINTY),
        required=0.03,
        source="Enskog's rate during relaxation, between walls (exact at low density)",
        allowance_source=MONTE_CARLO,
        fails_if="contacts missed or counted twice; 1.2 % of them would be missed if the walls' effect were "
        "ignored",
    )


def speed_distribution_spheres(dataset: xr.Dataset) -> list[Claim]:
    """Return the claims on Maxwell's distribution at each packing fraction, in 3D."""
    return distribution(dataset)


def speed_distribution_discs(dataset: xr.Dataset) -> list[Claim]:
    """Return the claims on Maxwell's distribution in 2D."""
    return distribution(dataset)


def distribution(dataset: xr.Dataset) -> list[Claim]:
    """Return the claims on chi-square, Kolmogorov distance, kurtosis and temperature, by point."""
    return [claim for gas in Table(dataset, "point") for claim in _equilibrium(gas)]


def _equilibrium(gas: Row) -> list[Claim]:
    at = f"at packing fraction {gas.packing_fraction:.3g}"
    kurtosis, temperature = theory.kurtosis(gas.dimension, gas.count), gas.given_temperature
    return [
        Claim.chi_square(
            claim=f"chi-square of {gas.samples} speeds against Maxwell's distribution, {at}",
            chi_square=gas.chi_square,
            degrees_of_freedom=gas.degrees_of_freedom,
            source=MAXWELL,
            fails_if="speeds that are not Maxwell's, or snapshots that are not independent",
        ),
        Claim.at_most(
            claim=f"Kolmogorov distance times sqrt(samples), {at}",
            measured=Estimate(gas.kolmogorov_distance * gas.samples**0.5, KOLMOGOROV_SCATTER),
            bound=KOLMOGOROV_LIMIT,
            required=KOLMOGOROV_SCATTER,
            source=MAXWELL,
            fails_if="a cumulative distribution that deviates from Maxwell's anywhere",
        ),
        Claim(
            claim=f"kurtosis of the speeds, {at}",
            measured=gas.kurtosis,
            expected=kurtosis,
            required=0.01 * kurtosis,
            source=f"Maxwell's, at fixed energy and {gas.count} particles (exact)",
            fails_if="a tail too heavy or too light: not yet in equilibrium",
        ),
        Claim(
            claim=f"temperature <v^2>/{gas.dimension}, {at}",
            kind="identity",
            measured=Estimate(gas.temperature, 1e-12 * temperature),
            expected=temperature,
            required=1e-9 * temperature,
            source="conservation of energy (exact)",
            fails_if="energy is not conserved to rounding",
        ),
        Claim.at_least(
            claim=f"collisions per particle between snapshots, {at}",
            kind="identity",
            measured=Estimate(gas.collisions_between),
            bound=3.0,
            required=1.0,
            source="independent samples are 3 or more collisions per particle apart",
            fails_if="snapshots taken too close for a chi-square test",
        ),
    ]
