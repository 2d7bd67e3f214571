"""Gain of space partitioning: cost of a step or event against particles and boxes.

Every point is a `measure_cost` job: one gas, timed with one or several partitions. Work, time and ideal
numbers, and the origin of their errors, are defined in `families.shared.timings`.
"""

import math
from typing import Any

import numpy as np
import xarray as xr

from gaspart.analysis import statistics
from gaspart.analysis.estimate import Estimate
from gaspart.reproduction.families.scaling.ideal_boxes import ideal_boxes as ideal_boxes
from gaspart.reproduction.families.scaling.remarks import huge_sphere, near_boxes
from gaspart.reproduction.families.shared.timings import (
    extrapolate,
    ideal,
    list_costs,
    one_box,
    penalty,
    per_event,
    per_particle,
    trend,
    weights,
)
from gaspart.reproduction.points.point import Point
from gaspart.reproduction.table import Table, entries, table
from gaspart.theory import dsmc as theory


def naive_scaling(points: list[Point], settings: dict) -> xr.Dataset:
    """Measure the cost of a step with one box against the number of particles N.

    Over ``count``: ``pair_tests`` per step, ``seconds`` per step with ``seconds_error``. Scalars:
    ``exponent`` of the time in N with ``exponent_error`` from the scatter; ``tests_excess``, the largest
    relative difference of the pair tests from N(N-1)/2; ``test_seconds``, the cost of a pair test, from time
    = a N + b tests.
    """
    dataset = one_box([xr.load_dataset(point.path) for point in points])
    gases = Table(dataset, "count")
    count, tests = gases.count.astype(float), gases.pair_tests
    parts = weights(gases.seconds, count, tests)
    return dataset.assign(
        **entries({
            "exponent": trend(count, gases.seconds.value),
            "test_seconds": (parts.values[1], parts.errors[1]),
        }),
        tests_excess=np.abs(tests / (0.5 * count * (count - 1.0)) - 1.0).max(),
    )  # fmt: skip


def box_count(points: list[Point], settings: dict) -> xr.Dataset:
    """Measure cost against the number of boxes of one gas, time-stepped and event-driven.

    The settings are ``round_per_side``, the boxes per side that source A found quicker for their round width;
    ``source_boxes_per_particle``, the ideal number in its figure 6.

    Over ``scan`` (the scan that has one box): costs as in `per_particle`; ``expected_tests`` with
    ``tests_spread`` and ``expected_visits``; the boxes that a particle would search, with each pair tested
    once, if it left out those that it does not touch (``touched``: within a radius) or those that can hold no
    partner (``in_reach``: within a diameter). Over (``container``, ``fine``): ``fine_seconds`` ... of the two
    other scans, in containers whose sides (``container_side``) do and do not give round widths. Over
    ``power``: ``advantage``, see `_advantages`. Over ``sector``: ``sector_seconds`` ... as in `per_event`.
    Scalars: as in `ideal`; ``source_penalty``, the time at the source's number over the least, with error; of
    the sectors, how many neighbourhoods are searched at an event (``event_searches``) and at a crossing
    (``crossing_searches``), from pair tests = discs in a neighbourhood x (a + b crossings), and
    ``crossing_exponent``, of the crossings per event in the number of planes between sectors; with errors.
    Points that are timed alternately `without` something are in `remarks`.
    """
    near = [xr.load_dataset(point.path) for point in points if point.settings.get("near_boxes")]
    huge = [xr.load_dataset(point.path) for point in points if "scene" in point.settings]
    runs = [xr.load_dataset(point.path) for point in points if "without" not in point.settings]
    sectors = next(run for run in runs if run.engine == "event")
    stepped = [run for run in runs if run.engine == "step"]
    main = next(run for run in stepped if 1 in run.boxes)
    fine = sorted((run for run in stepped if 1 not in run.boxes), key=lambda run: run.side)
    costs, events = per_particle(main), per_event(sectors)
    pair = xr.concat([per_particle(run) for run in fine], "container", join="outer", compat="equals")
    pair = pair.rename(_names("fine", pair))
    sides = settings["round_per_side"]
    powers = [
        {"round_per_side": side, "advantage": advantage}
        for side, advantage in zip(sides, _advantages(pair, sides), strict=True)
    ]
    return xr.merge(
        [
            costs.assign(_expected_counts(main)).rename(partition="scan"),
            pair.rename(partition="fine"),
            events.rename(partition="sector", **_names("sector", events)),
            near_boxes(near),
            table("power", powers, dict),
        ],
        join="outer",
        compat="no_conflicts",
    ).assign(
        **ideal(costs, main.dimension),
        **huge_sphere(huge),
        **_crossings(events, sectors),
        count=main.attrs["count"],
        radius=main.radius,
        source_boxes_per_particle=settings["source_boxes_per_particle"],
        **entries({"source_penalty": penalty(costs, settings["source_boxes_per_particle"])}),
        container_side=("container", [run.side for run in fine]),
    )


