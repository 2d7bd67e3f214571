"""Ideal number of boxes of many gases, compared with the numbers that source A found."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

import numpy as np
import xarray as xr

from gaspart.analysis.statistics import mean_of
from gaspart.keys import COUNT, count, list_of, positive, record
from gaspart.rendering import style
from gaspart.rendering.style import Axes, Figure
from gaspart.reproduction.claims import Claim, Estimate
from gaspart.reproduction.figure import Parts
from gaspart.reproduction.figures._timings import OTHER_MACHINE, SOURCE_A, ideal, penalty, per_particle, trend
from gaspart.reproduction.figures.naive_scaling import SOURCE_COLOUR
from gaspart.reproduction.points.point import Point
from gaspart.reproduction.table import Table, table

TITLE, CHAPTER = "Gain from space partitioning", "Speed and accuracy"
SETTINGS = {
    "rule": positive("source A's boxes per particle"),
    "source_numbers": list_of(
        record(
            {
                "count": count("number of particles"),
                "radius": positive("radius"),
                "boxes_per_particle": positive("ideal number of boxes per particle"),
            }
        ),
        "what source A found for the largest gas of its figures 5, 6 and 7",
    ),
    "source_plateaus": list_of(
        record(
            {
                "radius": positive("radius"),
                "counts": list_of(COUNT, "least and largest number of particles", 2, 2),
                "boxes_per_side": count("the ideal number of boxes per side in this range"),
            }
        ),
        "where source A's ideal number of boxes does not depend on the number of particles",
    ),
}


def measure(points: list[Point], settings: dict) -> xr.Dataset:
    """Measure the ideal number of boxes of each gas, and the cost of the source's numbers. `most` is the
    maximum number of boxes per particle, whose width is a diameter. A penalty is the time at a number of
    boxes divided by the least time. The exponent in N is of the gases of one radius.
    """
    runs = sorted(
        (xr.load_dataset(point.path) for point in points), key=lambda run: (-run.radius, run.attrs["count"])
    )
    costs = [per_particle(run) for run in runs]
    gases = table("gas", list(zip(runs, costs, strict=True)), _gas, settings["rule"])
    rows = Table(gases, "gas")
    radii = sorted(set(rows.radius.tolist()), reverse=True)
    numbered = [cost.assign_coords(partition=np.arange(cost.sizes["partition"])) for cost in costs]
    parts = [
        xr.concat(numbered, "gas", join="outer", compat="equals"),
        gases,
        table("source", settings["source_numbers"], _source, costs, rows),
        table("plateau", settings["source_plateaus"], _plateau, runs, costs),
        table("series", radii, _series, rows),
    ]
    return xr.merge(parts, join="outer", compat="no_conflicts").assign(rule=settings["rule"])


def _gas(timed: tuple[xr.Dataset, xr.Dataset], rule: float) -> dict[str, Any]:
    run, costs = timed
    number, radius = run.attrs["count"], run.radius
    most = int(run.side / (2.0 * radius)) ** run.dimension / number
    row = {"count": number, "radius": radius, "most": most, "penalty": penalty(costs, rule)}
    return ideal(costs, run.dimension) | row


def _source(entry: dict, costs: list[xr.Dataset], gases: Table) -> dict[str, Any]:
    """Return the results for a gas for which source A states a number."""
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
    """Return the penalty of the worst gas in a range of N with one of source A's constant numbers."""
    (low, high), boxes = entry["counts"], entry["boxes_per_side"] ** 3
    ratio, error, worst = max(
        (*penalty(cost, boxes / run.attrs["count"]), run.attrs["count"])
        for run, cost in zip(runs, costs, strict=True)
        if run.radius == entry["radius"] and low <= run.attrs["count"] <= high
    )
    return {
        "plateau_radius": entry["radius"],
        "plateau_low": low,
        "plateau_high": high,
        "plateau_boxes": boxes,
        "plateau_count": worst,
        "plateau_penalty": (ratio, error),
    }


def _series(radius: float, gases: Table) -> dict[str, Any]:
    """Fit the exponent of the ideal number, for gases whose minimum lies between the timed partitions."""
    own = gases[gases.radius == radius]
    boxes = np.where(own.ideal_interior == 1, own.ideal * own.count, np.nan)
    return {"series_radius": radius, "exponent": trend(own.count, boxes)}


INTERVAL = 2.0 * 1.96  # a 95 % interval, in standard errors


