"""What is claimed of a large body in a gas."""

from __future__ import annotations

import xarray as xr

from gaspart.claims import Claim

LANGEVIN = "the Langevin equation with the friction of a dilute gas (Chapman and Cowling)"
EQUAL_SPEEDS = 0.1
"""How far energy, friction and diffusion in the source's gas, of equal speeds, may lie from those in
Maxwell's, for which theory holds: at the same temperature its mean speed is 8.5 % higher."""
MOMENTUM_SHARE = 0.2
"""Relative uncertainty of the effect of a finite gas: that recoil is shared by all of it at once."""


def _name(row: xr.Dataset) -> str:
    """Which body a row is of."""
    gas = ", gas of equal speeds" if str(row["experiment"].values) == "brownian_source" else ""
    return f"mass {float(row['mass'] / row['gas_mass']):g} times a gas body's{gas}"


def _is_source(row: xr.Dataset) -> bool:
    return str(row["experiment"].values) == "brownian_source"


def brownian_paths(ds: xr.Dataset) -> list[Claim]:
    """How far the bodies have come in the end."""
    claims = []
    for index in range(ds.sizes["point"]):
        row = ds.isel(point=index)
        replicas, freedom = int(row["replicas"]), int(row["end_freedom"])
        claims.append(
            Claim.chi_square(
                f"ends of {replicas} paths over their variance from rest, {_name(row)}",
                "reproduction" if _is_source(row) else "test",
                float(row["end_chi_square"]),
                freedom,
                LANGEVIN,
                "paths that spread too far or too little, or are cut off by the walls",
            )
        )
    return claims


def brownian_msd(ds: xr.Dataset) -> list[Claim]:
    """Equipartition, friction and diffusion of every point, and the mean free path that theory asks for."""
    claims = []
    for index in range(ds.sizes["point"]):
        row = ds.isel(point=index)
        name, share = _name(row), MOMENTUM_SHARE * float(row["share"])
        source = _is_source(row)
        for text, key, expected, required, theory_error, fails_if in (
            ("equipartition M<V^2>/3kT", "equipartition", 1.0, 0.03, share, "the body is not in equilibrium"),
            (
                "friction rate",
                "measured_friction",
                float(row["friction"]),
                0.03,
                share,
                "a wrong momentum exchange",
            ),
            (
                "diffusion coefficient",
                "measured_diffusion",
                float(row["diffusion"]),
                0.05,
                2.0 * share,
                "memory",
            ),
        ):
            claims.append(
                Claim(
                    f"{text}, {name}",
                    "reproduction" if source else "test",
                    row[key],
                    row[f"{key}_error"],
                    required * expected,
                    expected,
                    LANGEVIN,
                    expected_uncertainty=expected * (EQUAL_SPEEDS if source else theory_error),
                    fails_if=fails_if,
                )
            )
        claims.append(
            Claim.at_least(
                f"mean free path over the body's radius, {name}",
                "identity",
                row["mean_free_path"] / row["radius"],
                0.0,
                1.0,
                10.0,
                "the friction is that of a gas whose bodies do not meet each other beside the large one",
                "a gas so dense that its own flow around the body matters",
            )
        )
    return claims
