"""What the scaling figures claim. Source A: Frederickx and Meerts 2010; C: Spencer 2022.

Work is counted, so it is judged strictly. Times belong to a machine and a program: what the sources report
of theirs is a reproduction, in which disagreement is a result and not a fault.
"""

import math

import numpy as np

from gaspart.claims import Claim

A = "Frederickx & Meerts 2010"
C = "Spencer 2022"
YEAR = 365.25 * 86400.0
_INTERVAL = 2.0 * 1.96  # a 95 % interval in standard errors


def naive_scaling(ds):
    """Quadratic: exactly in pair tests, and in time as far as the caches let it be."""
    return [
        Claim(
            "one box: largest relative difference of the pair tests per step from N(N-1)/2",
            "identity",
            ds.tests_excess,
            0.0,
            0.0,
            0.0,
            "each pair once",
            fails_if="a pair is tested twice, or not at all",
        ),
        Claim.within(
            "one box: exponent of the time per step in N",
            "test",
            float(ds.exponent),
            float(ds.exponent_error),
            2.0,
            0.15,
            f"{A}, figure 3",
            "something else than the pair tests takes the time",
        ),
    ]


def box_count(ds):
    """An optimum exists, the counts are those expected, and round widths are no quicker."""
    seconds = ds.seconds.values
    error = ds.seconds_error.values / seconds
    best = int(np.argmin(seconds))
    ratios = {
        "one box": (seconds[0] / seconds[best], error[0], 10.0),
        f"{int(ds.boxes_per_side[-1])} boxes per side": (seconds[-1] / seconds[best], error[-1], 1.5),
    }
    claims = [
        Claim.at_least(
            f"there is an optimum: time with {name} over the least",
            "test",
            ratio,
            ratio * math.hypot(own, error[best]),
            0.2 * ratio,
            bound,
            f"{A}, figure 4",
            "time rises or falls with the number of boxes throughout",
        )
        for name, (ratio, own, bound) in ratios.items()
    ]
    visits = (ds.box_visits / ds.expected_visits).values
    farthest = visits[np.argmax(np.abs(visits - 1.0))]
    claims += [
        Claim(
            f"pair tests per body and step with {int(ds.boxes_per_side[best])} boxes per side",
            "test",
            ds.pair_tests[best],
            ds.tests_spread[best],
            0.05 * ds.expected_tests[best],
            ds.expected_tests[best],
            "uniform density, gaspart.theory.partition",
            fails_if="pairs are overlooked or tested twice, or the gas is not uniform",
        ),
        Claim.within(
            "box visits per body over those expected, the scan's farthest",
            "test",
            farthest,
            visits.std(ddof=1),
            1.0,
            0.02,
            "uniform density, gaspart.theory.partition",
            "boxes are left out or looked into twice",
        ),
        Claim(
            "ideal number of boxes per body, N = 10 000, r = 0.1",
            "reproduction",
            ds.ideal,
            (ds.ideal_high - ds.ideal_low) / _INTERVAL,
            0.25 * ds.ideal,
            12.5,
            f"{A}, figure 6: 50^3 boxes",
            fails_if="another machine or program weighs tests and boxes differently",
        ),
    ]
    for n, advantage, spread in zip(
        ds.round_per_side.values, ds.advantage.values, ds.advantage_error.values, strict=True
    ):
        width = f"{float(ds.container_side[0]) / n:g}"
        claims.append(
            Claim(
                f"ln of time saved by {n} boxes per side for having the width {width} exactly",
                "test",
                advantage,
                spread,
                0.02,
                0.0,
                f'arithmetic does not care; {A}, section 3.4: "powers of two" are easy',
                fails_if="widths that are powers of two make a step quicker",
            )
        )
    claims += [
        Claim.within(
            "sectors: neighbourhoods searched at a crossing",
            "test",
            ds.crossing_searches,
            ds.crossing_searches_error,
            1.0 / 3.0,
            0.05,
            f"{C}, section 4.4: of the nine adjacent sectors, three are new",
            "searches look farther than the adjacent sectors, or not at all of them",
        ),
        Claim.within(
            "sectors: exponent of the crossings per event in the planes between sectors",
            "test",
            ds.crossing_exponent,
            ds.crossing_exponent_error,
            1.0,
            0.05,
            "free flight through uniform density",
            "crossings are lost or made up",
        ),
    ]
    return claims


def ideal_boxes(ds):
    """The source's numbers of boxes per particle, and how much they matter."""
    worst = int(np.nanargmax(ds.penalty.values))
    ratio = np.log(ds.model / ds.ideal).values
    ratio = ratio[ds.ideal_interior.values.astype(bool) & np.isfinite(ratio)]
    claims = [
        Claim.at_most(
            "time with ten boxes per body over the least, the worst of all gases",
            "test",
            float(ds.penalty[worst]),
            float(ds.penalty_error[worst]),
            0.1,
            1.25,
            f"{A}, section 3.5: ideal is roughly ten",
            "the source's rule is far from the minimum on this machine",
        ),
        Claim.within(
            "ln of the ideal number by counted work over that by time, mean of the gases",
            "test",
            *_mean(ratio),
            0.0,
            0.3,
            "(3^d c_test / 2 c_box)^(1/2), gaspart.theory.partition",
            "something else than pair tests and boxes decides the optimum",
        ),
    ]
    for r, value, error in zip(
        ds.series_radius.values, ds.exponent.values, ds.exponent_error.values, strict=True
    ):
        claims.append(
            Claim.within(
                f"exponent of the ideal number of boxes in N, r = {r:g}",
                "reproduction",
                value,
                error,
                1.0,
                0.4,
                f"{A}, figures 5 to 7: linear",
                "the ideal number of boxes per body depends on N, as when caches overflow",
            )
        )
    return claims + [
        claim for n in range(ds.sizes["source"]) for claim in _source_numbers(ds.isel(source=n), n)
    ]


