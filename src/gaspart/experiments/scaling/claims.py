"""What the scaling figures claim. Source A: Frederickx and Meerts 2010; C: Spencer 2022.

Work is counted, so it is judged strictly. Times belong to a machine and a program: what the sources report
of theirs is a reproduction, in which disagreement is a result and not a fault.
"""

import math

import numpy as np
import xarray as xr

from gaspart.claims import Claim

A = "Frederickx & Meerts 2010"
C = "Spencer 2022"
YEAR = 365.25 * 86400.0
_INTERVAL = 2.0 * 1.96  # a 95 % interval in standard errors
_OTHER_MACHINE = "another machine or program weighs tests and boxes differently"


def _exponent(
    kind: str,
    what: str,
    ds: xr.Dataset,
    name: str,
    expected: float,
    half_width: float,
    source: str,
    fails_if: str,
) -> Claim:
    """The exponent ``name`` of a dataset lies in a band."""
    value, error = float(ds[name]), float(ds[f"{name}_error"])
    what = f"exponent of the {what}"
    return Claim.within(what, kind, value, error, expected, half_width, source, fails_if)


def _all_pairs(what: str, excess: float) -> Claim:
    """Counted pair tests are N(N-1)/2."""
    claim = f"{what}: largest relative difference of the pair tests from N(N-1)/2"
    fails_if = "a pair is tested twice, or not at all"
    return Claim(claim, "identity", excess, 0.0, 1e-12, 0.0, "each pair once", fails_if=fails_if)


def naive_scaling(ds: xr.Dataset) -> list[Claim]:
    """Quadratic: exactly in pair tests, and in time as far as the caches let it be."""
    fails_if = "something else than the pair tests takes the time"
    return [
        _all_pairs("one box, every step", ds.tests_excess),
        _exponent(
            "test", "time per step in N, one box", ds, "exponent", 2.0, 0.15, f"{A}, figure 3", fails_if
        ),
    ]


def box_count(ds: xr.Dataset) -> list[Claim]:
    """An optimum exists, the counts are those expected, and round widths are no quicker."""
    seconds = ds.seconds.values
    error = ds.seconds_error.values / seconds
    best = int(np.argmin(seconds))
    claims = []
    for name, at, bound in (("one box", 0, 10.0), ("the most boxes", -1, 1.5)):
        ratio = seconds[at] / seconds[best]
        spread = ratio * math.hypot(error[at], error[best])
        what = f"there is an optimum: time with {name} over the least"
        fails_if = "time rises or falls with the number of boxes throughout"
        claims.append(
            Claim.at_least(what, "test", ratio, spread, 0.25 * ratio, bound, f"{A}, figure 4", fails_if)
        )
    return claims + _counts(ds) + [_ideal_number(ds)] + _round_widths(ds) + _sectors(ds)


def _counts(ds: xr.Dataset) -> list[Claim]:
    """Pair tests (where there is about one a body) and box visits (everywhere) are those expected."""
    source = "uniform density, gaspart.theory.partition"
    one = ds.isel(scan=int(np.argmin(np.abs(ds.expected_tests.values - 1.0))))
    visits = (ds.box_visits / ds.expected_visits).values
    farthest = visits[np.argmax(np.abs(visits - 1.0))]
    return [
        Claim(
            f"pair tests per body and step, {int(one.boxes_per_side)} boxes per side",
            "test",
            one.pair_tests,
            one.tests_spread,
            0.05,
            one.expected_tests,
            source,
            fails_if="pairs are overlooked or tested twice, or the gas is not uniform",
        ),
        Claim.within(
            "box visits per body over those expected, the scan's farthest",
            "test",
            farthest,
            visits.std(ddof=1),
            1.0,
            0.02,
            source,
            "boxes are left out or looked into twice",
        ),
    ]


