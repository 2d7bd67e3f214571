"""What the densest random packings claim."""

from __future__ import annotations

import xarray as xr

from gaspart import theory
from gaspart.claims import Claim


def densest_fill(dataset: xr.Dataset) -> list[Claim]:
    """Grown until they jam, spheres are denser than 0.60 and held by six contacts each; inserted, they end
    below saturation."""
    claims = []
    for k in range(dataset.sizes["packing"]):
        one = dataset.isel(packing=k)
        claims += _compressed(one) if str(one["rule"].values) == "compressed" else [_inserted(one)]
    return claims


def _compressed(one: xr.Dataset) -> list[Claim]:
    return [
        Claim.at_least(
            "packing fraction of spheres grown until they jam",
            "test",
            float(one["packing_fraction"]),
            float(one["error"]),
            5e-3,
            0.60,
            "Lubachevsky and Stillinger 1990: random packings end at 0.60 to 0.65",
            "contacts of growing spheres are wrong, or growth stops before they jam",
        ),
        Claim.within(
            "contacts per sphere that does not rattle, in a jammed packing",
            "test",
            float(one["contacts"]),
            float(one["contacts_error"]),
            6.0,
            0.5,
            "Donev, Torquato and Stillinger, Phys. Rev. E 71, 011105 (2005): isostatic, 2d contacts",
            "growth is too fast to find all contacts, or spheres crystallise",
        ),
    ]


def _inserted(one: xr.Dataset) -> Claim:
    rule, side = str(one["rule"].values), float(one["length"][0]) / (2.0 * float(one["radius"]))
    return Claim.at_most(
        f"packing fraction of random insertion, {rule.replace('_', ' ')} (L/σ = {side:.3g}), over saturation",
        "test",
        float(one["packing_fraction"]) / theory.insertion_saturation(3, side, rule),
        float(one["error"]) / theory.insertion_saturation(3, side, rule),
        0.02,
        1.0,
        "Zhang and Torquato 2013, with the wall excess of fill_failures",
        "overlaps are accepted",
    )
