"""Claims about buoyancy."""

from __future__ import annotations

import numpy as np
import xarray as xr

from gaspart.analysis.statistics import combine
from gaspart.claims import Claim, Estimate
from gaspart.experiments.shared.claims import rows

THEORY = "scaled-particle theory (Helfand, Frisch and Lebowitz 1961)"


def buoyancy(ds: xr.Dataset) -> list[Claim]:
    """Archimedes's principle; the displaced radius; the heights of free discs."""
    return [*_fixed(ds), *(_free(row, float(ds["displaced"].max())) for row in rows(ds, "free"))]


def _fixed(ds: xr.Dataset) -> list[Claim]:
    """The force on fixed discs."""
    claims = [
        Claim(
            claim="radius displaced beyond the disc's own, in small radii, by the small discs missing, "
            f"height {float(row['fixed_height']):g}",
            measured=Estimate.of(row, "fixed_count_radius"),
            expected=row["fixed_radius_expected"],
            required=0.15,
            source=THEORY,
            alternative=_nearer(row["fixed_radius_expected"]),
            fails_if="a fluid that does not accumulate at the disc's edge as theory states",
        )
        for row in rows(ds, "fixed")
    ]
    force, count = ds["fixed_force"].values, ds["fixed_missing"].values
    errors = np.hypot(
        ds["fixed_force_error"].values / count, force * ds["fixed_missing_error"].values / count**2
    )
    ratio = combine(force / count, errors)
    radius = combine(ds["fixed_force_radius"].values, ds["fixed_force_radius_error"].values)
    weights = 1.0 / ds["fixed_force_radius_error"].values ** 2
    expected = np.average(ds["fixed_radius_expected"].values, weights=weights)
    return [
        *claims,
        Claim(
            claim="force on fixed discs over the weight of the small discs missing, all heights",
            measured=Estimate(ratio.value, ratio.error),
            expected=1.0,
            required=0.04,
            source="Archimedes: F = m g dW/dmu, the slope of the work of insertion (exact far from floor and "
            "ceiling)",
            fails_if="a force that is not the weight of the displaced fluid",
        ),
        Claim(
            claim="radius displaced beyond the disc's own, in small radii, by the force, all heights",
            measured=Estimate(radius.value, radius.error),
            expected=expected,
            required=0.1,
            source=THEORY,
            alternative=_nearer(expected),
            fails_if="R (0) or R + r (1) alone as the radius that counts in a dense fluid",
        ),
    ]


def _nearer(radius: float | xr.DataArray) -> float:
    """R or R + r, as 0 or 1, whichever is nearer."""
    return 0.0 if float(radius) < 0.5 else 1.0


def _free(row: xr.Dataset, largest: float) -> Claim:
    """A free disc floats where it displaces its mass, or lies on the floor if it always displaces less."""
    mass = float(row["free_mass"])
    if mass > largest:
        return Claim.at_most(
            claim=f"mean height above the floor of a free disc of mass {mass:g}, which displaces less",
            measured=Estimate.of(row, "free_height") - row["free_lowest"],
            bound=2.0,
            required=0.5,
            source="its weight beyond the displaced one holds it down: kT/(Mg - F)",
            fails_if="a disc that is heavier than the fluid it displaces and does not sink",
        )
    return Claim(
        claim=f"mean height of a free disc of mass {mass:g}",
        measured=Estimate.of(row, "free_height"),
        expected=row["free_expected"],
        required=2.0,
        source=f"Boltzmann's factor of its weight and the work of insertion, {THEORY}",
        fails_if="a disc that does not float where it displaces its own mass",
    )