def _ideal_number(ds: xr.Dataset) -> Claim:
    """The source's figure 6 at this number of bodies."""
    return Claim(
        f"ideal number of boxes per body, N = {int(ds['count'])}, r = {float(ds.radius):g}",
        "reproduction",
        ds.ideal,
        (ds.ideal_high - ds.ideal_low) / _INTERVAL,
        0.3 * ds.ideal,
        ds.source_boxes_per_body,
        f"{A}, figure 6",
        expected_uncertainty=0.1 * float(ds.source_boxes_per_body),
        fails_if=_OTHER_MACHINE,
    )


def _round_widths(ds: xr.Dataset) -> list[Claim]:
    """The source's explanation of its plateaus, tested."""
    widths = float(ds.container_side[0]) / ds.round_per_side.values
    return [
        Claim(
            f"ln of time saved by boxes of width {width:g} for being a power of two",
            "test",
            advantage,
            spread,
            0.02,
            0.0,
            f"arithmetic does not care; {A}, section 3.4, holds that it does",
            fails_if="boxes whose width is a power of two make a step quicker",
        )
        for width, advantage, spread in zip(
            widths, ds.advantage.values, ds.advantage_error.values, strict=True
        )
    ]


def _sectors(ds: xr.Dataset) -> list[Claim]:
    """What a sector costs the event-driven engine."""
    value, error = float(ds.crossing_searches), float(ds.crossing_searches_error)
    source = f"{C}, section 4.4: of the nine adjacent sectors, three are new"
    fails_if = "searches look farther than the adjacent sectors, or overlook some"
    what = "crossings per event in the number of planes between sectors"
    theory, lost = "free flight through uniform density", "crossings are lost or made up"
    return [
        Claim.within(
            "neighbourhoods searched at a crossing", "test", value, error, 1.0 / 3.0, 0.05, source, fails_if
        ),
        _exponent("test", what, ds, "crossing_exponent", 1.0, 0.05, theory, lost),
    ]


def ideal_boxes(ds: xr.Dataset) -> list[Claim]:
    """The source's numbers of boxes per particle, and how much they matter."""
    worst = ds.isel(gas=int(np.nanargmax(ds.penalty.values)))
    ratio = np.log(ds.model / ds.ideal).values
    ratio = ratio[ds.ideal_interior.values.astype(bool) & np.isfinite(ratio)]
    enough = ratio.size > 1
    claims = [
        Claim.at_most(
            f"time with {float(ds.rule):g} boxes per body over the least, the worst of all gases",
            "test",
            float(worst.penalty),
            float(worst.penalty_error),
            0.1,
            1.25,
            f"{A}, section 3.5: ideal is roughly ten",
            "the source's rule is far from the minimum on this machine",
        ),
        Claim.within(
            "ln of the ideal number by counted work over that by time, mean of the gases",
            "test",
            ratio.mean() if enough else math.nan,
            ratio.std(ddof=1) / math.sqrt(ratio.size) if enough else math.nan,
            0.0,
            0.3,
            "(3^d c_test / 2 c_box)^(1/2), gaspart.theory.partition",
            "something else than pair tests and boxes decides the optimum",
        ),
    ]
    source, fails_if = (
        f"{A}, figures 5 to 7: linear",
        "the ideal number per body depends on N, as when caches overflow",
    )
    for n in range(ds.sizes["series"]):
        series = ds.isel(series=n)
        what = f"ideal number of boxes in N, r = {float(series.series_radius):g}"
        claims.append(_exponent("reproduction", what, series, "exponent", 1.0, 0.4, source, fails_if))
    for n in range(ds.sizes["source"]):
        claims += _source_numbers(ds.isel(source=n), f"{A}, figure {5 + n}")
    return claims


