"""The ideal number of boxes of many gases, beside the numbers that source A found."""

from typing import Any

import numpy as np
import xarray as xr

from gaspart.reproduction.families.shared.rows import entries, from_rows
from gaspart.reproduction.families.shared.timings import (
    ideal,
    penalty,
    per_particle,
    trend,
)
from gaspart.reproduction.points.point import Point


def ideal_boxes(points: list[Point], settings: dict) -> xr.Dataset:
    """The ideal number of boxes of many gases.

    settings: ``rule``, source A's boxes per particle; ``source_numbers``, those that it found for the largest
    gas of its figures 5, 6 and 7 (each with ``count``, ``radius``, ``boxes_per_particle``);
    ``source_plateaus``, the ranges of N in which it found one number of boxes (``radius``, ``counts``,
    ``boxes_per_side``).

    Over (``gas``, ``partition``): costs as in `per_particle`, NaN beyond a gas's own partitions. Over
    ``gas``: ``count``, ``radius``, ``most`` (boxes per particle of a diameter's width, the limit), the
    results of `ideal`, and ``penalty``, the time at the rule's number over the least, with error. Over
    ``source``: ``source_number``, and what was found there: ``source_ideal`` with interval,
    ``source_penalty`` at that number, with error. Over ``plateau``: see `_plateau`. Over ``series`` (gases of
    one ``series_radius``): ``exponent`` of the ideal number of boxes in N, where it was found between the
    partitions timed, with error from the scatter.
    """
    runs = sorted(
        (xr.load_dataset(point.path) for point in points), key=lambda run: (-run.radius, run.attrs["count"])
    )
    costs = [per_particle(run) for run in runs]
    gases = from_rows("gas", [_gas(*one, settings["rule"]) for one in zip(runs, costs, strict=True)])
    radius, boxes = (
        gases.radius.values,
        (gases.ideal * gases["count"]).where(gases.ideal_interior == 1).values,
    )
    series = []
    for r in sorted(set(radius), reverse=True):
        exponent = trend(gases["count"].values[radius == r], boxes[radius == r])
        series.append({"series_radius": r, **entries({"exponent": exponent})})
    numbered = [cost.assign_coords(partition=np.arange(cost.sizes["partition"])) for cost in costs]
    return xr.merge(
        [
            xr.concat(numbered, "gas", join="outer"),
            gases,
            from_rows("source", [_source(given, costs, gases) for given in settings["source_numbers"]]),
            from_rows("plateau", [_plateau(given, runs, costs) for given in settings["source_plateaus"]]),
            from_rows("series", series),
        ]
    ).assign(rule=settings["rule"])


def _gas(run: xr.Dataset, costs: xr.Dataset, rule: float) -> dict[str, Any]:
    """The ideal number of boxes of one gas, and what the rule's number costs, for `ideal_boxes`."""
    return {
        **ideal(costs, run.dimension),
        "count": run.attrs["count"],
        "radius": run.radius,
        "most": int(run.side / (2.0 * run.radius)) ** run.dimension / run.attrs["count"],
        **entries({"penalty": penalty(costs, rule)}),
    }


def _source(given: dict, costs: list[xr.Dataset], gases: xr.Dataset) -> dict[str, Any]:
    """What was found for the gas of one of source A's numbers, for `ideal_boxes`."""
    same = (gases["count"] == given["count"]) & (gases.radius == given["radius"])
    at = int(np.flatnonzero(same)[0])
    found = ("ideal", "ideal_low", "ideal_high")
    return {
        **{f"source_{name}": gases[name].values[at] for name in found},
        "source_interior": gases.ideal_interior.values[at],
        "source_gas": at,
        "source_number": given["boxes_per_particle"],
        "source_count": given["count"],
        "source_radius": given["radius"],
        **entries({"source_penalty": penalty(costs[at], given["boxes_per_particle"])}),
    }


def _plateau(given: dict, runs: list[xr.Dataset], costs: list[xr.Dataset]) -> dict[str, Any]:
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
        **entries({"plateau_penalty": (ratio, error)}),
    }
