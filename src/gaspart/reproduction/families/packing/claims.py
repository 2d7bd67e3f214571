"""Claims about the densest random packings."""

from __future__ import annotations

import xarray as xr

from gaspart import theory
from gaspart.reproduction.claims import Claim, Estimate
from gaspart.reproduction.table import Row, Table


def densest_fill(dataset: xr.Dataset) -> list[Claim]:
    """Return the claims on grown and inserted packings of spheres.

    Grown until they jam, spheres are denser than 0.60 and have six contacts each; inserted, they end below
    saturation.
    """
    claims = []
    for packing in Table(dataset, "packing"):
        claims += (
            _claims_on_jammed(packing) if packing.rule == "compressed" else [_claim_on_insertion(packing)]
        )
    return claims


def _packing_fraction(packing: Row) -> Estimate:
    return Estimate(packing.packing_fraction, packing.error, packing.freedom)


def _claims_on_jammed(packing: Row) -> list[Claim]:
    return [
        Claim.at_least(
            claim="packing fraction of spheres grown until they jam",
            measured=_packing_fraction(packing),
            bound=0.60,
            required=5e-3,
            source="[Lubachevsky 1990]: random packings end at 0.60 to 0.65",
            fails_if="contacts of growing spheres are wrong, or growth stops before they jam",
        ),
        Claim.within(
            claim="contacts per sphere that does not rattle, in a jammed packing",
            measured=Estimate(packing.contacts.value, packing.contacts.error, packing.freedom),
            expected=6.0,
            half_width=0.5,
            source="[Donev 2005]: isostatic, 2d contacts",
            no_verdict="how many contacts a growth of finite speed leaves open, and how many gaps count as "
            "contacts, is not known to less than the band",
            fails_if="growth is too fast to find all contacts, or spheres crystallise",
        ),
    ]


def _claim_on_insertion(packing: Row) -> Claim:
    side = packing.length[0] / (2.0 * packing.radius)
    saturation = theory.insertion_saturation(3, side, packing.rule)
    return Claim.at_most(
        claim=f"packing fraction of random insertion, {packing.rule.replace('_', ' ')} (L/σ = {side:.3g}), "
        "over saturation",
        measured=_packing_fraction(packing) / saturation,
        bound=1.0,
        required=0.02,
        source="[Zhang 2013], with the wall excess of fill_failures",
        fails_if="overlaps are accepted",
    )
