"""Cost of a step with the cheapest partition of each gas against N, and with one box or a neighbour list."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

import numpy as np
import xarray as xr

from gaspart.keys import COUNT, count, list_of, positive, record
from gaspart.rendering import style
from gaspart.rendering.style import Axes, Figure
from gaspart.reproduction.claims import Claim, Estimate
from gaspart.reproduction.figure import Parts
from gaspart.reproduction.figures._timings import SOURCE_A, per_particle, trend, weights
from gaspart.reproduction.figures.naive_scaling import SCAN, SOURCE_COLOUR, one_box
from gaspart.reproduction.points.point import Point
from gaspart.reproduction.table import Table, entries, merge_with_prefixes, table

TITLE, CHAPTER = "Gain from space partitioning", "Speed and accuracy"
SETTINGS = {
    "source_figures": list_of(
        record(
            {
                "radius": positive("radius"),
                "counts": list_of(COUNT, "least and largest number of particles", 2, 2),
            }
        ),
        "source A's figures 8, 9 and 10",
    ),
    "naive_count": count("number of particles to which the naive method is extrapolated"),
    "source_years": positive("years that source A states for it"),
}
YEAR = 365.25 * 86400.0


def measure(points: list[Point], settings: dict) -> xr.Dataset:
    """Measure steps with the cheapest of several partitions, with one box, and with a neighbour list. The
    exponents are of the work (pair tests and box visits) of all gases, and of the time in each of the
    source's figures. The naive method is extrapolated to the source's number of particles.
    """
    runs = sorted(
        (xr.load_dataset(point.path) for point in points), key=lambda run: (run.attrs["count"], run.radius)
    )
    naive = one_box([run for run in runs if run.boxes.values.tolist() == [1]])
    lists = [run for run in runs if not run.boxes.values.any()]
    runs = [run for run in runs if run.sizes["partition"] > 1]
    costs = [per_particle(run) for run in runs]
    cheapest = [cost.isel(partition=int(np.argmin(cost.seconds.values))) for cost in costs]
    gases = _concatenate(cheapest, runs, "gas")
    gases = gases.assign(work=("gas", (gases.pair_tests + gases.box_visits).values))
    rows, far = Table(gases, "gas"), settings["naive_count"]
    seconds = _extrapolate(naive, far)
    ratio = seconds / (rows.seconds[-1] * far)
    numbers = {
        "work_exponent": trend(rows.count, rows.count * rows.work),
        "extrapolated_seconds": (seconds.value, seconds.error),
        "extrapolated_ratio": (ratio.value, ratio.error),
    }
    prefixed = merge_with_prefixes(naive=naive).rename(count="naive_count")
    parts = table("part", settings["source_figures"], _regime, rows)
    merged = [gases, prefixed, _list_costs(lists, rows), parts]
    return xr.merge(merged, join="outer", compat="no_conflicts").assign(
        **entries(numbers), extrapolated_count=far, source_years=settings["source_years"]
    )


def _concatenate(costs: list[xr.Dataset], runs: list[xr.Dataset], over: str) -> xr.Dataset:
    return xr.concat(costs, over, join="outer", compat="equals").assign(
        {name: (over, [run.attrs[name] for run in runs]) for name in ("count", "radius")}
    )


def _list_costs(runs: list[xr.Dataset], gases: Table) -> xr.Dataset:
    """Return the costs of neighbour lists, and their share of the time of the same partitioned gas."""
    costs = _concatenate([per_particle(run).isel(partition=0) for run in runs], runs, "listed")
    shares = []
    for own in Table(costs, "listed"):
        same = gases[(gases.count == own.count) & (gases.radius == own.radius)]
        shares.append(own.seconds / same[-1].seconds if same else Estimate(math.nan, math.nan))
    share = Estimate.stack(shares)
    kept = costs[["seconds", "seconds_error", "pair_tests", "count", "radius"]]
    return kept.assign(share=("listed", share.value), share_error=("listed", share.error)).rename(
        {name: f"list_{name}" for name in (*kept, "share", "share_error")}
    )


def _extrapolate(naive: xr.Dataset, number: float) -> Estimate:
    """Compute the time of a naive step with `number` particles, fitted by a N + b tests."""
    gases = Table(naive, "count")
    fit = weights(gases.seconds, gases.count.astype(float), gases.pair_tests)
    work = np.array([number, 0.5 * number * (number - 1.0)])
    return Estimate(work @ fit.values, math.sqrt(work @ fit.covariance @ work))


def _regime(part: dict, gases: Table) -> dict[str, Any]:
    """Return the exponent of the time per step in one of source A's figures."""
    low, high = part["counts"]
    own = gases[(gases.radius == part["radius"]) & (low <= gases.count) & (gases.count <= high)]
    exponent = trend(own.count, own.count * own.seconds.value)
    return {"part_low": low, "part_high": high, "part_radius": part["radius"], "exponent": exponent}


