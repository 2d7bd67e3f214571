"""What space partitioning gains: the cost of a step, or of an event, against the particles and the boxes.

Every point is a `measure_cost` job: one gas, timed with one or several partitions. What is meant by work,
time and ideal numbers, and where their errors come from, stands in `gaspart.experiments.shared.timings`.
"""

import math
from typing import Any

import numpy as np
import xarray as xr

from gaspart.analysis import statistics
from gaspart.experiments.scaling.remarks import huge_sphere, near_boxes
from gaspart.experiments.shared.timings import (
    extrapolate,
    ideal,
    listed,
    one_box,
    penalty,
    per_body,
    per_event,
    weights,
)
from gaspart.planning import grid
from gaspart.theory import partition as theory


def naive_scaling(points: list[grid.Point], settings: dict) -> xr.Dataset:
    """One box: the cost of a step against the number of particles N.

    Over ``count``: ``pair_tests`` per step, ``seconds`` per step with ``seconds_error``. Scalars:
    ``exponent`` of the time in N with ``exponent_error`` from the scatter; ``tests_excess``, the largest
    relative difference of the pair tests from N(N-1)/2; ``test_seconds``, the cost of a pair test, from
    time = a N + b tests.
    """
    made = one_box([_run(point) for point in points])
    count, tests, seconds = (made[name].values.astype(float) for name in ("count", "pair_tests", "seconds"))
    exponent, error = _trend(count, seconds)
    parts = weights(seconds, made.seconds_error.values, count, tests)
    return made.assign(
        exponent=exponent,
        exponent_error=error,
        tests_excess=np.abs(tests / (0.5 * count * (count - 1.0)) - 1.0).max(),
        test_seconds=parts.values[1],
        test_seconds_error=parts.errors[1],
    )


def box_count(points: list[grid.Point], settings: dict) -> xr.Dataset:
    """One gas: cost against the number of boxes, time-stepped and event-driven.

    settings: ``round_per_side``, the boxes per side that source A found quicker for their round width;
    ``source_boxes_per_body``, the ideal number in its figure 6.

    Over ``scan`` (the scan that has one box): costs as in `per_body`; ``expected_tests`` with
    ``tests_spread`` and ``expected_visits``; the boxes that a particle would search, with each
    pair tested once, if it left out those that it does not touch (``touched``: within a radius) or those
    that can hold no partner (``in_reach``: within a diameter).
    Over (``container``, ``fine``): ``fine_seconds`` ... of the two other scans, in containers whose sides
    (``container_side``) do and do not give round widths. Over ``power``: ``advantage``, see `_advantage`.
    Over ``sector``: ``sector_seconds`` ... as in `per_event`. Scalars: as in `ideal`; ``source_penalty``, the
    time at the source's number over the least, with error; of the sectors, how
    many neighbourhoods are searched at an event (``event_searches``) and at a crossing
    (``crossing_searches``), from pair tests = discs in a neighbourhood x (a + b crossings), and
    ``crossing_exponent``, of the crossings per event in the number of planes between sectors; with errors.
    Points that are timed in turn `without` something: see `remarks`.
    """
    near = [_run(point) for point in points if point.settings.get("near_boxes")]
    huge = [_run(point) for point in points if "scene" in point.settings]
    runs = [_run(point) for point in points if "without" not in point.settings]
    sectors = next(run for run in runs if run.engine == "event")
    stepped = [run for run in runs if run.engine == "step"]
    main = next(run for run in stepped if 1 in run.boxes)
    fine = sorted((run for run in stepped if 1 not in run.boxes), key=lambda run: run.side)
    costs, events = per_body(main), per_event(sectors)
    pair = xr.concat([per_body(run) for run in fine], "container")
    pair = pair.rename(_names("fine", pair))
    advantage = np.array([_advantage(pair, per_side) for per_side in settings["round_per_side"]])
    slower = penalty(costs, settings["source_boxes_per_body"])
    return xr.merge(
        [
            costs.assign(_expected(main)).rename(partition="scan"),
            pair.rename(partition="fine"),
            events.rename(partition="sector", **_names("sector", events)),
            near_boxes(near),
        ]
    ).assign(
        **ideal(costs, main.dimension),
        **huge_sphere(huge),
        **_crossings(events, sectors),
        count=main.attrs["count"],
        radius=main.radius,
        source_boxes_per_body=settings["source_boxes_per_body"],
        source_penalty=slower[0],
        source_penalty_error=slower[1],
        container_side=("container", [run.side for run in fine]),
        round_per_side=("power", settings["round_per_side"]),
        advantage=("power", advantage[:, 0]),
        advantage_error=("power", advantage[:, 1]),
    )


