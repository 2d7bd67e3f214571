"""What the figures about rough and inelastic bodies claim."""

from __future__ import annotations

import numpy as np
import xarray as xr

from gaspart import theory
from gaspart.claims import Claim

HUTHMANN = "Huthmann & Zippelius 1997 (recalled; Maxwellian velocities and spins, exact averages)"
NAMES = {2: "discs", 3: "spheres"}
VAN_NOIJE = "Haff 1983; van Noije & Ernst 1998 (recalled; first order in a2, uncorrelated bodies)"


def equipartition(ds: xr.Dataset) -> list[Claim]:
    """Equal energies per degree of freedom, at the known rate; a steady ratio where contacts dissipate."""
    claims = []
    for row in (ds.isel(equilibrium=k) for k in range(ds.sizes["equilibrium"])):
        claims.append(
            Claim(
                f"T_rot / T_tr of rough discs in equilibrium, q = {float(row['equilibrium_inertia']):g}",
                "test",
                float(row["equilibrium_ratio"]),
                float(row["equilibrium_ratio_error"]),
                0.005,
                1.0,
                "equipartition (exact)",
                fails_if="contacts are not reversible, or exchange the wrong share of energy",
            )
        )
    for row in (ds.isel(start=k) for k in range(ds.sizes["start"])):
        q = float(row["inertia"])
        expected = 3.0 * q / (1.0 + q) ** 2
        claims.append(
            Claim(
                f"initial decay of T_tr - T_rot per collision of a body over 3q/(1+q)^2, q = {q:g}",
                "test",
                float(row["rate"]) / expected,
                float(row["rate_error"]) / expected,
                0.01,
                1.0,
                f"{HUTHMANN}; exact at the start, where velocities are Maxwellian and all spins 0",
                fails_if="a wrong tangential impulse or torque",
            )
        )
        excess = row["translation"] - row["rotation"] - np.exp(-expected * row["collisions"])
        worst = int(np.abs(excess.values).argmax())
        claims.append(
            Claim.within(
                f"T_tr - T_rot less exp(-3q s/(1+q)^2), where that is largest, q = {q:g}",
                "test",
                float(excess[worst]),
                1.5 * float(row["rotation_error"][worst]),
                0.0,
                0.02,
                f"{HUTHMANN}; a homogeneous Boltzmann gas stays within 0.012 (direct simulation, computed)",
                "a gas that is not dilute, or energies that tend to other shares",
            )
        )
    for row in (ds.isel(cooling=k) for k in range(ds.sizes["cooling"])):
        q, tangential = float(row["cooling_inertia"]), float(row["tangential"])
        expected = theory.rough_ratio(q, tangential)
        claims.append(
            Claim.within(
                f"T_rot / T_tr of cooling discs over theory's, tangential {tangential:g}, q = {q:g}",
                "test",
                float(row["steady_ratio"]) / expected,
                float(row["steady_ratio_error"]) / expected,
                1.0,
                0.06,
                HUTHMANN,
                "a ratio that is not steady, or dissipation in the wrong place; what is left out (spins that "
                "are not Maxwellian, and that know of velocities) is worth some per cent",
            )
        )
    return claims


def cooling(ds: xr.Dataset) -> list[Claim]:
    """Haff's law, its rate and exponent; clusters that end it."""
    claims = []
    for row in (ds.isel(gas=k) for k in range(ds.sizes["gas"])):
        dimension, e = int(row["dimension"]), float(row["restitution"])
        which = f"{NAMES[dimension]}, restitution {e:g}"
        expected = float(theory.cooling_rate(e, dimension))
        claims += [
            Claim(
                f"-d ln T / ds over (1 - e^2)/d (1 + a2/4), {which}",
                "test",
                float(row["rate"]) / expected,
                float(row["rate_error"]) / expected,
                0.005,
                1.0,
                VAN_NOIJE,
                0.003,
                "contacts that dissipate too much or too little; without a2 it would be up to 1 % off",
            ),
            Claim(
                f"exponent of T against 1 + t/t_H, {which}",
                "test",
                float(row["exponent"]),
                float(row["exponent_error"]),
                0.02,
                -2.0,
                VAN_NOIJE,
                0.01,
                "a gas that does not stay homogeneous, or collisions that do not slow down as sqrt(T)",
            ),
        ]
    return claims + _clusters(ds)


def _clusters(ds: xr.Dataset) -> list[Claim]:
    """In the end the gas is neither homogeneous nor as cold as Haff says; the elastic one stays as it was."""
    claims = []
    elastic = ds.isel(clusters=(ds["cluster_restitution"] == 1.0).values)
    usual = float(elastic["variance"].isel(step=slice(1, None)).mean())
    for row in (ds.isel(clusters=k) for k in range(ds.sizes["clusters"])):
        e = float(row["cluster_restitution"])
        if e == 1.0:
            continue
        last = row.isel(step=-1)
        for what, ratio, error, least, source, fails in (
            (
                "variance of the number in a cell over the elastic gas's",
                float(last["variance"]) / usual,
                float(last["variance_error"] / last["variance"]),
                3.0,
                "Goldhirsch & Zanetti 1993: a large inelastic gas forms clusters",
                "a gas that stays homogeneous",
            ),
            (
                "T over Haff's law",
                float(last["cluster_excess"]),
                float(last["cluster_excess_error"] / last["cluster_excess"]),
                2.0,
                "vortices and clusters hold energy that contacts do not reach (same source)",
                "a gas that goes on cooling by Haff's law",
            ),
        ):
            # An uncertainty of a third of the bound tells a gas that is as ever (0) by 3 sigma.
            text = f"ln of {what}, in the end, restitution {e:g}"
            bound = np.log(least)
            claims.append(
                Claim.at_least(text, "test", np.log(ratio), error, bound / 3.0, bound, source, fails)
            )
    return claims