def claims(dataset: xr.Dataset) -> Iterator[Claim]:
    """Yield the claims on linear work, the source's regimes of time, and its years of the naive method."""
    parts, share = Table(dataset, "part"), Table(dataset, "listed").list_share
    yield Claim.within(
        "exponent of the pair tests and box visits per step in N, cheapest partition", parts.work_exponent,
        1.0, 0.05, f"{SOURCE_A}, section 1.2", "the work per particle depends on N",
    )  # fmt: skip
    for figure, part in enumerate(parts, start=8):
        time = f"exponent of the time per step in N, N = {part.part_low} to {part.part_high}", part.exponent
        source = f"{SOURCE_A}, figure {figure}"
        if figure == 9:
            yield Claim.at_least(
                *time, 1.0, 0.15, f"{source}: superlinear", "larger gases are no slower per particle",
                kind="reproduction", source_error="caches of this machine are larger",
            )  # fmt: skip
            continue
        yield Claim.within(
            *time, 1.0, 0.1, f"{source}: linear",
            "the time per particle depends on N, as when caches overflow", kind="reproduction",
            source_error="the same operations are more expensive in memory than in the caches",
        )  # fmt: skip
    yield Claim.at_most(
        "time with a neighbour list over the cheapest partition's, the worst of all gases",
        share[int(np.nanargmax(share.value))], 0.5, 0.1,
        "most steps test the pairs of the list alone; boxes are filled and searched in every step",
        "a list costs more than it saves",
    )  # fmt: skip
    yield Claim(
        f"log10 of time, one box scanned 27 times over best partition, N = {parts.extrapolated_count}",
        _log10(27.0 * parts.extrapolated_ratio), math.log10(parts.source_years * YEAR), 0.1,
        f"{SOURCE_A}, section 3.4: {parts.source_years:g} years instead of a second",
        "the source's years are not those of one step", kind="reproduction",
        source_error="no count of the work of one step gives it: a thousand steps would take so long",
    )  # fmt: skip


def _log10(ratio: Estimate) -> Estimate:
    """Compute the decimal logarithm; NaN for a time that noise of a short run makes negative."""
    if not ratio.value > 0.0:
        return Estimate(math.nan, math.nan)
    return Estimate(math.log10(ratio.value), ratio.error / ratio.value / math.log(10.0))


def draw(dataset: xr.Dataset) -> Figure:
    """Draw the time of a step by method, and time and work per particle."""
    figure, (top, middle, bottom) = style.new((3.0,), (1.9, 1.7))
    gases, naive, lists = (Table(dataset, over) for over in ("gas", "naive_count", "listed"))
    _one_box(top, naive)
    style.points(top, naive.naive_count, naive.naive_seconds, kind=1, label="one box")
    for kind, (radius, own) in enumerate(reversed(list(gases.by("radius")))):
        n = own.count
        look: dict[str, Any] = {"kind": 2 * kind, "linestyle": "-"}
        style.points(top, n, own.seconds * n, kind=2 * kind, label=f"cheapest partition, $r = {radius:g}$")
        style.points(middle, n, own.seconds * 1e9, **look)
        style.points(bottom, n, own.box_visits, **look)
        style.points(bottom, n, own.pair_tests, kind=2 * kind, linestyle="--", hollow=True)
    for radius, own in reversed(list(lists.by("list_radius"))):
        n, name = own.list_count, None if radius < lists.list_radius.max() else "neighbour list (ours)"
        style.points(top, n, own.list_seconds * n, kind=3, label=name)
        style.points(middle, n, own.list_seconds * 1e9, kind=3, linestyle="-")
        style.points(bottom, n, own.list_pair_tests, kind=3, linestyle="--", hollow=True)
    guide = np.array([gases.count.min(), gases.count.max()], dtype=float)
    least = gases.seconds.value.min()
    top.plot(guide, guide * least, color=style.GREY, lw=0.8, zorder=1, label="linear")
    top.set(xscale="log", yscale="log")
    top.set_xlim(right=50.0 * naive.extrapolated_count)  # space for the times at the ends of the lines
    number = "number of particles $N$"
    style.label_axes(top, number, "time per step (s)", "upper left")
    middle.set(xscale="log", yscale="log", ylabel="time per particle (ns)", ylim=(1.0, None))
    bottom.set(yscale="log", ylabel="number per particle", xlabel=number, ylim=(0.02, 100.0))
    bottom.text(0.02, 0.85, "boxes searched", transform=bottom.transAxes)
    bottom.text(0.02, 0.06, "pair tests (hollow)", transform=bottom.transAxes)
    style.letters(top, middle, bottom)
    return figure


def _one_box(axis: Axes, naive: Table) -> None:
    """Draw the extrapolated time of one box for many particles; nothing if it is negative."""
    far, carried = float(naive.extrapolated_count), naive.extrapolated_seconds.value
    line = np.array([naive.naive_count.min(), far])
    lines = (SCAN, SOURCE_COLOUR, "one box, 27 scans (F & M)"), (1.0, style.COLOURS[1], None)
    for factor, colour, label in lines if carried > 0.0 else ():
        seconds = factor * carried
        axis.plot(line, seconds * (line / far) ** 2, color=colour, linestyle="--", label=label)
        look: dict[str, Any] = {"textcoords": "offset points", "va": "center", "color": colour}
        axis.annotate(_duration(seconds), (far, seconds), xytext=(4, 0), **look)


def _duration(seconds: float) -> str:
    for unit, length in (("h", 3600.0), ("min", 60.0), ("s", 1.0)):
        if seconds >= length:
            return f"{seconds / length:.2g} {unit} a step"
    return f"{seconds * 1e3:.2g} ms a step"


FIGURES = {"linear_scaling": Parts(SETTINGS, measure, claims, draw)}
