"""What the figure of buoyancy claims."""

from __future__ import annotations

import numpy as np
import xarray as xr

from gaspart.analysis.statistics import combine
from gaspart.claims import Claim

THEORY = "scaled-particle theory (Helfand, Frisch and Lebowitz 1961)"
THEORY_ERROR = 0.03
"""Of the effective radius, in small radii: the line tension of scaled-particle theory is good to some 5 %."""


def buoyancy(ds: xr.Dataset) -> list[Claim]:
    """Archimedes's principle; which radius counts as displaced; and where free discs are."""
    return [*_fixed(ds), *_free(ds)]


def _fixed(ds: xr.Dataset) -> list[Claim]:
    """The force on discs held fast."""
    claims = []
    for n in range(ds.sizes["fixed"]):
        row = ds.isel(fixed=n)
        claims.append(
            Claim(
                f"radius displaced beyond the disc's own, in small radii, by the small discs missing, "
                f"height {float(row['fixed_height']):g}",
                "test",
                row["fixed_count_radius"],
                row["fixed_count_radius_error"],
                0.15,
                row["fixed_radius_expected"],
                THEORY,
                expected_uncertainty=THEORY_ERROR,
                fails_if="a fluid that is not drawn to the disc's edge as theory says",
            )
        )
    force, count = ds["fixed_force"].values, ds["fixed_missing"].values
    errors = np.hypot(
        ds["fixed_force_error"].values / count, force * ds["fixed_missing_error"].values / count**2
    )
    ratio = combine(force / count, errors)
    radius = combine(ds["fixed_force_radius"].values, ds["fixed_force_radius_error"].values)
    weights = 1.0 / ds["fixed_force_radius_error"].values ** 2
    expected = float(np.average(ds["fixed_radius_expected"].values, weights=weights))
    claims += [
        Claim(
            "force on discs held fast over the weight of the small discs missing, all heights",
            "test",
            ratio.value,
            ratio.error,
            0.04,
            1.0,
            "Archimedes: F = m g dW/dmu, the work of insertion's slope (exact far from floor and ceiling)",
            fails_if="a force that is not the weight of the fluid displaced",
        ),
        Claim(
            "radius displaced beyond the disc's own, in small radii, by the force, all heights",
            "test",
            radius.value,
            radius.error,
            0.1,
            expected,
            THEORY,
            expected_uncertainty=THEORY_ERROR,
            fails_if="R (0) or R + r (1) alone as the radius that counts in a dense fluid",
        ),
    ]
    return claims


def _free(ds: xr.Dataset) -> list[Claim]:
    """Free discs float where they displace their mass, or lie on the floor."""
    claims = []
    most = float(ds["displaced"].max())
    for n in range(ds.sizes["free"]):
        row = ds.isel(free=n)
        mass = float(row["free_mass"])
        if mass > most:
            claims.append(
                Claim.at_most(
                    f"mean height above the floor of a free disc of mass {mass:g}, which displaces less",
                    "test",
                    row["free_height"] - row["free_lowest"],
                    row["free_height_error"],
                    0.5,
                    2.0,
                    "its weight beyond what it displaces holds it down: kT/(Mg - F)",
                    "a disc that is heavier than what it displaces and does not sink",
                )
            )
            continue
        claims.append(
            Claim(
                f"mean height of a free disc of mass {mass:g}",
                "test",
                row["free_height"],
                row["free_height_error"],
                2.0,
                row["free_expected"],
                f"Boltzmann's factor of its weight and the work of insertion, {THEORY}",
                expected_uncertainty=THEORY_ERROR * float(row["free_expected_spread"]),
                fails_if="a disc that does not float where it displaces its own mass",
            )
        )
    return claims
