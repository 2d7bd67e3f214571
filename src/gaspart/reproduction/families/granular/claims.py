"""Claims about rough and inelastic particles."""

from __future__ import annotations

import numpy as np
import xarray as xr

from gaspart import theory
from gaspart.reproduction.claims import Claim, Estimate
from gaspart.reproduction.families.shared.claims import PARTICLES, SOURCE_C, rows
from gaspart.theory.granular import ROUGH_START_UNCERTAINTY

HUTHMANN = (
    "[Huthmann 1997]: averages over Maxwellian velocities and spins, computed in "
    "tests/theory/test_granular.py"
)
VAN_NOIJE = "[Haff 1983]; [van Noije 1998], to first order in a2"


def equipartition(ds: xr.Dataset) -> list[Claim]:
    """Equal energies per degree of freedom, at the known rate; a steady ratio where contacts dissipate."""
    claims = [
        Claim(
            claim=f"T_rot / T_tr of rough discs in equilibrium, q = {float(row['equilibrium_inertia']):g}",
            measured=Estimate.of(row, "equilibrium_ratio"),
            expected=1.0,
            required=0.005,
            source="equipartition (exact)",
            fails_if="contacts are not reversible, or exchange the wrong share of energy",
        )
        for row in rows(ds, "equilibrium")
    ]
    for row in rows(ds, "start"):
        claims += _decay(row)
    for row in rows(ds, "cooling"):
        claims.append(_steady(row))
    for row in rows(ds, "walls"):
        claims += _at_walls(row)
    return claims


def _steady(row: xr.Dataset) -> Claim:
    """The ratio of the temperatures of discs that cool."""
    q, tangential = float(row["cooling_inertia"]), float(row["tangential"])
    known = [line for line in theory.rough_cooling() if np.allclose(line[:3], (q, tangential, 1.0))]
    ratio, error = known[0][3:] if known else (theory.rough_ratio(q, tangential), 0.0)
    maxwell = theory.rough_ratio(q, tangential) / ratio
    return Claim(
        claim=f"T_rot / T_tr of cooling discs over theory's, tangential {tangential:g}, q = {q:g}",
        measured=Estimate.of(row, "steady_ratio") / ratio,
        expected=Estimate(1.0, error / ratio),
        required=0.03,
        source="homogeneous Boltzmann equation, direct simulation (gaspart.theory.homogeneous); Maxwellian "
        f"velocities and spins ([Huthmann 1997]) would give {maxwell:.3f}",
        allowance_source="statistical, of the direct simulation" if known else "",
        no_verdict="" if known else "the reference was not computed for these coefficients",
        fails_if="a ratio that is not steady, or dissipation in the wrong place",
    )


def _decay(row: xr.Dataset) -> list[Claim]:
    """From spins 0: the initial rate, and the whole curve."""
    q = float(row["inertia"])
    expected = 3.0 * q / (1.0 + q) ** 2
    row = row.dropna("frame", subset=["collisions"])  # those that only other points have
    known = np.asarray(theory.rough_start_excess(q, row["collisions"].values))
    most = int(np.abs(np.nan_to_num(known)).argmax())  # where Maxwellian velocities err most
    at, s = row.isel(frame=most), float(row["collisions"][most])
    excess = at["translation"] - at["rotation"] - np.exp(-expected * s)
    few = Estimate.of(at, "rotation").freedom
    return [
        Claim(
            claim=f"initial decay of T_tr - T_rot per collision of a particle over 3q/(1+q)^2, q = {q:g}",
            measured=Estimate.of(row, "rate") / expected,
            expected=1.0,
            required=0.01,
            source=f"{HUTHMANN}; exact at the start, where velocities are Maxwellian and all spins 0",
            fails_if="a wrong tangential impulse or torque",
        ),
        Claim(
            claim=f"T_tr - T_rot minus exp(-3q s/(1+q)^2) after {s:.2g} collisions of a particle, q = {q:g}",
            measured=Estimate(excess, 1.5 * float(at["rotation_error"]), few),
            expected=Estimate(known[most], ROUGH_START_UNCERTAINTY) if np.isfinite(known[most]) else 0.0,
            required=0.005,
            source="homogeneous Boltzmann equation, direct simulation (gaspart.theory.homogeneous); "
            "Maxwellian velocities and spins ([Huthmann 1997]) would give 0",
            allowance_source="statistical, of the direct simulation",
            no_verdict="" if np.isfinite(known[most]) else "the reference was not computed for this inertia",
            fails_if="a gas that is not dilute, or energies that tend to other shares",
        ),
    ]


