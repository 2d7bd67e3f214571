"""Claims about the price of features: absent ones cost nothing, present ones not much."""

from __future__ import annotations

import xarray as xr

from gaspart.reproduction.claims import Claim, Estimate
from gaspart.reproduction.table import Table, each

LARGEST_RATIO = 1.25
"""Largest time with a feature divided by the time without: 0.8 of the speed."""
_REORDERED = 1e-3  # of all instructions: what the compiler may order otherwise


def price_of_features(ds: xr.Dataset) -> list[Claim]:
    """Return the claims on kernels without and with features.

    Kernels without a feature are equal to those whose source never had it; with a feature they are not much
    slower.
    """
    kernels, timed = Table(ds, "kernel"), Table(ds, "point")
    plain, present = timed[timed.feature == "plain"], timed[timed.feature != "plain"]
    return [
        *(_absent(kernels) if kernels else []),
        *each(
            plain,
            "time per event of the plain scene over that of itself beside it, {engine} engine",
            measured=plain.ratio,
            expected=1.0,
            required=0.05,
            source="the same work, timed in turn",
            fails_if="what disturbs the machine favours one of two scenes, or the uncertainty is too small",
        ),
        *each(
            present,
            "time per event with {feature} over that without, {engine} engine",
            Claim.at_most,
            measured=present.ratio,
            bound=LARGEST_RATIO,
            required=0.1,
            source="at least 0.8 of the speed without (this project's aim)",
            fails_if="a feature slows the engine down",
        ),
    ]


def _absent(kernels: Table) -> list[Claim]:
    return each(
        kernels,
        "absent features: instructions of the {kernel} engine's kernel over those of one whose source never "
        "had them",
        Claim.within,
        measured=Estimate(kernels.instructions / kernels.stripped),
        expected=1.0,
        half_width=_REORDERED,
        source="branches on None vanish when a kernel is compiled (counted)",
        fails_if="an absent feature leaves code behind",
    )