def _source_numbers(source: xr.Dataset, origin: str) -> list[Claim]:
    """The source's number for one gas: is it the ideal one, and if not, how much slower?

    If no minimum lies between the partitions timed, its interval is infinite and the claim inconclusive."""
    number, ideal = float(source.source_number), float(source.source_ideal)
    name = f"N = {int(source.source_count)}, r = {float(source.source_radius):g}"
    return [
        Claim(
            f"ideal number of boxes per body, {name}",
            "reproduction",
            ideal,
            float(source.source_ideal_high - source.source_ideal_low) / _INTERVAL,
            0.3 * ideal,
            number,
            origin,
            expected_uncertainty=0.1 * number,
            fails_if=_OTHER_MACHINE,
        ),
        Claim.at_most(
            f"time with {number:g} boxes per body over the least, {name}",
            "reproduction",
            float(source.source_penalty),
            float(source.source_penalty_error),
            0.05,
            1.1,
            origin,
            "the source's number is far from the minimum on this machine",
        ),
    ]


def linear_scaling(ds: xr.Dataset) -> list[Claim]:
    """Linear in counted work; in time, the source's three regimes; and its years of the naive method."""
    what, source = "pair tests and box visits per step in N, cheapest partition", f"{A}, section 1.2"
    claims = [
        _exponent("test", what, ds, "work_exponent", 1.0, 0.05, source, "the work per body depends on N")
    ]
    for n in range(ds.sizes["part"]):
        part = ds.isel(part=n)
        what = f"time per step in N, N = {int(part.part_low)} to {int(part.part_high)}"
        source, slow = f"{A}, figure {8 + n}", "the time per body depends on N, as when caches overflow"
        if n == 1:
            value, error, source = float(part.exponent), float(part.exponent_error), f"{source}: superlinear"
            bound = (value, error, 0.15, 1.0, source, "larger gases are no slower per body")
            claims.append(Claim.at_least(f"exponent of the {what}", "reproduction", *bound))
        else:
            claims.append(
                _exponent("reproduction", what, part, "exponent", 1.0, 0.1, f"{source}: linear", slow)
            )
    slowest = ds.isel(listed=int(np.nanargmax(ds.list_share.values)))
    claims.append(
        Claim.at_most(
            "time with a neighbour list over the cheapest partition's, the worst of all gases",
            "test",
            float(slowest.list_share),
            float(slowest.list_share_error),
            0.1,
            0.5,
            "most steps test the pairs of the list alone; boxes are filled and looked into in every step",
            "a list costs more than it saves",
        )
    )
    ratio, error = 27.0 * float(ds.extrapolated_ratio), 27.0 * float(ds.extrapolated_ratio_error)
    claims.append(
        Claim(
            f"log10 of time, one box scanned 27 times over best partition, N = {int(ds.extrapolated_count)}",
            "reproduction",
            math.log10(ratio),
            error / ratio / math.log(10.0),
            0.1,
            math.log10(float(ds.source_years) * YEAR),
            f"{A}, section 3.4: {float(ds.source_years):g} years instead of a second",
            fails_if="the source's years are not those of one step",
        )
    )
    return claims


def event_scaling(ds: xr.Dataset) -> list[Claim]:
    """How the cost of an event grows with N, by each search."""
    claims = [_all_pairs("all pairs, every event", ds.pairs_excess)]
    expected = {
        "pairs": (2.0, "4.2: all pairs"),
        "direct": (1.0, "4.3: a queue"),
        "boxes": (0.0, "4.4: sectors"),
    }
    for n in range(ds.sizes["method"]):
        method = ds.isel(method=n)
        search = str(method.method_search.values)
        power, section = expected[search]
        source, where = (
            f"{C}, section {section}",
            f'per event in N, search "{search}", {int(method.method_dimension)}D',
        )
        more = "the search looks at more bodies than it should"
        claims.append(
            _exponent("test", f"pair tests {where}", method, "work_exponent", power, 0.05, source, more)
        )
        if power > 0.0:
            other = "something else than the pair tests takes the time"
            claims.append(_exponent("test", f"time {where}", method, "exponent", power, 0.2, source, other))
        else:
            value, error = float(method.exponent), float(method.exponent_error)
            bound = (value, error, 0.1, 0.4, "constant work; caches", "the queue's cost grows with N")
            claims.append(Claim.at_most(f"exponent of the time {where}", "test", *bound))
    return claims
