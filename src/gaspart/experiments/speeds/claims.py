"""What the speed figures claim: kinetic theory on the way to equilibrium, Maxwell's distribution in it."""

from __future__ import annotations

import xarray as xr

from gaspart import theory
from gaspart.claims import Claim
from gaspart.theory.speeds import RELAXATION_UNCERTAINTY, Relaxation

ENGINES = {"step": "time-stepped", "event": "event-driven"}
BOLTZMANN = "homogeneous Boltzmann equation from equal speeds (computed)"
MAXWELL = "Maxwell's distribution (exact)"
KOLMOGOROV_LIMIT, KOLMOGOROV_SCATTER = 1.818, 0.26
"""sqrt(n) times the Kolmogorov distance is above 1.818 with probability 0.0027, and scatters by 0.26."""


def speed_relaxation(ds: xr.Dataset) -> list[Claim]:
    """Kurtosis, never-hit fraction and collisions at each time of source A's figure 11, for each engine."""
    relaxation = theory.relaxation(ds.attrs["dimension"])
    claims = []
    for engine in ds["engine"].values:
        by = f"{ENGINES[str(engine)]} engine"
        for frame in ds["shown"].values:
            row = ds.sel(engine=engine).isel(frame=int(frame))
            s = float(row["collisions"])
            when = f"at t = {float(row['time']):g} ({by})"
            # s scatters too, but together with the run's kurtosis: that is in the scatter of the runs.
            claims += [
                Claim(
                    f"kurtosis of the speeds {when}",
                    "test",
                    row["kurtosis"],
                    row["kurtosis_error"],
                    0.01,
                    relaxation.kurtosis(s),
                    BOLTZMANN,
                    RELAXATION_UNCERTAINTY,
                    "collisions that do not scatter isotropically, or a wrong count of them",
                ),
                Claim(
                    f"fraction of bodies never hit {when}",
                    "test",
                    row["never_hit"],
                    row["never_hit_error"],
                    0.005,
                    relaxation.never_hit(s),
                    BOLTZMANN,
                    RELAXATION_UNCERTAINTY,
                    "collisions that prefer some bodies, or a wall that changes a speed",
                ),
            ]
        claims += [_collisions(ds, engine, by, relaxation), _initial_slope(ds, engine, by)]
        claims.append(
            Claim.at_most(
                f"relative drift of the energy ({by})",
                "identity",
                float(ds["temperature_drift"].sel(engine=engine).max()),
                0.0,
                1e-12,
                1e-12,
                "elastic collisions (exact)",
                "an impulse that is not elastic to rounding",
            )
        )
    return claims


def _collisions(ds: xr.Dataset, engine: str, by: str, relaxation: Relaxation) -> Claim:
    last = ds.sel(engine=engine).isel(frame=-1)
    time = float(last["time"])
    return Claim(
        f"collisions per body until t = {time:g} ({by})",
        "test",
        last["collisions"],
        last["collisions_error"],
        0.03,
        relaxation.collisions(ds.attrs["collision_rate"] * time),
        "Enskog's rate on the way to equilibrium, between walls (exact at low density)",
        3.0 * RELAXATION_UNCERTAINTY,
        "contacts missed or counted twice; 1.2 % of them would be missed if the walls' effect were ignored",
    )


def _initial_slope(ds: xr.Dataset, engine: str, by: str) -> Claim:
    row = ds.sel(engine=engine)
    return Claim(
        f"initial slope of the kurtosis per collision and body ({by})",
        "test",
        row["initial_slope"],
        row["initial_slope_error"],
        0.015,
        theory.initial_kurtosis_slope(ds.attrs["dimension"]),
        "Boltzmann's collision integral (exact)",
        fails_if="the first collisions do not scatter as hard spheres do",
    )


def speed_distribution_spheres(ds: xr.Dataset) -> list[Claim]:
    """Maxwell's distribution at each packing fraction, in 3D."""
    return distribution(ds)


def speed_distribution_discs(ds: xr.Dataset) -> list[Claim]:
    """Maxwell's distribution in 2D."""
    return distribution(ds)


def distribution(ds: xr.Dataset) -> list[Claim]:
    """Chi-square, Kolmogorov's distance, kurtosis and temperature of every point."""
    dimension = ds.attrs["dimension"]
    claims = []
    for index in range(ds.sizes["point"]):
        row = ds.isel(point=index)
        at = f"at packing fraction {float(row['packing_fraction']):.3g}"
        samples, count = int(row["samples"]), int(row["count"])
        equilibrium = theory.kurtosis(dimension, count)
        claims += [
            Claim.chi_square(
                f"chi-square of {samples} speeds against Maxwell's distribution, {at}",
                "test",
                float(row["chi_square"]),
                int(row["degrees_of_freedom"]),
                MAXWELL,
                "speeds that are not Maxwell's, or snapshots that are not independent",
            ),
            Claim.at_most(
                f"Kolmogorov distance times sqrt(samples), {at}",
                "test",
                float(row["kolmogorov_distance"]) * samples**0.5,
                KOLMOGOROV_SCATTER,
                KOLMOGOROV_SCATTER,
                KOLMOGOROV_LIMIT,
                MAXWELL,
                "a cumulative distribution that leaves Maxwell's anywhere",
            ),
            Claim(
                f"kurtosis of the speeds, {at}",
                "test",
                row["kurtosis"],
                row["kurtosis_error"],
                0.01 * equilibrium,
                equilibrium,
                f"Maxwell's, at fixed energy and {count} bodies (exact)",
                fails_if="a tail too heavy or too light: not yet in equilibrium",
            ),
            Claim(
                f"temperature <v^2>/{dimension}, {at}",
                "identity",
                row["temperature"],
                1e-12 * float(row["given_temperature"]),
                1e-9 * float(row["given_temperature"]),
                row["given_temperature"],
                "conservation of energy (exact)",
                fails_if="energy is not conserved to rounding",
            ),
            Claim.at_least(
                f"collisions per body between snapshots, {at}",
                "identity",
                row["collisions_between"],
                0.0,
                1.0,
                3.0,
                "independent samples are 3 or more collisions per body apart",
                "snapshots taken too close for a chi-square test",
            ),
        ]
    return claims
