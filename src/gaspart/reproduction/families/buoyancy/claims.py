"""Claims about buoyancy."""

from __future__ import annotations

import numpy as np
import xarray as xr

from gaspart.analysis.statistics import combine_estimates, fit_polynomial
from gaspart.reproduction.claims import Claim, Estimate
from gaspart.reproduction.families.shared.claims import combined, freedoms, rows

THEORY = "scaled-particle theory ([Helfand 1961])"

AFLOAT, LYING = 3.0, 1.8
"""Expected distances from floor and ceiling, in the source's lengths (a small disc is 1.6), above which its
discs float and below which they lie there; between them layers of small discs count, unknown to theory."""

_NEAREST = 4
"""Discs through whose heights the line is drawn that gives the density of one in the middle."""


def buoyancy(ds: xr.Dataset) -> list[Claim]:
    """Archimedes's principle; the displaced radius; the heights of free discs, and of the source's."""
    free = [_free(row, float(ds["displaced"].max())) for row in rows(ds, "free")]
    return [*_fixed(ds), *free, *(_source(ds) if "source" in ds.sizes else [])]


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
    ratios = [
        Estimate.of(row, "fixed_force") / Estimate.of(row, "fixed_missing") for row in rows(ds, "fixed")
    ]
    weights = 1.0 / ds["fixed_force_radius_error"].values ** 2
    expected = np.average(ds["fixed_radius_expected"].values, weights=weights)
    return [
        *claims,
        Claim(
            claim="force on fixed discs over the weight of the small discs missing, all heights",
            measured=combine_estimates(ratios),
            expected=1.0,
            required=0.04,
            source="Archimedes: F = m g dW/dmu, the slope of the work of insertion (exact far from floor and "
            "ceiling)",
            fails_if="a force that is not the weight of the displaced fluid",
        ),
        Claim(
            claim="radius displaced beyond the disc's own, in small radii, by the force, all heights",
            measured=combined(ds, "fixed_force_radius"),
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
    return _floating(row, "free", "a free disc")


def _floating(row: xr.Dataset, kind: str, disc: str) -> Claim:
    """The mean height of one disc that floats, "free" or of the "source"."""
    return Claim(
        claim=f"mean height of {disc} of mass {float(row[f'{kind}_mass']):g}",
        measured=Estimate.of(row, f"{kind}_height"),
        expected=row[f"{kind}_expected"],
        required=2.0,
        source=f"Boltzmann's factor of its weight less the displaced one's, {THEORY}",
        fails_if="a disc that does not float where it displaces its own mass",
    )


def _source(ds: xr.Dataset) -> list[Claim]:
    """Source C's discs of many densities: which float, where, and which one in the middle."""
    expected, lowest, highest = (ds[f"source_{name}"].values for name in ("expected", "lowest", "highest"))
    near = np.minimum(expected - lowest, highest - expected)
    afloat, is_lying = near > AFLOAT, near < LYING
    middle = 0.5 * float(lowest[0] + highest[0])
    claims = [_floating(row, "source", "the source's disc") for row in rows(ds.isel(source=afloat), "source")]
    lying = ds.isel(source=is_lying)
    is_heavy = (lying["source_expected"] < middle).values
    heavy, light = lying.isel(source=is_heavy), lying.isel(source=~is_heavy)
    if heavy.sizes["source"]:
        distance = heavy["source_height"] - heavy["source_lowest"]
        claims.append(_lying(heavy, distance, "heavier discs above the floor"))
    if light.sizes["source"]:
        distance = light["source_highest"] - light["source_height"]
        claims.append(_lying(light, distance, "lighter discs below the ceiling"))
    if afloat.sum() >= _NEAREST:
        claims.append(_neutral(ds.isel(source=afloat), middle))
    return claims


def _lying(ds: xr.Dataset, distance: xr.DataArray, which: str) -> Claim:
    """Discs that are held at floor or ceiling: the one that is farthest from it."""
    worst = int(np.argmax(distance.values))
    return Claim.at_most(
        claim=f"largest mean distance of {ds.sizes['source']} of the source's {which}",
        measured=Estimate(distance[worst], ds["source_height_error"][worst]),
        bound=AFLOAT,
        required=0.5,
        source="held there by the weight less the displaced one (kT/|Mg - F|), or by a layer of discs",
        fails_if="discs that displace less (more) than their mass at all heights, and float",
    )


def _neutral(ds: xr.Dataset, middle: float) -> Claim:
    """The density at which a disc floats in the middle, from a line through the heights about it."""
    distance = np.abs(ds["source_height"].values - middle)
    near = ds.isel(source=np.argsort(distance)[:_NEAREST])
    density, height = near["source_density"].values, near["source_height"].values - middle
    errors, few = near["source_height_error"].values, freedoms(near, "source_height")
    offset, slope = fit_polynomial(density, height, errors).values
    neutral = -offset / slope
    # The line is fitted again about that density, where the error of its height is the one that counts.
    there = fit_polynomial(density - neutral, height, errors, freedoms=few).estimate(0)
    return Claim(
        claim="density at which a disc floats in the middle over the source's estimate",
        kind="reproduction",
        measured=(-there / slope + neutral) / ds.attrs["source_density"],
        expected=1.0,
        required=0.02,
        source="notebook of [source C]'s code (tms-ninja/billiards), buoyancy: mean density of small discs",
        why="a disc displaces the fluid of a larger radius than its own, as the claims above state",
        fails_if="a disc that displaces exactly its own area of the fluid",
    )
