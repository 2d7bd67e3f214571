"""Claims about buoyancy."""

from __future__ import annotations

import numpy as np
import xarray as xr

from gaspart.analysis.statistics import combine_estimates, fit_polynomial
from gaspart.reproduction.claims import Claim, Estimate
from gaspart.reproduction.table import Row, Table, each

THEORY = "scaled-particle theory ([Helfand 1961])"

AFLOAT, LYING = 3.0, 1.8
"""Expected distances from floor and ceiling, in the source's unit of length (a small disc has 1.6). A disc of
the source floats if its distance is above AFLOAT. It lies at the floor or ceiling below LYING. In between,
layers of small discs matter, for which there is no theory."""

_NEAREST = 4
"""Number of discs for the linear fit of the height against the density, around the middle of the container.
"""


def buoyancy(ds: xr.Dataset) -> list[Claim]:
    """Return the claims on Archimedes's principle, the displaced radius, and heights of discs.

    Heights are claimed for free discs, and for the discs of the source.
    """
    fixed, free, source = (Table.from_prefixed(ds, kind) for kind in ("fixed", "free", "source"))
    largest = Table(ds, "height").displaced.max()
    return [
        *_claims_on_fixed(fixed),
        *(_free(disc, largest) for disc in free),
        *(_source(source) if source else []),
    ]


def _claims_on_fixed(discs: Table) -> list[Claim]:
    """Return the claims on the force on fixed discs."""
    of_all = discs.force_radius.weights @ discs.radius_expected
    return [
        *each(
            discs,
            "radius displaced beyond the disc's own, in small radii, by the small discs missing, "
            "height {height:g}",
            measured=discs.count_radius,
            expected=discs.radius_expected,
            required=0.15,
            source=THEORY,
            alternative=_nearer(discs.radius_expected),
            fails_if="a fluid that does not accumulate at the disc's edge as theory states",
        ),
        Claim(
            claim="force on fixed discs over the weight of the small discs missing, all heights",
            measured=combine_estimates(discs.force / discs.missing),
            expected=1.0,
            required=0.04,
            source="Archimedes: F = m g dW/dmu, the slope of the work of insertion (exact far from floor and "
            "ceiling)",
            fails_if="a force that is not the weight of the displaced fluid",
        ),
        Claim(
            claim="radius displaced beyond the disc's own, in small radii, by the force, all heights",
            measured=combine_estimates(discs.force_radius),
            expected=of_all,
            required=0.1,
            source=THEORY,
            alternative=float(_nearer(of_all)),
            fails_if="R (0) or R + r (1) alone as the radius that counts in a dense fluid",
        ),
    ]


def _nearer(radius: float | np.ndarray) -> np.ndarray:
    """Return 0 or 1: the index of R or R + r, whichever is nearer."""
    return np.where(radius < 0.5, 0.0, 1.0)


def _free(disc: Row, largest: float) -> Claim:
    """Return the claim on the height of a free disc.

    A disc floats at the height where it displaces its own mass. If the displaced mass is smaller at all
    heights, the disc lies on the floor.
    """
    if disc.mass <= largest:
        return _floating(disc, "a free disc")
    return Claim.at_most(
        claim=f"mean height above the floor of a free disc of mass {disc.mass:g}, which displaces less",
        measured=disc.height - disc.lowest,
        bound=2.0,
        required=0.5,
        source="its weight beyond the displaced one holds it down: kT/(Mg - F)",
        fails_if="a disc that is heavier than the fluid it displaces and does not sink",
    )


def _floating(disc: Row, name: str) -> Claim:
    """Return the claim on the mean height of a floating disc."""
    return Claim(
        claim=f"mean height of {name} of mass {disc.mass:g}",
        measured=disc.height,
        expected=disc.expected,
        required=2.0,
        source=f"Boltzmann's factor of its weight less the displaced one's, {THEORY}",
        fails_if="a disc that does not float where it displaces its own mass",
    )


def _source(discs: Table) -> list[Claim]:
    """Return the claims on discs of many densities, as simulated by source C.

    The claims state which discs float, their heights, and the density of a disc that floats in the middle.
    """
    near = np.minimum(discs.expected - discs.lowest, discs.highest - discs.expected)
    middle = 0.5 * (discs.lowest[0] + discs.highest[0])
    afloat, lying = discs[near > AFLOAT], discs[near < LYING]
    is_heavy = lying.expected < middle
    heavy, light = lying[is_heavy], lying[~is_heavy]
    claims = [_floating(disc, "the source's disc") for disc in afloat]
    if heavy:
        claims.append(_lying(heavy.height - heavy.lowest, "heavier discs above the floor"))
    if light:
        claims.append(_lying(light.highest - light.height, "lighter discs below the ceiling"))
    if len(afloat) >= _NEAREST:
        claims.append(_neutral(afloat, middle))
    return claims


def _lying(distance: Estimate, which: str) -> Claim:
    """Return the claim on the disc farthest from floor or ceiling, among discs that lie there."""
    farthest = distance[np.argmax(distance.value)]
    return Claim.at_most(
        claim=f"largest mean distance of {len(distance)} of the source's {which}",
        measured=Estimate(farthest.value, farthest.error),
        bound=AFLOAT,
        required=0.5,
        source="held there by the weight less the displaced one (kT/|Mg - F|), or by a layer of discs",
        fails_if="discs that displace less (more) than their mass at all heights, and float",
    )


def _neutral(discs: Table, middle: float) -> Claim:
    """Return the claim on the density at which a disc floats in the middle.

    This density follows from a linear fit to the heights near the middle.
    """
    near = discs[np.argsort(abs(discs.height.value - middle))[:_NEAREST]]
    density, height = near.density, near.height - middle
    offset, slope = fit_polynomial(density, height).values
    neutral = -offset / slope
    # The line is fitted again around that density, where the error of the height matters.
    there = fit_polynomial(density - neutral, height).estimate(0)
    return Claim(
        claim="density at which a disc floats in the middle over the source's estimate",
        kind="reproduction",
        measured=(-there / slope + neutral) / discs.source_density,
        expected=1.0,
        required=0.02,
        source="notebook of [source C]'s code (tms-ninja/billiards), buoyancy: mean density of small discs",
        source_error="a disc displaces the fluid of a larger radius than its own, as the claims above state",
        fails_if="a disc that displaces exactly its own area of the fluid",
    )
