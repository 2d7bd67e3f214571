"""What the figure of features claims: absent ones cost nothing, present ones not much."""

from __future__ import annotations

import xarray as xr

from gaspart.claims import Claim

DEAREST = 1.25
"""Time over that of the plain scene which a feature may take: 0.8 of its speed."""
_LEFT = 1e-3  # of all instructions: what the compiler may order otherwise


def price_of_features(ds: xr.Dataset) -> list[Claim]:
    """Kernels without a feature are those whose source never had it; with one they are not much slower."""
    claims = []
    if "kernel" in ds.dims:
        for name in ds["kernel"].values:
            one = ds.sel(kernel=name)
            what = f"absent features: instructions of the {name} engine's kernel over those of one"
            claims.append(
                Claim.within(
                    f"{what} whose source never had them",
                    "test",
                    float(one["instructions"] / one["stripped"]),
                    0.0,
                    1.0,
                    _LEFT,
                    "branches on None vanish when a kernel is compiled (counted)",
                    "an absent feature leaves code behind",
                )
            )
    for n in range(ds.sizes["point"]):
        one = ds.isel(point=n)
        feature, engine = one["feature"].item(), one["engine"].item()
        if feature == "plain":
            continue
        claims.append(
            Claim.at_most(
                f"time per event with {feature} over that without, {engine} engine",
                "test",
                float(one["ratio"]),
                float(one["ratio_error"]),
                0.1,
                DEAREST,
                "at least 0.8 of the plain scene's speed (what this project wants)",
                "a feature slows the engine down",
            )
        )
    return claims