def claims(dataset: xr.Dataset) -> Iterator[Claim]:
    """Yield the claims on the source's numbers of boxes per particle, and on their effect."""
    gases = Table(dataset, "gas")
    found: dict[str, Any] = {"kind": "reproduction", "source_error": OTHER_MACHINE}
    yield Claim.at_most(
        f"time with {gases.rule:g} boxes per particle over the least, the worst of all gases",
        gases.penalty[int(np.nanargmax(gases.penalty.value))], 1.25, 0.1,
        f"{SOURCE_A}, section 3.5: ideal is roughly ten",
        "the source's rule is far from the minimum on this machine",
    )  # fmt: skip
    yield Claim.within(
        "ln of the ideal number by counted work over that by time, mean of the gases", _work_over_time(gases),
        0.0, 0.3, "(3^d c_test / 2 c_box)^(1/2), the least cost of counted work",
        "something other than pair tests and boxes determines the optimum",
    )  # fmt: skip
    for series in Table(dataset, "series"):
        yield Claim.within(
            f"exponent of the ideal number of boxes in N, r = {series.series_radius:g}", series.exponent,
            1.0, 0.4, f"{SOURCE_A}, figures 5 to 7: linear",
            "the ideal number per particle depends on N, as when caches overflow", **found,
        )  # fmt: skip
    for figure, row in enumerate(Table(dataset, "source"), start=5):
        number, gas = row.source_number, f"N = {row.source_count}, r = {row.source_radius:g}"
        # The interval is infinite, and the claim inconclusive, without a minimum between the partitions.
        error = (row.source_ideal_high - row.source_ideal_low) / INTERVAL
        yield Claim(
            f"ideal number of boxes per particle, {gas}", Estimate(row.source_ideal, error),
            Estimate(number, 0.1 * number), 0.3 * row.source_ideal, f"{SOURCE_A}, figure {figure}",
            "another machine or program has other relative costs of tests and boxes",
            allowance_source="read from the source's figure to 10 %", **found,
        )  # fmt: skip
        yield Claim.at_most(
            f"time with {number:g} boxes per particle over the least, {gas}", row.source_penalty, 1.1, 0.05,
            f"{SOURCE_A}, figure {figure}", "the source's number is far from the minimum on this machine",
            **found,
        )  # fmt: skip
    for row in Table(dataset, "plateau"):
        yield Claim.at_most(
            f"time with {row.plateau_boxes} boxes over the least, the worst N from {row.plateau_low} to "
            f"{row.plateau_high}, r = {row.plateau_radius:g}", row.plateau_penalty, 1.05, 0.05,
            f"{SOURCE_A}, section 3.4: so many are ideal in all of this range",
            "the ideal number follows N, or is another", **found,
        )  # fmt: skip


def _work_over_time(gases: Table) -> Estimate:
    """Compute mean and scatter of ln(model / ideal), for gases whose minimum was found."""
    ratio = np.log(gases.model / gases.ideal)
    ratio = ratio[gases.ideal_interior.astype(bool) & np.isfinite(ratio)]
    if ratio.size < 2:
        return Estimate(math.nan, math.nan)
    mean = mean_of(ratio)
    return Estimate(mean.value, mean.error)


def draw(dataset: xr.Dataset) -> Figure:
    """Draw the ideal number of boxes against N, and the time around its minimum."""
    figure, (top, bottom) = style.new((2.8,), (2.8,))
    gases = Table(dataset, "gas")
    line = np.geomspace(0.7 * gases.count.min(), 1.5 * gases.count.max(), 50)
    source: dict[str, Any] = {"color": SOURCE_COLOUR, "alpha": 0.4, "lw": 0}
    top.fill_between(line, 7.0 * line, 10.0 * line, label="F & M: 7 to 10 per particle", **source)
    for kind, radius in enumerate(gases.series_radius):
        own = gases[gases.radius == radius]
        _ideal(top, own, kind, f"ideal, $r = {radius:g}$")
        limit, label = own.most[0] * own.count[0], f"boxes of a diameter, $r = {radius:g}$"
        top.axhline(limit, color=style.COLOURS[kind], linestyle=":", lw=0.8, label=label)
    plateaus = gases.plateau_boxes, gases.plateau_low, gases.plateau_high
    top.hlines(*plateaus, color=SOURCE_COLOUR, lw=2.0, label="F & M: plateaus")
    top.set(xscale="log", yscale="log", ylim=(2e3, 1e8))
    style.label_axes(top, "number of particles $N$", "ideal number of boxes", "lower right")
    for kind, gas in enumerate(gases[[1, *map(int, gases.source_gas)]]):
        number = f"{int(gas.count):,}".replace(",", r"\,")
        time = gas.seconds / np.nanmin(gas.seconds.value)
        label = f"$N = {number}$, $r = {gas.radius:g}$"
        style.points(bottom, gas.boxes_per_particle, time, kind=kind, linestyle="-", label=label)
    bottom.axvspan(7.0, 10.0, **source)
    bottom.set(xscale="log", ylim=(0.9, 4.5))
    style.label_axes(bottom, "boxes per particle", "time / least time", "upper center")
    style.letters(top, bottom)
    return figure


def _ideal(axis: Axes, gases: Table, kind: int, label: str) -> None:
    """Draw ideal numbers with 95 % intervals; hollow without one. An arrow marks gases whose time still falls
    at the finest timed partition.
    """
    number, interior = gases.count, gases.ideal_interior.astype(bool)
    best, low, high = gases.ideal * number, gases.ideal_low * number, gases.ideal_high * number
    bounded = interior & np.isfinite(high) & (low > 0.0)
    bars = np.where(bounded, [best - low, high - best], 0.0)
    style.points(axis, number[bounded], best[bounded], bars[:, bounded], kind=kind, label=label)
    vague, rest = interior & ~bounded, ~interior
    style.points(axis, number[vague], best[vague], kind=kind, hollow=True)
    style.points(axis, number[rest], best[rest], 0.6 * best[rest], kind=kind, hollow=True, lolims=True)


FIGURES = {"ideal_boxes": Parts(SETTINGS, measure, claims, draw, key=1)}
