"""Claims about rendered scenes."""

from __future__ import annotations

import math

import xarray as xr

from gaspart import theory
from gaspart.reproduction.claims import Claim, Estimate
from gaspart.reproduction.table import Table
from gaspart.scene.limits import ball_volume


def gas_render(dataset: xr.Dataset) -> list[Claim]:
    """Return the claims on the gas: number, density, overlaps, and mean speed.

    All particles are present. The density is as low as the source states. There are no overlaps after a step.
    The mean speed is Maxwell's.
    """
    spheres = Table(dataset, "particle")
    expected = 2.0 * spheres.resolved**2 / spheres.count
    scatter = math.sqrt(max(expected, 1.0))
    return [
        _number(spheres),
        Claim.within(
            claim="packing fraction of the spheres drawn",
            kind="reproduction",
            measured=Estimate(_drawn_fraction(spheres)),
            expected=0.001,
            half_width=0.0005,
            source="[source A]: about 0.1 %",
            fails_if="another radius or container than the source's",
        ),
        Claim(
            claim="pairs that overlap at the end of a step",
            measured=Estimate(spheres.overlaps, scatter),
            expected=expected,
            required=scatter,
            source=f"almost none of the {spheres.resolved:.3g} found: a particle in two contacts (at most, "
            "Poisson)",
            fails_if="overlaps that a step finds and does not resolve",
        ),
        Claim(
            claim="mean speed",
            measured=spheres.mean_speed,
            expected=theory.mean_speed(3, spheres.mean_square_speed / 3.0),
            required=0.02 * spheres.mean_speed.value,
            source="Maxwell at the temperature <v^2>/3",
            fails_if="speeds that are not Maxwell's",
        ),
    ]


def brownian_render(dataset: xr.Dataset) -> list[Claim]:
    """Return the claims that all spheres are present, and that none overlap."""
    spheres = Table(dataset, "particle")
    return [
        _number(spheres),
        Claim(
            claim="pairs that overlap",
            kind="identity",
            measured=Estimate(spheres.overlaps),
            expected=0.0,
            required=0.0,
            source="hard spheres (exact)",
            fails_if="a particle that has entered another",
        ),
        Claim(
            claim="packing fraction of the spheres drawn",
            kind="identity",
            measured=Estimate(_drawn_fraction(spheres), 1e-12),
            expected=spheres.packing_fraction,
            required=1e-9,
            source="the scene's",
            fails_if="a particle that is not drawn, or not in its size",
        ),
    ]


def _number(spheres: Table) -> Claim:
    return Claim(
        claim="spheres drawn",
        kind="identity",
        measured=Estimate(len(spheres)),
        expected=spheres.count,
        required=0.0,
        source="the scene's number of particles",
        fails_if="a particle that is lost",
    )


def _drawn_fraction(spheres: Table) -> float:
    return float(ball_volume(3) * (spheres.radius**3).sum() / spheres.length.prod())