def _crossings(events: xr.Dataset, run: xr.Dataset) -> dict[str, Any]:
    """What crossings between sectors cost, for `box_count`."""
    others = (run.attrs["count"] - 1.0) * theory.neighbour_share(
        events.boxes_per_side.values, run.dimension, run.side, run.radius
    )
    searches = statistics.fit_polynomial(events.crossings.values, events.pair_tests.values / others)
    crossings = statistics.fit_power_law(events.boxes_per_side.values - 1.0, events.crossings.values)
    return {
        "event_searches": searches.values[0],
        "event_searches_error": searches.errors[0],
        "crossing_searches": searches.values[1],
        "crossing_searches_error": searches.errors[1],
        "crossing_exponent": crossings.exponent,
        "crossing_exponent_error": crossings.exponent_error,
    }


def ideal_boxes(points: list[grid.Point], settings: dict) -> xr.Dataset:
    """The ideal number of boxes of many gases.

    settings: ``rule``, source A's boxes per particle; ``source_numbers``, those that it found for the largest
    gas of its figures 5, 6 and 7 (each with ``count``, ``radius``, ``boxes_per_body``); ``source_plateaus``,
    the ranges of N in which it found one number of boxes (``radius``, ``counts``, ``boxes_per_side``).

    Over (``gas``, ``partition``): costs as in `per_body`, NaN beyond a gas's own partitions. Over ``gas``:
    ``count``, ``radius``, ``most`` (boxes per particle of a diameter's width, the limit), the results of
    `ideal`, and ``penalty``, the time at the rule's number over the least, with error. Over ``source``:
    ``source_number``, and what was found there: ``source_ideal`` with interval, ``source_penalty`` at that
    number, with error. Over ``plateau``: see `_plateau`. Over ``series`` (gases of one ``series_radius``):
    ``exponent`` of the ideal number of boxes in N, where it was found between the partitions timed, with
    error from the scatter.
    """
    runs = sorted((_run(point) for point in points), key=lambda run: (-run.radius, run.attrs["count"]))
    costs = [per_body(run) for run in runs]
    found = [ideal(cost, run.dimension) for cost, run in zip(costs, runs, strict=True)]
    found = {name: np.array([one[name] for one in found]) for name in found[0]}
    count = np.array([run.attrs["count"] for run in runs])
    radius = np.array([run.radius for run in runs])
    radii = sorted(set(radius), reverse=True)
    boxes = np.where(found["ideal_interior"], found["ideal"] * count, math.nan)
    trend = [_trend(count[radius == r], boxes[radius == r]) for r in radii]
    sources = [_source(given, costs, found, count, radius) for given in settings["source_numbers"]]
    plateaus = [_plateau(given, runs, costs) for given in settings["source_plateaus"]]
    slower = [penalty(cost, settings["rule"]) for cost in costs]
    most = [int(run.side / (2.0 * run.radius)) ** run.dimension / run.attrs["count"] for run in runs]
    numbered = [cost.assign_coords(partition=np.arange(cost.sizes["partition"])) for cost in costs]
    by_gas: dict[str, Any] = {name: ("gas", values) for name, values in found.items()}
    by_source: dict[str, Any] = {name: ("source", [one[name] for one in sources]) for name in sources[0]}
    by_plateau: dict[str, Any] = {name: ("plateau", [one[name] for one in plateaus]) for name in plateaus[0]}
    return xr.concat(numbered, "gas", join="outer").assign(
        **by_gas,
        count=("gas", count),
        radius=("gas", radius),
        most=("gas", most),
        penalty=("gas", [value for value, _ in slower]),
        penalty_error=("gas", [error for _, error in slower]),
        **by_source,
        **by_plateau,
        rule=settings["rule"],
        series_radius=("series", radii),
        exponent=("series", [value for value, _ in trend]),
        exponent_error=("series", [error for _, error in trend]),
    )


