"""What is claimed of the scenes that are drawn."""

from __future__ import annotations

import math

import xarray as xr

from gaspart import theory
from gaspart.claims import Claim


def gas_render(ds: xr.Dataset) -> list[Claim]:
    """All are there, as thin as the source says, put right by each step, with Maxwell's mean speed."""
    resolved = float(ds["resolved"])
    expected = 2.0 * resolved**2 / ds.attrs["count"]
    scatter = math.sqrt(max(expected, 1.0))
    temperature = float(ds["mean_square_speed"]) / 3.0
    return [
        _all_there(ds),
        Claim.within(
            "packing fraction of the spheres drawn",
            "reproduction",
            _drawn_fraction(ds),
            0.0,
            0.001,
            0.0005,
            "Frederickx and Meerts (2010): about 0.1 %",
            "another radius or container than the source's",
        ),
        Claim(
            "pairs that overlap at the end of a step",
            "test",
            ds["overlaps"],
            scatter,
            scatter,
            expected,
            f"next to none of the {resolved:.3g} found: a body in two contacts (at most, Poisson)",
            fails_if="overlaps that a step finds and does not put right",
        ),
        Claim(
            "mean speed",
            "test",
            ds["mean_speed"],
            ds["mean_speed_error"],
            0.02 * float(ds["mean_speed"]),
            float(theory.mean_speed(3, temperature)),
            "Maxwell at the temperature <v^2>/3",
            fails_if="speeds that are not Maxwell's",
        ),
    ]


def brownian_render(ds: xr.Dataset) -> list[Claim]:
    """All are there, and none overlaps another."""
    return [
        _all_there(ds),
        Claim(
            "pairs that overlap",
            "identity",
            ds["overlaps"],
            0.0,
            0.0,
            0.0,
            "hard spheres (exact)",
            fails_if="a body that has got into another",
        ),
        Claim(
            "packing fraction of the spheres drawn",
            "identity",
            _drawn_fraction(ds),
            1e-12,
            1e-9,
            ds.attrs["packing_fraction"],
            "the scene's",
            fails_if="a body that is not drawn, or not in its size",
        ),
    ]


def _all_there(ds: xr.Dataset) -> Claim:
    return Claim(
        "spheres drawn",
        "identity",
        ds.sizes["body"],
        0.0,
        0.0,
        ds.attrs["count"],
        "the scene's number of bodies",
        fails_if="a body that is lost",
    )


def _drawn_fraction(ds: xr.Dataset) -> float:
    volume = 4.0 / 3.0 * math.pi * float((ds["radius"] ** 3).sum())
    return volume / float(ds["length"].prod())