def _crossings(events: xr.Dataset, run: xr.Dataset) -> dict[str, Any]:
    """Fit the costs of crossings between sectors, for `box_count`."""
    scan = Table(events, "partition")
    gas = run.dimension, run.side, run.radius
    others = (run.attrs["count"] - 1.0) * theory.neighbour_share(scan.boxes_per_side, *gas)
    searches = statistics.fit_polynomial(scan.crossings, scan.pair_tests / others)
    crossings = statistics.fit_power_law(scan.boxes_per_side - 1.0, scan.crossings)
    return entries({
        "event_searches": (searches.values[0], searches.errors[0]),
        "crossing_searches": (searches.values[1], searches.errors[1]),
        "crossing_exponent": (crossings.exponent, crossings.exponent_error),
    })  # fmt: skip


def linear_scaling(points: list[Point], settings: dict) -> xr.Dataset:
    """Measure the cost of a step with the cheapest partition of each gas, against N.

    The settings are ``source_figures``, radius and range of counts of source A's figures 8, 9 and 10;
    ``naive_count``, to which the naive method is extrapolated; ``source_years``, A's estimate for it. Over
    ``gas`` (points with several partitions): ``count``, ``radius``, costs of the cheapest partition as in
    `per_particle`, and ``work``, pair tests and box visits together. Over ``naive`` (points with one box):
    ``naive_count``, ``naive_seconds`` per step, with error. Over ``part`` (A's figures): ``part_low``,
    ``part_high``, ``part_radius``, and ``exponent`` of the time per step in N, with error. Over ``listed``
    (points without partition): see `list_costs`. Scalars: ``work_exponent`` of the work per step over all
    gases, with error; ``extrapolated_count``, ``extrapolated_seconds`` of one naive step there (with error),
    ``extrapolated_ratio``, its time over the partitioned step's (with error); ``source_years``.
    """
    runs = sorted(
        (xr.load_dataset(point.path) for point in points), key=lambda run: (run.attrs["count"], run.radius)
    )
    naive = one_box([run for run in runs if run.boxes.values.tolist() == [1]])
    lists = [run for run in runs if not run.boxes.values.any()]
    runs = [run for run in runs if run.sizes["partition"] > 1]
    costs = [per_particle(run) for run in runs]
    cheapest = xr.concat(
        [cost.isel(partition=int(np.argmin(cost.seconds.values))) for cost in costs],
        "gas",
        join="outer",
        compat="equals",
    )
    cheapest = cheapest.assign(
        count=("gas", [run.attrs["count"] for run in runs]),
        radius=("gas", [run.radius for run in runs]),
        work=("gas", (cheapest.pair_tests + cheapest.box_visits).values),
    )
    gases, carried = Table(cheapest, "gas"), extrapolate(naive, settings["naive_count"])
    ratio = carried / (gases.seconds[-1] * settings["naive_count"])
    naive = naive.rename(count="naive_count", **_names("naive", naive))
    parts = table("part", settings["source_figures"], _regime, gases)
    merged = [cheapest, naive, list_costs(lists, cheapest), parts]
    return xr.merge(merged, join="outer", compat="no_conflicts").assign(
        **entries({
            "work_exponent": trend(gases.count, gases.count * gases.work),
            "extrapolated_seconds": (carried.value, carried.error),
            "extrapolated_ratio": (ratio.value, ratio.error),
        }),
        extrapolated_count=settings["naive_count"],
        source_years=settings["source_years"],
    )  # fmt: skip


def _regime(part: dict, gases: Table) -> dict[str, Any]:
    """Return the exponent of the time per step in one of source A's figures, for `linear_scaling`."""
    low, high = part["counts"]
    own = gases[(gases.radius == part["radius"]) & (low <= gases.count) & (gases.count <= high)]
    exponent = trend(own.count, own.count * own.seconds.value)
    return {"part_low": low, "part_high": high, "part_radius": part["radius"], "exponent": exponent}


