"""Claims about scaling with the number of particles and boxes.

Counted operations are compared strictly. Times depend on machine and program. Therefore a time that a source
reports is a reproduction; disagreement is a result, not a fault.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import xarray as xr

from gaspart.analysis.statistics import mean_of
from gaspart.reproduction.claims import Claim, Estimate
from gaspart.reproduction.families.shared import OTHER_MACHINE, SOURCE_A, SOURCE_C
from gaspart.reproduction.table import Row, Table, each

# Claims about source A's remarks on the cost of a step.


def remarks(ds: xr.Dataset) -> list[Claim]:
    """Return the claims on source A's remarks on the cost of a step.

    The claims concern counted operations and time.
    """
    near = Table(ds, "near")
    visits = near.near_box_visits / near.near_expected_visits
    return [
        Claim.within(
            claim="boxes searched within reach over those expected, the scan's largest deviation",
            measured=Estimate(visits[np.abs(visits - 1.0).argmax()], visits.std(ddof=1)),
            expected=1.0,
            half_width=0.03,
            source="Steiner's formula, gaspart.theory.partition, without the walls' 1 %",
            fails_if="boxes within reach are left out, or others are searched",
        ),
        Claim(
            claim="largest difference of the contacts found with and without the boxes out of reach",
            kind="identity",
            measured=Estimate(near.near_missed),
            expected=0.0,
            required=0.0,
            source="a box farther than a contact holds no partner",
            fails_if="a contact is missed",
        ),
        Claim.at_most(
            claim="least time with only the boxes within reach over the least with all neighbouring ones",
            kind="reproduction",
            measured=near.near_least,
            bound=1.0,
            required=0.1,
            source=f"{SOURCE_A}, section 2.3: to search fewer boxes is a possible improvement",
            source_error="a test of the distance to a box costs more than a look into it: most are empty",
            fails_if="leaving out boxes costs more than looking into them",
        ),
        Claim.at_most(
            claim="share of searches that can end in the own box if it is searched first, widest boxes",
            measured=near.own_first,
            bound=0.01,
            required=0.001,
            source="a search ends early only at a contact, which few particles have in a step",
            fails_if="the order of the boxes matters for the cost",
        ),
        Claim.within(
            claim="pairs tested more per particle and step with one huge sphere",
            measured=near.huge_tests,
            expected=1.0,
            half_width=0.01,
            source=f"{SOURCE_A}, section 4.2: each particle is tested against it",
            fails_if="it is kept in the boxes, which would have to be as wide as it is",
        ),
        Claim.at_most(
            claim="time per step with one huge sphere among 10 000 over that without",
            kind="reproduction",
            measured=near.huge_ratio,
            bound=1.05,
            required=0.05,
            source=f"{SOURCE_A}, section 4.2: a negligible effect",
            source_error=OTHER_MACHINE,
            fails_if="a further test per particle costs more than a twentieth of a step",
        ),
    ]


# Claims about the ideal number of boxes.


_INTERVAL = 2.0 * 1.96  # a 95 % interval, in standard errors


def ideal_boxes(ds: xr.Dataset) -> list[Claim]:
    """Return the claims on the source's numbers of boxes per particle, and on their effect."""
    gases, sources = Table(ds, "gas"), Table(ds, "source")
    return [
        Claim.at_most(
            claim=f"time with {gases.rule:g} boxes per particle over the least, the worst of all gases",
            measured=gases.penalty[int(np.nanargmax(gases.penalty.value))],
            bound=1.25,
            required=0.1,
            source=f"{SOURCE_A}, section 3.5: ideal is roughly ten",
            fails_if="the source's rule is far from the minimum on this machine",
        ),
        Claim.within(
            claim="ln of the ideal number by counted work over that by time, mean of the gases",
            measured=_work_over_time(gases),
            expected=0.0,
            half_width=0.3,
            source="(3^d c_test / 2 c_box)^(1/2), gaspart.theory.partition",
            fails_if="something other than pair tests and boxes determines the optimum",
        ),
        *_exponents(Table(ds, "series")),
        *(
            claim
            for number, source in enumerate(sources, start=5)
            for claim in _source_numbers(source, f"{SOURCE_A}, figure {number}")
        ),
        *_plateaus(Table(ds, "plateau")),
    ]


