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
from gaspart.reproduction.families.shared.claims import (
    OTHER_MACHINE,
    SOURCE_A,
    SOURCE_C,
    exponent,
    rows,
)

YEAR = 365.25 * 86400.0
_OTHER_CAUSE = "something other than the pair tests takes the time"


def _all_pairs(what: str, excess: xr.DataArray) -> Claim:
    """Counted pair tests are N(N-1)/2."""
    return Claim(
        claim=f"{what}: largest relative difference of the pair tests from N(N-1)/2",
        kind="identity",
        measured=Estimate(excess),
        expected=0.0,
        required=1e-12,
        source="each pair once",
        fails_if="a pair is tested twice, or not at all",
    )


def naive_scaling(ds: xr.Dataset) -> list[Claim]:
    """Quadratic: exactly in pair tests, and in time as far as the caches permit."""
    return [
        _all_pairs("one box, every step", ds.tests_excess),
        exponent(
            "time per step in N, one box",
            ds,
            expected=2.0,
            half_width=0.15,
            source=f"{SOURCE_A}, figure 3",
            fails_if=_OTHER_CAUSE,
        ),
    ]


def box_count(ds: xr.Dataset) -> list[Claim]:
    """An optimum exists, the counts are those expected, and round widths are no faster."""
    relative = ds.seconds_error.values / ds.seconds.values
    seconds = [Estimate(t, t * e) for t, e in zip(ds.seconds.values, relative, strict=True)]
    least = min(seconds, key=lambda time: time.value)
    claims = []
    for name, at, bound in (("one box", 0, 10.0), ("the most boxes", -1, 1.5)):
        ratio = seconds[at] / least
        claims.append(
            Claim.at_least(
                claim=f"there is an optimum: time with {name} over the least",
                measured=ratio,
                bound=bound,
                required=0.25 * ratio.value,
                source=f"{SOURCE_A}, figure 4",
                fails_if="time rises or falls with the number of boxes throughout",
            )
        )
    # The minimum is flat: what matters is what the source's number costs, not where exactly the least is.
    number = Claim.at_most(
        claim=f"time with {float(ds.source_boxes_per_particle):g} boxes per particle over the least of all",
        kind="reproduction",
        measured=Estimate.of(ds, "source_penalty"),
        bound=1.05,
        required=0.05,
        source=f"{SOURCE_A}, figure 6 at this number of particles",
        why=OTHER_MACHINE,
        fails_if="the source's number is far from the flat minimum on this machine",
    )
    return [*claims, *_counts(ds), number, *_round_widths(ds), *remarks(ds), *_sectors(ds)]


