"""Claims about the price of features: absent ones cost nothing, present ones not much."""

from __future__ import annotations

import xarray as xr

from gaspart.reproduction.claims import Claim, Estimate
from gaspart.reproduction.families.shared.claims import rows

LARGEST_RATIO = 1.25
"""Largest time with a feature over that without: 0.8 of the speed."""
_REORDERED = 1e-3  # of all instructions: what the compiler may order otherwise


def price_of_features(ds: xr.Dataset) -> list[Claim]:
    """Kernels without a feature are those whose source never had it; with one they are not much slower."""
    absent = [
        Claim.within(
            claim=f"absent features: instructions of the {one['kernel'].item()} engine's kernel over those "
            "of one whose source never had them",
            measured=Estimate(one["instructions"] / one["stripped"]),
            expected=1.0,
            half_width=_REORDERED,
            source="branches on None vanish when a kernel is compiled (counted)",
            fails_if="an absent feature leaves code behind",
        )
        for one in rows(ds, "kernel")
    ]
    present = [
        Claim.at_most(
            claim=f"time per event with {one['feature'].item()} over that without, "
            f"{one['engine'].item()} engine",
            measured=Estimate.of(one, "ratio"),
            bound=LARGEST_RATIO,
            required=0.1,
            source="at least 0.8 of the speed without (this project's aim)",
            fails_if="a feature slows the engine down",
        )
        for one in rows(ds, "point")
        if one["feature"].item() != "plain"
    ]
    null = [
        Claim(
            claim="time per event of the plain scene over that of itself beside it, "
            f"{one['engine'].item()} engine",
            measured=Estimate.of(one, "ratio"),
            expected=1.0,
            required=0.05,
            source="the same work, timed in turn",
            fails_if="what disturbs the machine favours one of two scenes, or the uncertainty is too small",
        )
        for one in rows(ds, "point")
        if one["feature"].item() == "plain"
    ]
    return absent + null + present
