"""Claims about scaling.

Work is counted, so it is judged strictly. Times belong to a machine and a program: what the sources report
of theirs is a reproduction, in which disagreement is a result and not a fault.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import xarray as xr

from gaspart.reproduction.claims import Claim, Estimate
from gaspart.reproduction.families.scaling.ideal_boxes_claims import ideal_boxes as ideal_boxes
from gaspart.reproduction.families.scaling.remarks_claims import remarks
from gaspart.reproduction.families.shared.claims import OTHER_MACHINE, SOURCE_A, SOURCE_C
from gaspart.reproduction.table import Row, Table, each

YEAR = 365.25 * 86400.0
_OTHER_CAUSE = "something other than the pair tests takes the time"
_LAWS = {"pairs": (2.0, "4.2: all pairs"), "direct": (1.0, "4.3: a queue"), "boxes": (0.0, "4.4: sectors")}
"""Exponent of an event's cost in N, and the section of source C that states it, by search."""


def _all_pairs(subject: str, excess: float) -> Claim:
    """Return the claim that counted pair tests are N(N-1)/2."""
    return Claim(
        claim=f"{subject}: largest relative difference of the pair tests from N(N-1)/2",
        kind="identity",
        measured=Estimate(excess),
        expected=0.0,
        required=1e-12,
        source="each pair once",
        fails_if="a pair is tested twice, or not at all",
    )


def naive_scaling(ds: xr.Dataset) -> list[Claim]:
    """Return the claims on quadratic cost, exact in pair tests, approximate in time.

    Caches limit the agreement of the time.
    """
    gases = Table(ds, "count")
    return [
        _all_pairs("one box, every step", gases.tests_excess),
        Claim.within(
            claim="exponent of the time per step in N, one box",
            measured=gases.exponent,
            expected=2.0,
            half_width=0.15,
            source=f"{SOURCE_A}, figure 3",
            fails_if=_OTHER_CAUSE,
        ),
    ]


def box_count(ds: xr.Dataset) -> list[Claim]:
    """Return the claims that an optimum exists, counts are expected, and round widths no faster."""
    scan = Table(ds, "scan")
    least = scan.seconds[int(scan.seconds.value.argmin())]
    over = {"one box": (scan.seconds[0] / least, 10.0), "the most boxes": (scan.seconds[-1] / least, 1.5)}
    optimum = [
        Claim.at_least(
            claim=f"there is an optimum: time with {name} over the least",
            measured=ratio,
            bound=bound,
            required=0.25 * ratio.value,
            source=f"{SOURCE_A}, figure 4",
            fails_if="time rises or falls with the number of boxes throughout",
        )
        for name, (ratio, bound) in over.items()
    ]
    # The minimum is flat: what matters is what the source's number costs, not where exactly the least is.
    number = Claim.at_most(
        claim=f"time with {scan.source_boxes_per_particle:g} boxes per particle over the least of all",
        kind="reproduction",
        measured=scan.source_penalty,
        bound=1.05,
        required=0.05,
        source=f"{SOURCE_A}, figure 6 at this number of particles",
        source_error=OTHER_MACHINE,
        fails_if="the source's number is far from the flat minimum on this machine",
    )
    sectors = _sectors(scan.crossing_searches, scan.crossing_exponent)
    return [*optimum, *_counts(scan), number, *_round_widths(Table(ds, "power")), *remarks(ds), *sectors]


def _counts(scan: Table) -> list[Claim]:
    """Pair tests (where there is about one a particle) and box visits (everywhere) are those expected."""
    source = "uniform density, gaspart.theory.dsmc"
    nearest = scan[int(np.abs(scan.expected_tests - 1.0).argmin())]
    visits = scan.box_visits / scan.expected_visits
    return [
        Claim(
            claim=f"pair tests per particle and step, {nearest.boxes_per_side} boxes per side",
            measured=Estimate(nearest.pair_tests, nearest.tests_spread),
            expected=nearest.expected_tests,
            required=0.05,
            source=source,
            fails_if="pairs are missed or tested twice, or the gas is not uniform",
        ),
        Claim.within(
            claim="box visits per particle over those expected, the scan's largest deviation",
            measured=Estimate(visits[np.argmax(np.abs(visits - 1.0))], visits.std(ddof=1)),
            expected=1.0,
            half_width=0.02,
            source=source,
            fails_if="boxes are omitted or searched twice",
        ),
    ]


def _round_widths(powers: Table) -> list[Claim]:
    """Return the claims on the source's explanation of its plateaus, tested."""
    return each(
        powers.assign(width=powers.container_side[0] / powers.round_per_side),
        "ln of time saved by boxes of width {width:g} for being a power of two",
        measured=powers.advantage,
        expected=0.0,
        required=0.02,
        source=f"arithmetic does not depend on it; {SOURCE_A}, section 3.4, states that it does",
        fails_if="boxes whose width is a power of two make a step faster",
    )


