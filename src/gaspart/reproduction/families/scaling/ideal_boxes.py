"""Ideal number of boxes of many gases, compared with the numbers that source A found."""

from typing import Any

import numpy as np
import xarray as xr

from gaspart.reproduction.families.shared.timings import ideal, penalty, per_particle, trend
from gaspart.reproduction.points.point import Point
from gaspart.reproduction.table import Table, table


def ideal_boxes(points: list[Point], settings: dict) -> xr.Dataset:
    """Return the ideal number of boxes of many gases.

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
    """Fit the exponent of the ideal number of boxes of the gases of one radius.

    Only gases with a minimum count.
    """
    own = gases[gases.radius == radius]
    boxes = np.where(own.ideal_interior == 1, own.ideal * own.count, np.nan)
    return {"series_radius": radius, "exponent": trend(own.count, boxes)}


def _gas(timed: tuple[xr.Dataset, xr.Dataset], rule: float) -> dict[str, Any]:
    """Measure the ideal number of boxes of one gas, and the cost of the rule's.

    They serve `ideal_boxes`.
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
    """Return the results for the gas of one of source A's numbers, for `ideal_boxes`."""
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

    It has ``plateau_radius``, ``plateau_low`` and ``_high`` N, ``plateau_boxes``; of the gases between these
    the worst, its ``plateau_count``, and ``plateau_penalty``, the time with this number of boxes over the
    least, with error.
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