def linear_scaling(points: list[grid.Point], settings: dict) -> xr.Dataset:
    """The cost of a step with the cheapest partition of each gas, against the number of particles N.

    settings: ``source_figures``, radius and range of counts of source A's figures 8, 9 and 10;
    ``naive_count``, to which the naive method is extrapolated; ``source_years``, A's estimate for it.
    Over ``gas`` (points with several partitions): ``count``, ``radius``, costs of the cheapest partition as
    in `per_body`, and ``work``, pair tests and box visits together. Over ``naive`` (points with one box):
    ``naive_count``, ``naive_seconds`` per step, with error. Over ``part`` (A's figures): ``part_low``,
    ``part_high``, ``part_radius``, and ``exponent`` of the time per step in N, with error. Over ``listed``
    (points without partition): see `listed`.
    Scalars: ``work_exponent`` of the work per step over all gases, with error; ``extrapolated_count``,
    ``extrapolated_seconds`` of one naive step there (with error), ``extrapolated_ratio``, its time over the
    partitioned step's (relative error in ``extrapolated_ratio_error``); ``source_years``.
    """
    runs = sorted((_run(point) for point in points), key=lambda run: (run.attrs["count"], run.radius))
    naive = one_box([run for run in runs if run.boxes.values.tolist() == [1]])
    lists = [run for run in runs if not run.boxes.values.any()]
    runs = [run for run in runs if run.sizes["partition"] > 1]
    costs = [per_body(run) for run in runs]
    gases = xr.concat([cost.isel(partition=int(np.argmin(cost.seconds.values))) for cost in costs], "gas")
    count = np.array([run.attrs["count"] for run in runs], dtype=float)
    radius = np.array([run.radius for run in runs])
    seconds = count * gases.seconds.values
    work = (gases.pair_tests + gases.box_visits).values
    work_exponent, work_error = _trend(count, count * work)
    parts = []
    for part in settings["source_figures"]:
        low, high = part["counts"]
        chosen = (radius == part["radius"]) & (low <= count) & (count <= high)
        parts.append(_trend(count[chosen], seconds[chosen]))
    carried = extrapolate(naive, settings["naive_count"])
    step, step_error = seconds[-1], count[-1] * gases.seconds_error.values[-1]
    scale = settings["naive_count"] / count[-1]
    ratio = carried[0] / (scale * step)
    gases = gases.assign(count=("gas", count.astype(int)), radius=("gas", radius))
    naive = naive.rename(count="naive_count", **_names("naive", naive))
    return xr.merge([gases, naive, listed(lists, gases)]).assign(
        work=("gas", work),
        part_low=("part", [part["counts"][0] for part in settings["source_figures"]]),
        part_high=("part", [part["counts"][1] for part in settings["source_figures"]]),
        part_radius=("part", [part["radius"] for part in settings["source_figures"]]),
        exponent=("part", [value for value, _ in parts]),
        exponent_error=("part", [error for _, error in parts]),
        work_exponent=work_exponent,
        work_exponent_error=work_error,
        extrapolated_count=settings["naive_count"],
        extrapolated_seconds=carried[0],
        extrapolated_seconds_error=carried[1],
        extrapolated_ratio=ratio,
        extrapolated_ratio_error=ratio * math.hypot(carried[1] / carried[0], step_error / step),
        source_years=settings["source_years"],
    )


def event_scaling(points: list[grid.Point], settings: dict) -> xr.Dataset:
    """The cost of an event, by each method of searching for the next one, against the number of particles N.

    settings: ``fit_from``, for each search the least N in the fits. Over ``run``: ``search``, ``dimension``,
    ``count``, and costs as in `per_event`. Over ``method`` (a ``method_search`` in a ``method_dimension``):
    the exponents of time (``exponent``) and of pair tests (``work_exponent``) per event in N, with errors
    from the scatter. Scalar ``pairs_excess``: the largest relative difference of the pair tests of search
    "pairs" from N(N-1)/2 for every event and one for the look that finds none left.
    """
    runs = sorted(
        (_run(point) for point in points), key=lambda run: (run.search, run.dimension, run.attrs["count"])
    )
    costs = xr.concat([per_event(run).isel(partition=0) for run in runs], "run")
    search = np.array([run.search for run in runs])
    dimension = np.array([run.dimension for run in runs])
    count = np.array([run.attrs["count"] for run in runs], dtype=float)
    methods = list(dict.fromkeys(zip(search.tolist(), dimension.tolist(), strict=True)))
    fits = []
    for name, d in methods:
        chosen = (search == name) & (dimension == d) & (count >= settings["fit_from"][name])
        fits.append(
            (
                *_trend(count[chosen], costs.seconds.values[chosen]),
                *_trend(count[chosen], costs.pair_tests.values[chosen]),
            )
        )
    time, time_error, work, work_error = zip(*fits, strict=True)
    events = costs.events.values
    all_pairs = 0.5 * count * (count - 1.0) * (events + 1.0) / events
    excess = np.abs(costs.pair_tests.values / all_pairs - 1.0)[search == "pairs"]
    return costs.assign(
        search=("run", search),
        dimension=("run", dimension),
        count=("run", count.astype(int)),
        method_search=("method", [name for name, _ in methods]),
        method_dimension=("method", [d for _, d in methods]),
        exponent=("method", list(time)),
        exponent_error=("method", list(time_error)),
        work_exponent=("method", list(work)),
        work_exponent_error=("method", list(work_error)),
        pairs_excess=float(excess.max()) if excess.size else math.nan,
    )


