"""Gain from space partitioning: cost of a step or event against particles and boxes.

Every point is a `measure_cost` job: a gas that is timed with one or several partitions. Work, time, ideal
numbers, and their errors are defined in `families.shared.timings`.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import xarray as xr

from gaspart.analysis import statistics
from gaspart.analysis.estimate import Estimate
from gaspart.analysis.statistics import means_of
from gaspart.reproduction.families.shared.timings import (
    extrapolate,
    ideal,
    list_costs,
    log_ratios,
    one_box,
    penalty,
    per_event,
    per_particle,
    ratio_of_jobs,
    trend,
    weights,
)
from gaspart.reproduction.points.point import Point
from gaspart.reproduction.table import Table, entries, table
from gaspart.theory import partition as theory
from gaspart.theory.partition import boxes_in_reach, share_of_contacts_in_a_box

# Tests of source A's remarks on the cost of a step, by alternate timings. Jobs time a gas with and without a
# modification.


def near_boxes(runs: list[xr.Dataset]) -> xr.Dataset:
    """Compare the search of boxes within contact range with a search of all neighbours.

    `runs` are jobs of one gas. All jobs have the same partitions. Variables over ``near`` (the partitions):

    near_boxes_per_side : number of boxes
    near_seconds : time per particle and step with boxes within range only; error from the scatter of jobs
    near_box_visits, near_expected_visits : counted visits; visits in a uniform gas far from walls

    Scalars:

    near_least : least time over the least time with all neighbouring boxes, with error and ``_freedom``
    near_missed : largest difference between the numbers of contacts
    own_first : fraction of searches that could end in the particle's own box, with error

    A search could end there if the own box is searched first and boxes have their largest width. In addition
    there must be a contact (counted), and its partner must be in the box (`share_of_contacts_in_a_box`).
    """
    first, partitions = runs[0], runs[0].sizes["partition"] // 2
    width = first.side / first.boxes_per_side.values[:partitions]
    costs = [per_particle(run) for run in runs]
    timed = np.array([cost.seconds.values for cost in costs])
    seconds, error = means_of(timed[:, :partitions])
    least = ratio_of_jobs(np.log(timed[:, :partitions].min(axis=1) / timed[:, partitions:].min(axis=1)))
    visits = np.mean([cost.box_visits.values[:partitions] for cost in costs], axis=0)
    reached = boxes_in_reach(width, 2.0 * first.radius, first.dimension)
    contacts = np.array([run.collisions.values for run in runs])
    colliding = [2.0 * run.collisions.values[0] / (run.attrs["count"] * run.steps.values[0]) for run in runs]
    within = share_of_contacts_in_a_box(width.max(), 2.0 * first.radius, first.dimension)
    return xr.Dataset(
        {
            "near_boxes_per_side": ("near", first.boxes_per_side.values[:partitions]),
            "near_seconds": ("near", seconds, {"units": "s"}),
            "near_seconds_error": ("near", error, {"units": "s"}),
            "near_box_visits": ("near", visits),
            "near_expected_visits": ("near", 0.5 + 0.5 * reached),
            "near_missed": int(np.ptp(contacts, axis=1).max()),
            **entries({"near_least": least, "own_first": means_of(np.array(colliding) * within)}),
        }
    )


def huge_sphere(runs: list[xr.Dataset]) -> dict[str, Any]:
    """Compute the cost of a sphere that is too large for the boxes.

    The cost follows from jobs with and without the sphere. ``huge_ratio`` is the time of a step with the
    sphere, divided by the time without it. It has an error and ``_freedom`` from the scatter of the jobs.
    ``huge_tests`` is the number of additional pair tests per particle and step, with error.
    """
    ratio = ratio_of_jobs([-log_ratios(run, run.steps.values)[0] for run in runs])
    tests = [np.diff(run.pair_tests.values / run.steps.values)[0] / run.attrs["count"] for run in runs]
    return entries({"huge_ratio": ratio, "huge_tests": means_of(tests)})


# Ideal number of boxes of many gases, compared with the numbers that source A found.


def ideal_boxes(points: list[Point], settings: dict) -> xr.Dataset:
    """Measure the ideal number of boxes of many gases.

    The settings are:

    rule : source A's number of boxes per particle
    source_numbers : ``count``, ``radius``, ``boxes_per_particle`` for the largest gas of A's figures 5 to 7
    source_plateaus : A's ranges of N of constant number of boxes (``radius``, ``counts``, ``boxes_per_side``)

    Over (``gas``, ``partition``) are the costs of `per_particle`, with NaN beyond the partitions of a gas.
    Over ``gas``: ``count``, ``radius``, ``most`` (the maximum number of boxes per particle, whose width is a
    diameter), the results of `ideal`, and ``penalty``, the time at the rule's number divided by the least
    time, with error. Over ``source``: ``source_number``, the ideal number ``source_ideal`` with interval, and
    ``source_penalty`` at the source's number, with error. Over ``plateau``: see `_plateau`. Over ``series``
    (gases of equal ``series_radius``): ``exponent`` of the ideal number of boxes in N, with error from the
    scatter. Only ideal numbers between the timed partitions are used.
    """
    runs = sorted(
        (xr.load_dataset(point.path) for point in points), key=lambda run: (-run.radius, run.attrs["count"])
    )
    costs = [per_particle(run) for run in runs]
    gases = table("gas", list(zip(runs, costs, strict=True)), _gas, settings["rule"])
    rows = Table(gases, "gas")
    radii = sorted(set(rows.radius.tolist()), reverse=True)
    numbered = [cost.assign_coords(partition=np.arange(cost.sizes["partition"])) for cost in costs]
    return xr.merge(
        [
            xr.concat(numbered, "gas", join="outer", compat="equals"),
            gases,
            table("source", settings["source_numbers"], _source, costs, rows),
            table("plateau", settings["source_plateaus"], _plateau, runs, costs),
            table("series", radii, _series, rows),
        ],
        join="outer",
        compat="no_conflicts",
    ).assign(rule=settings["rule"])


def _series(radius: float, gases: Table) -> dict[str, Any]:
    """Fit the exponent of the ideal number of boxes for the gases of one radius.

    Only gases whose minimum was found are used.
    """
    own = gases[gases.radius == radius]
    boxes = np.where(own.ideal_interior == 1, own.ideal * own.count, np.nan)
    return {"series_radius": radius, "exponent": trend(own.count, boxes)}


def _gas(timed: tuple[xr.Dataset, xr.Dataset], rule: float) -> dict[str, Any]:
    """Measure the ideal number of boxes of a gas, and the cost of the rule's number.

    The result is part of `ideal_boxes`.
    """
    run, costs = timed
    return {
        **ideal(costs, run.dimension),
        "count": run.attrs["count"],
        "radius": run.radius,
        "most": int(run.side / (2.0 * run.radius)) ** run.dimension / run.attrs["count"],
        "penalty": penalty(costs, rule),
    }


def _source(entry: dict, costs: list[xr.Dataset], gases: Table) -> dict[str, Any]:
    """Return the results of `ideal_boxes` for a gas for which source A states a number."""
    same = (gases.count == entry["count"]) & (gases.radius == entry["radius"])
    at = int(np.flatnonzero(same)[0])
    gas = gases[at]
    return {
        "source_ideal": gas.ideal,
        "source_ideal_low": gas.ideal_low,
        "source_ideal_high": gas.ideal_high,
        "source_interior": gas.ideal_interior,
        "source_gas": at,
        "source_number": entry["boxes_per_particle"],
        "source_count": entry["count"],
        "source_radius": entry["radius"],
        "source_penalty": penalty(costs[at], entry["boxes_per_particle"]),
    }


def _plateau(entry: dict, runs: list[xr.Dataset], costs: list[xr.Dataset]) -> dict[str, Any]:
    """Return the cost of one of source A's constant numbers of boxes, for `ideal_boxes`.

    The results are ``plateau_radius``; the range ``plateau_low`` to ``plateau_high`` of N; ``plateau_boxes``;
    and for the worst gas in the range, its ``plateau_count``, and ``plateau_penalty``, the time with this
    number of boxes divided by the least time, with error.
    """
    low, high = entry["counts"]
    boxes = entry["boxes_per_side"] ** 3
    within = [
        (*penalty(cost, boxes / run.attrs["count"]), run.attrs["count"])
        for run, cost in zip(runs, costs, strict=True)
        if run.radius == entry["radius"] and low <= run.attrs["count"] <= high
    ]
    ratio, error, count = max(within)
    return {
        "plateau_radius": entry["radius"],
        "plateau_low": low,
        "plateau_high": high,
        "plateau_boxes": boxes,
        "plateau_count": count,
        "plateau_penalty": (ratio, error),
    }


def naive_scaling(points: list[Point], settings: dict) -> xr.Dataset:
    """Measure the cost of a step with one box against the number of particles N.

    Over ``count``: ``pair_tests`` per step, and ``seconds`` per step with ``seconds_error``. Scalars:

    exponent : exponent of the time in N, with ``exponent_error`` from the scatter
    tests_excess : largest relative difference of the pair tests from N(N-1)/2
    test_seconds : time b of a pair test, from a fit of time = a N + b tests
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
    """Measure the cost of one gas against the number of boxes, time-stepped and event-driven.

    The setting ``round_per_side`` has the numbers of boxes per side that source A found faster, because their
    width is round. The setting ``source_boxes_per_particle`` is the ideal number in source A's figure 6.

    Over ``scan`` (the scan that includes one box): costs as in `per_particle`; ``expected_tests`` with
    ``tests_spread``; ``expected_visits``; ``touched`` and ``in_reach``. The last two are numbers of boxes
    that a particle would search if each pair were tested once, and some boxes were left out. For ``touched``,
    boxes beyond a radius are left out. For ``in_reach``, boxes beyond a diameter are left out; they cannot
    contain a partner.

    Over (``container``, ``fine``): ``fine_seconds`` and so on of two other scans. Their containers have the
    sides ``container_side``. One container has round widths of boxes, the other does not. Over ``power``:
    ``advantage``; see `_advantages`. Over ``sector``: ``sector_seconds`` and so on, as in `per_event`.

    Scalars are the results of `ideal`, and with errors:

    source_penalty : time at the source's number divided by the least time
    event_searches, crossing_searches : searched neighbourhoods of sectors, a at an event and b at a crossing
    crossing_exponent : exponent of the crossings per event in the number of planes between sectors

    The numbers a and b follow from pair tests = discs in a neighbourhood x (a + b crossings). Points that are
    timed alternately with and `without` a modification are in `remarks`.
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
    """Fit the cost of crossings between sectors, for `box_count`."""
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

    The settings are:

    source_figures : radius and range of counts of source A's figures 8, 9 and 10
    naive_count : number of particles to which the naive method is extrapolated
    source_years : source A's estimate for this number

    Over ``gas`` (points with several partitions): ``count``, ``radius``, costs of the cheapest partition as
    in `per_particle`, and ``work``, the sum of pair tests and box visits. Over ``naive`` (points with one
    box): ``naive_count``, and ``naive_seconds`` per step, with error. Over ``part`` (figures of source A):
    ``part_low``, ``part_high``, ``part_radius``, and ``exponent`` of the time per step in N, with error. Over
    ``listed`` (points without partition): see `list_costs`.

    Scalars, with errors:

    work_exponent : exponent of the work per step, over all gases
    extrapolated_count, extrapolated_seconds : number of particles, and time of a naive step
    extrapolated_ratio : time of a naive step divided by the time of a step with a partition
    source_years : source A's estimate
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
    """Return the exponent of the time per step in one of source A's figures."""
    low, high = part["counts"]
    own = gases[(gases.radius == part["radius"]) & (low <= gases.count) & (gases.count <= high)]
    exponent = trend(own.count, own.count * own.seconds.value)
    return {"part_low": low, "part_high": high, "part_radius": part["radius"], "exponent": exponent}


def event_scaling(points: list[Point], settings: dict) -> xr.Dataset:
    """Measure the cost of an event by each search method, against N.

    The setting ``fit_from`` is, for each search method, the smallest N in the fits. Over ``run``: ``search``,
    ``dimension``, ``count``, and costs as in `per_event`. Over ``method`` (``method_search`` in
    ``method_dimension``): the exponents in N of time (``exponent``) and of pair tests (``work_exponent``) per
    event, with errors from the scatter. The scalar ``pairs_excess`` is for the search method "pairs". It is
    the largest relative difference of the pair tests from N(N-1)/2 for every event, plus one final search
    that finds no further event.
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
    """Fit the exponents of a search method in one dimension, for `event_scaling`."""
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
    """Compute the advantage of partitions with round widths, as ln of a ratio of times.

    Each partition is compared with others whose number of boxes differs by less than an eighth. The advantage
    is computed in the container with the shorter side (round widths). The same number in the other container
    is subtracted. Both scans have the same work, so effects independent of round widths cancel. The
    uncertainty is the scatter of the other partitions. Their times differ by up to one per cent between
    processes, which repeats in one process do not show.
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
