"""Claims about the structure of the fluid and its chemical potential."""

from __future__ import annotations

import numpy as np
import xarray as xr

from gaspart.reproduction.claims import Claim, Estimate
from gaspart.reproduction.families.shared.claims import PARTICLES, SOURCE_C, deviations, rows

AGREE = 0.005
"""The largest standard error at which an agreement to 1 % means anything."""
DENSE = 0.25
"""Packing fraction from which on Percus and Yevick's numbers of spheres differ from the true ones by more
than the measurement's errors: its compressibility by 4 % and more, its contact value likewise."""
DENSEST = 0.4
"""From which on so do its curves throughout, beside their noise."""


def structure(ds: xr.Dataset) -> list[Claim]:
    """Compressibility and contact value by independent routes; Verlet and Weis's curves."""
    claims = []
    for row in rows(ds, "point"):
        claims += [_compressibility(row), *_contact(row)]
        if int(row["dimension"]) == 3 and float(row["packing_fraction"]) >= DENSEST:
            claims += _curves(row)
    return claims


def _where(row: xr.Dataset) -> str:
    return f"{PARTICLES[int(row['dimension'])]}, packing fraction {float(row['packing_fraction']):.3g}"


def _compressibility(row: xr.Dataset) -> Claim:
    eta = float(row["packing_fraction"])
    spheres = int(row["dimension"]) == 3
    yevick = (1.0 - eta) ** 4 / (1.0 + 2.0 * eta) ** 2
    return Claim(
        claim=f"S(0) over the compressibility of the measured equation of state, {_where(row)}",
        measured=Estimate.of(row, "s0_ratio"),
        expected=1.0,
        required=AGREE,
        source="S(0) = k T dρ/dP, the fluctuation of the number (exact)",
        alternative=yevick / float(row["state_s0"]) if spheres and eta >= DENSE else None,
        fails_if="wave vectors that the container does not admit, too few independent frames, an "
        "extrapolation that does not hold, or a wrong pressure",
    )


def _contact(row: xr.Dataset) -> list[Claim]:
    eta, where = float(row["packing_fraction"]), _where(row)
    spheres = int(row["dimension"]) == 3
    excluded = (1.0 + 0.5 * eta) / (1.0 - eta) ** 2 / float(row["contact_z"])
    return [
        Claim(
            claim=f"contact value from g(r) over that from Z, {where}",
            measured=Estimate.of(row, "g_ratio"),
            expected=1.0,
            required=AGREE,
            source="the virial theorem: Z = 1 + 2^(d-1) η g(σ) (exact)",
            alternative=excluded if spheres and eta >= DENSE else None,
            fails_if="frames that are no sample of what the collisions see, pairs that are counted wrongly, "
            "or a wrong pressure",
        ),
        Claim(
            claim=f"contact value from the collision rate over that from Z, {where}",
            measured=Estimate.of(row, "rate_ratio"),
            expected=1.0,
            required=AGREE,
            source="velocities are independent of positions: the rate is g(σ) times that of independent "
            "particles (exact, for N particles of a fixed energy)",
            follows=True,
            fails_if="collisions missed, or relative speeds at contact that are not Maxwellian",
        ),
    ]


def _curves(row: xr.Dataset) -> list[Claim]:
    return [
        Claim.at_most(
            claim=f"distance of {name} from Verlet and Weis's over that from Percus and Yevick's, "
            f"{_where(row)}",
            measured=Estimate.of(row, key),
            bound=0.5,
            required=0.1,
            source="[Verlet 1972] corrects the contact value and the phase of [Percus 1958]; one half is "
            "chosen here",
            fails_if="a wrong phase or height of the maxima, measured or computed",
        )
        for name, key in (("g(r)", "g_gain"), ("S(k)", "s_gain"))
    ]


def chemical_potential(ds: xr.Dataset) -> list[Claim]:
    """Insertion against Gibbs and Duhem where it works, what happens where it does not, and Q."""
    enough = int(ds.attrs["enough"])
    claims = [_works(row) if int(row["works"]) else _fails(row, enough) for row in rows(ds, "point")]
    for dimension in (3, 2):
        part = ds.isel(point=np.flatnonzero((ds["dimension"] == dimension) & (ds["works"] == 1)))
        if part.sizes["point"] > 1:
            claims.append(
                Claim.joint(
                    claim=f"chemical potential by insertion of {PARTICLES[dimension]}, all packing fractions",
                    deviations=deviations(part, "inserted", "reference"),
                    source="the integral of the reference equation of state ([Kolafa 2004], [Clisby 2006])",
                    fails_if="a bias too small for one point is common to many, or the error bars are wrong",
                )
            )
            claims += [_partition(row) for row in rows(part, "point")[-1:] if np.isfinite(row["ln_q_ratio"])]
    return claims


def _works(row: xr.Dataset) -> Claim:
    return Claim(
        claim=f"chemical potential by insertion over that of the equation of state, {_where(row)}",
        measured=Estimate.of(row, "ratio"),
        expected=1.0,
        required=0.01,
        source="[Widom 1963] and the equation of Gibbs and Duhem, with the measured Z (both exact)",
        fails_if="places that are not uniform, overlaps that are missed, correlated frames that are "
        "counted as independent, or a wrong pressure",
    )


def _fails(row: xr.Dataset, enough: int) -> Claim:
    hits = int(row["hit_frames"])
    return Claim(
        claim=f"chance of an insertion over that of the equation of state, {_where(row)}",
        measured=Estimate.of(row, "probability") / float(row["expected"]),
        expected=1.0,
        required=1.0,
        source=f"as where it works; the chemical potential is {float(row['reference']):.3g} k T",
        no_verdict=f"only {hits} of {int(row['frames'])} frames have a free place ({enough} are asked for): "
        "their number is no Gaussian one",
        fails_if="places that are not uniform, or overlaps that are missed",
    )


def _partition(row: xr.Dataset) -> Claim:
    return Claim(
        claim=f"ln Q / N by insertion over that of the measured equation of state, {_where(row)}",
        measured=Estimate.of(row, "ln_q_ratio"),
        expected=1.0,
        required=0.01,
        source=f"{SOURCE_C}, Eq. 46: both are the free energy beyond an ideal gas's (exact)",
        follows=True,
        fails_if="insertion or the pressure is wrong at a lower density",
    )
