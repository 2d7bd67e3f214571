"""Claims about random insertion and the densest packings."""

from __future__ import annotations

import numpy as np
import xarray as xr

from gaspart import theory
from gaspart.reproduction.claims import Claim, Estimate
from gaspart.reproduction.figure import PARTICLES
from gaspart.reproduction.table import Row, Table
from gaspart.theory.packing import insertion_saturation_uncertainty

NO_PROGRAM = "the wall excess was fitted to insertions by a program that is not in this repository"
SOURCE_FRACTION = 0.52
"""Packing fraction that source A's program reached (section 3.2), rounded to per cent.

180 spheres have 0.5226.
"""
SOURCE_ROUNDING = 0.01 / np.sqrt(12.0)
NAMES = {
    "periodic": "periodic",
    "wall": "entirely inside walls",
    "centres_to_walls": "with centres up to the walls",
}


def fill_failures(dataset: xr.Dataset) -> list[Claim]:
    """Return the claims on saturation, source A's 52 %, approach, and failures.

    The approach is the approach to saturation. Failures are claimed at low density.
    """
    return [claim for fill in Table(dataset, "container") for claim in _of_container(fill)]


def _of_container(fill: Row) -> list[Claim]:
    claims, saturates = [], np.isfinite(fill.saturation.value[0])
    if saturates:
        claims.append(_saturation(fill))
        if fill.rule == "centres_to_walls":
            claims.append(_source(fill))
    if np.isfinite(fill.approach.value):
        claims.append(_approach(fill))
    # In a fill that continues to saturation, the first few particles carry little information.
    if np.isfinite(fill.dilute_failures.value) and not saturates:
        claims.append(_dilute(fill))
    return claims


def _particles(fill: Row) -> str:
    return f"{PARTICLES[fill.dimension]} {NAMES[fill.rule]} (L/σ = {fill.side_over_diameter:.3g})"


def _saturation(fill: Row) -> Claim:
    container = fill.dimension, fill.side_over_diameter, fill.rule
    periodic = fill.rule == "periodic"
    wall = "" if periodic else ", times the wall excess (1 + 0.64 σ/L')^3 of saturated fills"
    return Claim(
        claim=f"saturation of random insertion, {_particles(fill)}, extrapolated in "
        f"attempts^(-1/{fill.dimension})",
        measured=fill.saturation[0],
        expected=Estimate(
            theory.insertion_saturation(*container), insertion_saturation_uncertainty(*container)
        ),
        required=1e-3 if periodic else 4e-3,
        source=f"[Zhang 2013]{wall}",
        allowance_source="its last digits" if periodic else "a fit to insertions, not in this repository",
        no_verdict="" if periodic else NO_PROGRAM,
        fails_if="free places are missed, overlaps are accepted, or the late window is not asymptotic",
    )


def _approach(fill: Row) -> Claim:
    return Claim.within(
        claim=f"exponent p of (saturation - packing fraction) ~ attempts^-p, {_particles(fill)}",
        measured=fill.approach,
        expected=1.0 / fill.dimension,
        half_width=0.15 / fill.dimension,
        source="[Feder 1980], [Swendsen 1981]: 1/d, once only single holes remain",
        fails_if="the window is too early, or attempts are counted wrongly",
    )


def _source(fill: Row) -> Claim:
    """Return the claim on source A's single fill, compared with many of our fills.

    If the number of attempts of the single fill was sufficient, this fill is a sample of the distribution of
    our fills.
    """
    return Claim(
        claim=f"packing fraction at which insertion ends, {_particles(fill)}, whole spheres counted: "
        "source A's 52 %",
        kind="reproduction",
        measured=fill.saturation[0],
        expected=Estimate(SOURCE_FRACTION, fill.final_spread) + Estimate(0.0, SOURCE_ROUNDING),
        required=4e-3,
        source="[source A], section 3.2: a single fill",
        allowance_source="the scatter of our fills, as that of its one fill, and its rounding to a percent",
        source_error="its centres go up to the walls, and its spheres are counted completely",
        fails_if="source A counted or placed its spheres by another rule",
    )


def _dilute(fill: Row) -> Claim:
    return Claim(
        claim=f"failed attempts up to packing fraction {fill.dilute_up_to:g} over those expected, "
        f"{_particles(fill)}",
        measured=fill.dilute_failures,
        expected=1.0,
        required=0.02,
        source="available fraction 1 - 2^d η + c η^2, exact to that order",
        fails_if="failures are counted wrongly, or overlaps with near neighbours are missed or spurious",
    )


def densest_fill(dataset: xr.Dataset) -> list[Claim]:
    """Return the claims on compressed and on inserted packings of spheres.

    Spheres that grow until they jam are denser than 0.60, with six contacts each. Insertion ends below
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