def _run(point: grid.Point) -> xr.Dataset:
    """The dataset of a `measure_cost` point."""
    return xr.load_dataset(point.path)


def _names(prefix: str, costs: xr.Dataset) -> dict[str, Any]:
    return {str(name): f"{prefix}_{name}" for name in costs.data_vars}


def _expected(run: xr.Dataset) -> dict:
    """Expected counts per particle of a scan, for `box_count`."""
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


def _source(
    given: dict, costs: list[xr.Dataset], found: dict[str, np.ndarray], count: np.ndarray, radius: np.ndarray
) -> dict:
    """What was found for the gas of one of source A's numbers, for `ideal_boxes`."""
    at = int(np.flatnonzero((count == given["count"]) & (radius == given["radius"]))[0])
    slower = penalty(costs[at], given["boxes_per_body"])
    return {
        **{f"source_{name}": found[name][at] for name in ("ideal", "ideal_low", "ideal_high")},
        "source_interior": found["ideal_interior"][at],
        "source_gas": at,
        "source_number": given["boxes_per_body"],
        "source_count": given["count"],
        "source_radius": given["radius"],
        "source_penalty": slower[0],
        "source_penalty_error": slower[1],
    }


def _plateau(given: dict, runs: list[xr.Dataset], costs: list[xr.Dataset]) -> dict:
    """What one of source A's constant numbers of boxes costs, for `ideal_boxes`: ``plateau_radius``,
    ``plateau_low`` and ``_high`` N, ``plateau_boxes``; of the gases between these the worst, its
    ``plateau_count``, and ``plateau_penalty``, the time with so many boxes over the least, with error."""
    low, high = given["counts"]
    boxes = given["boxes_per_side"] ** 3
    within = [
        (*penalty(cost, boxes / run.attrs["count"]), run.attrs["count"])
        for run, cost in zip(runs, costs, strict=True)
        if run.radius == given["radius"] and low <= run.attrs["count"] <= high
    ]
    ratio, error, count = max(within)
    return {
        "plateau_radius": given["radius"],
        "plateau_low": low,
        "plateau_high": high,
        "plateau_boxes": boxes,
        "plateau_count": count,
        "plateau_penalty": ratio,
        "plateau_penalty_error": error,
    }


def _advantage(fine: xr.Dataset, per_side: int) -> tuple[float, float]:
    """By how much (ln of time) `per_side` is quicker than the partitions within 10 % of it, in
    the container of the lower side (round widths), less the same in the other; and its standard error.

    Both scans have the same work, so what does not depend on round numbers cancels."""
    n = fine.fine_boxes_per_side.values[0]
    near = (n != per_side) & (np.abs(n / per_side - 1.0) <= 0.1)
    difference = np.log(fine.fine_seconds.values[1]) - np.log(fine.fine_seconds.values[0])
    variance = ((fine.fine_seconds_error / fine.fine_seconds).values ** 2).sum(axis=0)
    at = n == per_side
    value = difference[at][0] - difference[near].mean()
    return value, math.sqrt(variance[at][0] + variance[near].sum() / near.sum() ** 2)


def _trend(count: np.ndarray, values: np.ndarray) -> tuple[float, float]:
    """Exponent of a power law and its error from the scatter; NaN if fewer than three points can be used."""
    usable = np.isfinite(values)
    if usable.sum() < 3:
        return math.nan, math.nan
    fit = statistics.fit_power_law(count[usable], values[usable])
    return fit.exponent, fit.exponent_error