def _at_walls(row: xr.Dataset) -> list[Claim]:
    """Energy that is exchanged at rough walls only: the share of a hit, and equal shares in the end."""
    q = float(row["wall_inertia"])
    which = f"{PARTICLES[int(row['wall_dimension'])]} between rough walls, q = {q:g}"
    return [
        Claim(
            claim=f"energy that the first hits turn into spin over theory's, {which}",
            measured=Estimate.of(row, "exchange"),
            expected=1.0,
            required=0.01,
            source=f"{SOURCE_C}, Eq. 40, without collisions: 4q/(1+q)^2 of the tangential energy at a "
            "particle's first hit (exact, gaspart.theory.rough_wall_difference)",
            fails_if="a wrong impulse or torque at walls",
        ),
        Claim(
            claim=f"T_rot / T_tr along the walls in the end over theory's, {which}",
            measured=Estimate.of(row, "wall_ratio"),
            expected=1.0,
            required=0.01,
            source="the same: 1 within 0.003, equipartition without collisions, as hits at different times "
            "lose each other's phase",
            fails_if="hits that are not reversible, or turn velocity and spin by angles that repeat",
        ),
    ]


def cooling(ds: xr.Dataset) -> list[Claim]:
    """Haff's law, its rate and exponent; clusters that end it."""
    claims = []
    for row in rows(ds, "gas"):
        dimension, e = int(row["dimension"]), float(row["restitution"])
        which, count = f"{PARTICLES[dimension]}, restitution {e:g}", float(row["count"])
        finite = float(theory.cooling_rate_finite_size_factor(count, dimension))
        claims += [
            Claim(
                claim=f"-d ln T / ds over (1 - e^2)/d (1 + a2/4), {which}",
                measured=Estimate.of(row, "rate") / theory.cooling_rate(e, dimension),
                expected=finite,
                required=0.005,
                source=f"{VAN_NOIJE}; times d N/(d N - d + 1), at one energy and total momentum zero (exact)",
                alternative=finite / (1.0 + 0.25 * float(theory.fourth_cumulant(e, dimension))),
                fails_if="contacts that dissipate too much or too little, as without a2",
            ),
            Claim(
                claim=f"exponent of T against 1 + t/t_H, {which}",
                measured=Estimate.of(row, "exponent"),
                expected=-2.0,
                required=0.02,
                source=VAN_NOIJE,
                fails_if="a gas that does not stay homogeneous, or collisions that do not slow down as "
                "sqrt(T)",
            ),
        ]
    return claims + _clusters(ds)


def _clusters(ds: xr.Dataset) -> list[Claim]:
    """In the end the gas is neither homogeneous nor as cold as Haff's law; the elastic one is unchanged."""
    elastic = ds.isel(clusters=(ds["cluster_restitution"] == 1.0).values)
    usual = float(elastic["variance"].isel(step=slice(1, None)).mean())
    claims = []
    for row in rows(ds.isel(clusters=(ds["cluster_restitution"] != 1.0).values), "clusters"):
        last, e = row.isel(step=-1), float(row["cluster_restitution"])
        for what, name, unit, least, source, fails_if in (
            (
                "variance of the number in a cell over the elastic gas's",
                "variance",
                usual,
                3.0,
                "[Goldhirsch 1993]: a large inelastic gas forms clusters",
                "a gas that stays homogeneous",
            ),
            (
                "T over Haff's law",
                "cluster_excess",
                1.0,
                2.0,
                "vortices and clusters hold energy that contacts do not reach (same source)",
                "a gas that continues to cool by Haff's law",
            ),
        ):
            ratio, bound = Estimate.of(last, name), np.log(least)
            claims.append(
                Claim.at_least(
                    claim=f"ln of {what}, in the end, restitution {e:g}",
                    measured=Estimate(np.log(ratio.value / unit), ratio.error / ratio.value),
                    bound=bound,
                    required=bound / 3.0,  # distinguishes an unchanged gas (0) by 3 sigma
                    source=source,
                    fails_if=fails_if,
                )
            )
    return claims