def _source_numbers(source, n):
    """The source's number for the largest gas of its figure 5 + n: is it the ideal one, and if not, how bad?"""
    number = float(source.source_number)
    name = f"N = {int(source.source_count)}, r = {float(source.source_radius):g}"
    origin = f"{A}, figure {5 + n}"
    limit = "" if source.source_interior else ", not found below the limit of one diameter a box"
    ideal = float(source.source_ideal)
    return [
        Claim(
            f"ideal number of boxes per body, {name}{limit}",
            "reproduction",
            ideal,
            float(source.source_ideal_high - source.source_ideal_low) / _INTERVAL,
            0.3 * ideal,
            number,
            origin,
            expected_uncertainty=0.1 * number,
            fails_if="another machine or program weighs tests and boxes differently",
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


def _mean(values):
    """Mean of independent values and its standard error from their scatter; NaN if there are too few."""
    if values.size < 2:
        return math.nan, math.nan
    return float(values.mean()), float(values.std(ddof=1) / math.sqrt(values.size))


def linear_scaling(ds):
    """Linear in counted work; in time, the source's three regimes."""
    claims = [
        Claim.within(
            "cheapest partition: exponent of pair tests and box visits per step in N",
            "test",
            float(ds.work_exponent),
            float(ds.work_exponent_error),
            1.0,
            0.05,
            f"{A}, section 1.2: O(N) at a constant number of bodies per box",
            "the work per body depends on N",
        )
    ]
    figures = zip(
        ds.part_low.values, ds.part_high.values, ds.exponent.values, ds.exponent_error.values, strict=True
    )
    for n, (low, high, value, error) in enumerate(figures):
        what = f"exponent of the time per step in N, N = {low} to {high}"
        source = f"{A}, figure {8 + n}"
        if n == 1:
            claims.append(
                Claim.at_least(
                    what, "reproduction", value, error, 0.15, 1.0, f"{source}: slightly superlinear",
                    "larger gases are no slower per body",
                )
            )  # fmt: skip
        else:
            claims.append(
                Claim.within(
                    what, "reproduction", value, error, 1.0, 0.1, f"{source}: linear",
                    "the time per body depends on N, as when caches overflow",
                )
            )  # fmt: skip
    ratio = 27.0 * float(ds.extrapolated_ratio)
    claims.append(
        Claim(
            f"log10 of the time of a naive step, scanned 27 times, over a partitioned one, N = {int(ds.extrapolated_count)}",
            "reproduction",
            math.log10(ratio),
            float(ds.extrapolated_ratio_error / ds.extrapolated_ratio) / math.log(10.0),
            0.1,
            math.log10(float(ds.source_years) * YEAR),
            f"{A}, section 3.4: {float(ds.source_years):g} years instead of one second",
            fails_if="the source's years are not those of one step",
        )
    )
    return claims


def event_scaling(ds):
    """How the cost of an event grows with N, by each search."""
    claims = [
        Claim(
            "all pairs: largest relative difference of the pair tests from N(N-1)/2 at every event",
            "identity",
            ds.pairs_excess,
            0.0,
            1e-12,
            0.0,
            f"{C}, section 4.2",
            fails_if="a pair is tested twice, or not at all",
        )
    ]
    expected = {
        "pairs": (2.0, "4.2: all pairs"),
        "direct": (1.0, "4.3: a queue"),
        "boxes": (0.0, "4.4: sectors"),
    }
    for n in range(ds.sizes["method"]):
        method = ds.isel(method=n)
        power, section = expected[str(method.method_search.values)]
        name = f'search "{method.method_search.values}", {int(method.method_dimension)}D'
        claims.append(
            Claim.within(
                f"{name}: exponent of the pair tests per event in N",
                "test",
                float(method.work_exponent),
                float(method.work_exponent_error),
                power,
                0.05,
                f"{C}, section {section}",
                "the search looks at more bodies than it should",
            )
        )
        time = (float(method.exponent), float(method.exponent_error))
        if power > 0.0:
            claims.append(
                Claim.within(
                    f"{name}: exponent of the time per event in N", "test", *time, power, 0.2,
                    f"{C}, section {section}", "something else than the pair tests takes the time",
                )
            )  # fmt: skip
        else:
            claims.append(
                Claim.at_most(
                    f"{name}: exponent of the time per event in N", "test", *time, 0.1, 0.4,
                    "constant work; memory out of the caches is slower", "the queue's cost grows with N",
                )
            )  # fmt: skip
    return claims