def _counts(ds: xr.Dataset) -> list[Claim]:
    """Pair tests (where there is about one a particle) and box visits (everywhere) are those expected."""
    source = "uniform density, gaspart.theory.partition"
    one = ds.isel(scan=int(np.argmin(np.abs(ds.expected_tests.values - 1.0))))
    visits = (ds.box_visits / ds.expected_visits).values
    return [
        Claim(
            claim=f"pair tests per particle and step, {int(one.boxes_per_side)} boxes per side",
            measured=Estimate(one.pair_tests, one.tests_spread),
            expected=one.expected_tests,
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


def _round_widths(ds: xr.Dataset) -> list[Claim]:
    """The source's explanation of its plateaus, tested."""
    side = float(ds.container_side[0])
    return [
        Claim(
            claim=f"ln of time saved by boxes of width {side / float(power.round_per_side):g} for being a "
            "power of two",
            measured=Estimate.of(power, "advantage"),
            expected=0.0,
            required=0.02,
            source=f"arithmetic does not depend on it; {SOURCE_A}, section 3.4, states that it does",
            fails_if="boxes whose width is a power of two make a step faster",
        )
        for power in rows(ds, "power")
    ]


def _sectors(ds: xr.Dataset) -> list[Claim]:
    """What a sector costs the event-driven engine."""
    return [
        Claim.within(
            claim="neighbourhoods searched at a crossing",
            measured=Estimate.of(ds, "crossing_searches"),
            expected=1.0 / 3.0,
            half_width=0.05,
            source=f"{SOURCE_C}, section 4.4: of the nine adjacent sectors, three are new",
            fails_if="searches extend beyond the adjacent sectors, or miss some",
        ),
        exponent(
            "crossings per event in the number of planes between sectors",
            ds,
            "crossing_exponent",
            expected=1.0,
            half_width=0.05,
            source="free flight through uniform density",
            fails_if="missed or spurious crossings",
        ),
    ]


def linear_scaling(ds: xr.Dataset) -> list[Claim]:
    """Linear in counted work; in time, the source's three regimes; and its years of the naive method."""
    slowest = ds.isel(listed=int(np.nanargmax(ds.list_share.values)))
    ratio = Estimate.of(ds, "extrapolated_ratio") * 27.0
    return [
        exponent(
            "pair tests and box visits per step in N, cheapest partition",
            ds,
            "work_exponent",
            expected=1.0,
            half_width=0.05,
            source=f"{SOURCE_A}, section 1.2",
            fails_if="the work per particle depends on N",
        ),
        *(_regime(part, number) for number, part in enumerate(rows(ds, "part"), start=8)),
        Claim.at_most(
            claim="time with a neighbour list over the cheapest partition's, the worst of all gases",
            measured=Estimate.of(slowest, "list_share"),
            bound=0.5,
            required=0.1,
            source="most steps test the pairs of the list alone; boxes are filled and searched in every step",
            fails_if="a list costs more than it saves",
        ),
        Claim(
            claim="log10 of time, one box scanned 27 times over best partition, "
            f"N = {int(ds.extrapolated_count)}",
            kind="reproduction",
            measured=_log10(ratio),
            expected=math.log10(float(ds.source_years) * YEAR),
            required=0.1,
            source=f"{SOURCE_A}, section 3.4: {float(ds.source_years):g} years instead of a second",
            why="no count of the work of one step gives it: it is what about a thousand steps would take",
            fails_if="the source's years are not those of one step",
        ),
    ]


def _log10(ratio: Estimate) -> Estimate:
    """The decimal logarithm; not a number of a time that noise has made negative, as in a short run beside
    others."""
    if not ratio.value > 0.0:
        return Estimate(math.nan, math.nan)
    return Estimate(math.log10(ratio.value), ratio.error / ratio.value / math.log(10.0))


def _regime(part: xr.Dataset, number: int) -> Claim:
    """One of the source's figures 8 to 10: linear, but for the superlinear 9."""
    what = f"time per step in N, N = {int(part.part_low)} to {int(part.part_high)}"
    source = f"{SOURCE_A}, figure {number}"
    if number == 9:
        return Claim.at_least(
            claim=f"exponent of the {what}",
            kind="reproduction",
            measured=Estimate.of(part, "exponent"),
            bound=1.0,
            required=0.15,
            source=f"{source}: superlinear",
            why="caches of this machine are larger",
            fails_if="larger gases are no slower per particle",
        )
    return exponent(
        what,
        part,
        kind="reproduction",
        expected=1.0,
        half_width=0.1,
        source=f"{source}: linear",
        why="the same operations are more expensive in memory than in the caches",
        fails_if="the time per particle depends on N, as when caches overflow",
    )


def event_scaling(ds: xr.Dataset) -> list[Claim]:
    """How the cost of an event grows with N, by each search."""
    claims = [_all_pairs("all pairs, every event", ds.pairs_excess)]
    for method in rows(ds, "method"):
        search = str(method.method_search.values)
        power, section = {
            "pairs": (2.0, "4.2: all pairs"),
            "direct": (1.0, "4.3: a queue"),
            "boxes": (0.0, "4.4: sectors"),
        }[search]
        where = f'per event in N, search "{search}", {int(method.method_dimension)}D'
        common: dict[str, Any] = {"expected": power, "source": f"{SOURCE_C}, section {section}"}
        claims.append(
            exponent(
                f"pair tests {where}",
                method,
                "work_exponent",
                half_width=0.05,
                fails_if="the search tests more particles than it should",
                **common,
            )
        )
        if power > 0.0:
            claims.append(exponent(f"time {where}", method, half_width=0.2, fails_if=_OTHER_CAUSE, **common))
        else:
            claims.append(
                Claim.at_most(
                    claim=f"exponent of the time {where}",
                    measured=Estimate.of(method, "exponent"),
                    bound=0.4,
                    required=0.1,
                    source="constant work; caches",
                    fails_if="the queue's cost grows with N",
                )
            )
    return claims