def _sectors(searches: Estimate, exponent: Estimate) -> list[Claim]:
    """Return the claims on the costs of sectors in the event-driven engine."""
    return [
        Claim.within(
            claim="neighbourhoods searched at a crossing",
            measured=searches,
            expected=1.0 / 3.0,
            half_width=0.05,
            source=f"{SOURCE_C}, section 4.4: of the nine adjacent sectors, three are new",
            fails_if="searches extend beyond the adjacent sectors, or miss some",
        ),
        Claim.within(
            claim="exponent of the crossings per event in the number of planes between sectors",
            measured=exponent,
            expected=1.0,
            half_width=0.05,
            source="free flight through uniform density",
            fails_if="missed or spurious crossings",
        ),
    ]


def linear_scaling(ds: xr.Dataset) -> list[Claim]:
    """Return the claims on linear counted work, regimes of time, and years of the naive method.

    The source states three regimes.
    """
    parts, share = Table(ds, "part"), Table(ds, "listed").list_share
    return [
        Claim.within(
            claim="exponent of the pair tests and box visits per step in N, cheapest partition",
            measured=parts.work_exponent,
            expected=1.0,
            half_width=0.05,
            source=f"{SOURCE_A}, section 1.2",
            fails_if="the work per particle depends on N",
        ),
        *(_regime(part, number) for number, part in enumerate(parts, start=8)),
        Claim.at_most(
            claim="time with a neighbour list over the cheapest partition's, the worst of all gases",
            measured=share[int(np.nanargmax(share.value))],
            bound=0.5,
            required=0.1,
            source="most steps test the pairs of the list alone; boxes are filled and searched in every step",
            fails_if="a list costs more than it saves",
        ),
        Claim(
            claim="log10 of time, one box scanned 27 times over best partition, "
            f"N = {parts.extrapolated_count}",
            kind="reproduction",
            measured=_log10(27.0 * parts.extrapolated_ratio),
            expected=math.log10(parts.source_years * YEAR),
            required=0.1,
            source=f"{SOURCE_A}, section 3.4: {parts.source_years:g} years instead of a second",
            source_error="no count of the work of one step gives it: a thousand steps would take so long",
            fails_if="the source's years are not those of one step",
        ),
    ]


def _log10(ratio: Estimate) -> Estimate:
    """Compute the decimal logarithm; not a number for a negative time.

    Noise can make a time negative in a short run at the same time as others.
    """
    if not ratio.value > 0.0:
        return Estimate(math.nan, math.nan)
    return Estimate(math.log10(ratio.value), ratio.error / ratio.value / math.log(10.0))


def _regime(part: Row, number: int) -> Claim:
    """Return the claim on one of the source's figures 8 to 10.

    They are linear, but for the superlinear 9.
    """
    claim = f"exponent of the time per step in N, N = {part.part_low} to {part.part_high}"
    source = f"{SOURCE_A}, figure {number}"
    if number == 9:
        return Claim.at_least(
            claim=claim,
            kind="reproduction",
            measured=part.exponent,
            bound=1.0,
            required=0.15,
            source=f"{source}: superlinear",
            source_error="caches of this machine are larger",
            fails_if="larger gases are no slower per particle",
        )
    return Claim.within(
        claim=claim,
        kind="reproduction",
        measured=part.exponent,
        expected=1.0,
        half_width=0.1,
        source=f"{source}: linear",
        source_error="the same operations are more expensive in memory than in the caches",
        fails_if="the time per particle depends on N, as when caches overflow",
    )


def event_scaling(ds: xr.Dataset) -> list[Claim]:
    """Return the claims on the growth of the cost of an event, by search.

    The growth is with N.
    """
    methods = Table(ds, "method")
    claims = [_all_pairs("all pairs, every event", methods.pairs_excess)]
    for method in methods:
        power, section = _LAWS[method.method_search]
        where = f'per event in N, search "{method.method_search}", {method.method_dimension}D'
        law: dict[str, Any] = {"expected": power, "source": f"{SOURCE_C}, section {section}"}
        claims.append(
            Claim.within(
                claim=f"exponent of the pair tests {where}",
                measured=method.work_exponent,
                half_width=0.05,
                fails_if="the search tests more particles than it should",
                **law,
            )
        )
        claims.append(_event_time(where, method.exponent, law))
    return claims


def _event_time(where: str, exponent: Estimate, law: dict[str, Any]) -> Claim:
    """Return the claim on the exponent of the time; constant work may still take longer.

    The gas may be larger.
    """
    claim = f"exponent of the time {where}"
    if law["expected"] > 0.0:
        return Claim.within(claim=claim, measured=exponent, half_width=0.2, fails_if=_OTHER_CAUSE, **law)
    return Claim.at_most(
        claim=claim,
        measured=exponent,
        bound=0.4,
        required=0.1,
        source="constant work; caches",
        fails_if="the queue's cost grows with N",
    )