def event_scaling(points: list[Point], settings: dict) -> xr.Dataset:
    """Measure the cost of an event, by each method of searching, against N.

    The setting is ``fit_from``, for each search the least N in the fits. Over ``run``: ``search``,
    ``dimension``, ``count``, and costs as in `per_event`. Over ``method`` (a ``method_search`` in a
    ``method_dimension``): the exponents of time (``exponent``) and of pair tests (``work_exponent``) per
    event in N, with errors from the scatter. Scalar ``pairs_excess``: the largest relative difference of the
    pair tests of search "pairs" from N(N-1)/2 for every event and one for the look that finds none left.
    """
    runs = sorted(
        (xr.load_dataset(point.path) for point in points),
        key=lambda run: (run.search, run.dimension, run.attrs["count"]),
    )
    costs = xr.concat(
        [per_event(run).isel(partition=0) for run in runs], "run", join="outer", compat="equals"
    )
    costs = costs.assign(
        search=("run", [run.search for run in runs]),
        dimension=("run", [run.dimension for run in runs]),
        count=("run", [run.attrs["count"] for run in runs]),
    )
    gases = Table(costs, "run")
    methods = list(dict.fromkeys((run.search, run.dimension) for run in runs))
    pairs = gases[gases.search == "pairs"]
    all_pairs = 0.5 * pairs.count * (pairs.count - 1.0) * (pairs.events + 1.0) / pairs.events
    excess = np.abs(pairs.pair_tests / all_pairs - 1.0)
    exponents = table("method", methods, _exponents, gases, settings["fit_from"])
    return xr.merge([costs, exponents], join="outer", compat="no_conflicts").assign(
        pairs_excess=float(excess.max()) if excess.size else math.nan
    )


def _exponents(method: tuple[str, int], gases: Table, fit_from: dict[str, int]) -> dict[str, Any]:
    """Fit the exponents of one search in one dimension, for `event_scaling`."""
    search, dimension = method
    same = (gases.search == search) & (gases.dimension == dimension)
    own = gases[same & (gases.count >= fit_from[search])]
    return {
        "method_search": search,
        "method_dimension": dimension,
        "exponent": trend(own.count, own.seconds.value),
        "work_exponent": trend(own.count, own.pair_tests),
    }


def _names(prefix: str, costs: xr.Dataset) -> dict[str, Any]:
    return {str(name): f"{prefix}_{name}" for name in costs.data_vars}


def _expected_counts(run: xr.Dataset) -> dict:
    """Return the expected counts per particle of a scan, for `box_count`."""
    gas = {"dimension": run.dimension, "side": run.side, "radius": run.radius}
    count, sides = run.attrs["count"], run.boxes_per_side.values
    tests = np.array([theory.expected_pair_tests(count, int(n), **gas) for n in sides]) / count
    width = run.side / sides
    return {
        "expected_tests": ("partition", tests[:, 0]),
        "tests_spread": ("partition", tests[:, 1]),
        "expected_visits": ("partition", [theory.expected_box_visits(int(n), **gas) for n in sides]),
        "touched": ("partition", 0.5 + 0.5 * theory.boxes_in_reach(width, run.radius, run.dimension)),
        "in_reach": ("partition", 0.5 + 0.5 * theory.boxes_in_reach(width, 2.0 * run.radius, run.dimension)),
    }


def _advantages(fine: xr.Dataset, round_per_side: list[int]) -> list[Estimate]:
    """Compute the advantage (ln of time) of partitions over others within an eighth of them.

    It is in the container of the lower side (round widths), less the same in the other container.

    Both scans have the same work, so what does not depend on round numbers cancels. The uncertainty is the
    scatter of those other partitions: their times differ by up to one per cent from process to process, which
    repeats in one process do not show.
    """
    n = fine.fine_boxes_per_side.values[0]
    difference = np.log(fine.fine_seconds.values[1]) - np.log(fine.fine_seconds.values[0])
    others = [difference[(n != boxes) & (np.abs(n / boxes - 1.0) <= 0.125)] for boxes in round_per_side]
    freedom = sum(near.size - 1 for near in others)
    scatter = math.sqrt(sum(near.size * near.var() for near in others) / freedom)
    return [
        Estimate(difference[n == boxes][0] - near.mean(), scatter * math.sqrt(1.0 + 1.0 / near.size), freedom)
        for boxes, near in zip(round_per_side, others, strict=True)
    ]