def _work_over_time(gases: Table) -> Estimate:
    """Compute mean and scatter of ln(model / ideal), for gases whose minimum was found."""
    ratio = np.log(gases.model / gases.ideal)
    ratio = ratio[gases.ideal_interior.astype(bool) & np.isfinite(ratio)]
    if ratio.size < 2:
        return Estimate(math.nan, math.nan)
    mean = mean_of(ratio)
    return Estimate(mean.value, mean.error)


def _exponents(series: Table) -> list[Claim]:
    return each(
        series,
        "exponent of the ideal number of boxes in N, r = {series_radius:g}",
        Claim.within,
        kind="reproduction",
        measured=series.exponent,
        expected=1.0,
        half_width=0.4,
        source=f"{SOURCE_A}, figures 5 to 7: linear",
        source_error=OTHER_MACHINE,
        fails_if="the ideal number per particle depends on N, as when caches overflow",
    )


def _plateaus(plateaus: Table) -> list[Claim]:
    return each(
        plateaus,
        "time with {plateau_boxes} boxes over the least, the worst N from {plateau_low} to {plateau_high}, "
        "r = {plateau_radius:g}",
        Claim.at_most,
        kind="reproduction",
        measured=plateaus.plateau_penalty,
        bound=1.05,
        required=0.05,
        source=f"{SOURCE_A}, section 3.4: so many are ideal in all of this range",
        source_error=OTHER_MACHINE,
        fails_if="the ideal number follows N, or is another",
    )


def _source_numbers(source: Row, origin: str) -> list[Claim]:
    """Return the claims on the source's number for a gas: is it ideal, and its slowdown.

    If no minimum lies between the timed partitions, its interval is infinite, and the claim is inconclusive.
    """
    number, gas = source.source_number, f"N = {source.source_count}, r = {source.source_radius:g}"
    interval = source.source_ideal_high - source.source_ideal_low
    return [
        Claim(
            claim=f"ideal number of boxes per particle, {gas}",
            kind="reproduction",
            measured=Estimate(source.source_ideal, interval / _INTERVAL),
            expected=Estimate(number, 0.1 * number),
            required=0.3 * source.source_ideal,
            source=origin,
            allowance_source="read from the source's figure to 10 %",
            source_error=OTHER_MACHINE,
            fails_if="another machine or program has other relative costs of tests and boxes",
        ),
        Claim.at_most(
            claim=f"time with {number:g} boxes per particle over the least, {gas}",
            kind="reproduction",
            measured=source.source_penalty,
            bound=1.1,
            required=0.05,
            source=origin,
            source_error=OTHER_MACHINE,
            fails_if="the source's number is far from the minimum on this machine",
        ),
    ]


YEAR = 365.25 * 86400.0
_OTHER_CAUSE = "something other than the pair tests takes the time"
_LAWS = {"pairs": (2.0, "4.2: all pairs"), "direct": (1.0, "4.3: a queue"), "boxes": (0.0, "4.4: sectors")}
"""Exponent of an event's cost in N by search method, and the section of source C that states it."""


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
    """Return the claims on quadratic cost: exact for pair tests, approximate for time.

    Caches limit the agreement of times.
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
    # The minimum is flat: the cost at the source's number matters, not the exact position of the minimum.
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
    """Return the claims on expected numbers of pair tests and box visits.

    Pair tests are compared where there is about one box per particle, box visits everywhere.
    """
    source = "uniform density, gaspart.theory.partition"
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
    """Return the claims that test the source's explanation of its plateaus."""
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
    """Return the claims on the cost of sectors in the event-driven engine."""
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
    """Return the claims on linear work, regimes of time, and years of the naive method.

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
    """Compute the decimal logarithm; NaN for a negative time.

    Noise can make the time of a short run negative.
    """
    if not ratio.value > 0.0:
        return Estimate(math.nan, math.nan)
    return Estimate(math.log10(ratio.value), ratio.error / ratio.value / math.log(10.0))


def _regime(part: Row, number: int) -> Claim:
    """Return the claim on one of the source's figures 8 to 10.

    Figures 8 and 10 are linear; figure 9 is superlinear.
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
    """Return the claims on the cost of an event against N, by search method."""
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
    """Return the claim on the exponent of the time per event.

    In larger gases, constant work may take longer.
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
