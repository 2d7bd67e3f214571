"""Figures of what space partitioning gains. Source A: Frederickx and Meerts 2010."""

from collections.abc import Iterator
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from gaspart.rendering import style
from gaspart.reproduction.families.shared.rows import estimates

_NS, _US, _MS = 1e9, 1e6, 1e3
_SOURCE = style.COLOURS[4]
_SCAN = 27  # source A's program scans its one box once for each of the boxes around it


def naive_scaling(ds: xr.Dataset) -> Figure:
    """Time of a step against N, and per pair test."""
    figure, (top, bottom) = style.new((2.4, 1.3))
    count = ds["count"].values
    line = np.geomspace(count.min(), count.max(), 50)
    law = 0.5 * line * (line - 1.0) * float(ds.test_seconds)
    top.plot(
        line, _SCAN * law * _MS, color=_SOURCE, linestyle="--", label="scanned 27 times (Frederickx & Meerts)"
    )
    top.plot(line, law * _MS, color=style.REFERENCE, label=r"$\frac{1}{2}N(N-1)$ tests, each once")
    style.measured(top, count, estimates(ds, "seconds") * _MS, color=style.DATA, label="measured")
    top.set(xscale="log", yscale="log", ylabel="time per step (ms)")
    top.legend(loc="upper left")
    each = _NS / ds.pair_tests
    style.level(bottom, float(ds.test_seconds) * _NS)
    style.measured(bottom, count, estimates(ds, "seconds") * each.values, color=style.DATA)
    bottom.set(xlabel="number of particles $N$", ylabel="per test (ns)")
    bottom.set_ylim(0.0, 1.6 * float((ds.seconds * each).max()))
    style.letters(top, bottom)
    return figure


def box_count(ds: xr.Dataset) -> Figure:
    """Time and work against the number of boxes; round widths; the event-driven engine's sectors."""
    figure, axes = style.new((2.3, 2.3), (1.9,), (2.5,))
    boxes = ds.boxes_per_side.values.astype(float) ** 3
    _scan_time(axes[0], ds, boxes)
    _scan_work(axes[1], ds, boxes)
    axes[1].set(xscale="log", xlabel="number of boxes")
    _round_widths(axes[2], ds)
    _sectors(axes[3], ds)
    style.letters(*axes)
    return figure


def _scan_time(axis: Axes, ds: xr.Dataset, boxes: np.ndarray) -> None:
    model = ds.particle_seconds + ds.test_seconds * ds.pair_tests + ds.box_seconds * ds.boxes_emptied
    style.measured(axis, boxes, estimates(ds, "seconds") * _NS, color=style.DATA, label="measured")
    style.measured(
        axis, ds.near_boxes_per_side.values.astype(float) ** 3, estimates(ds, "near_seconds") * _NS,
        kind=1, hollow=True, label="boxes within reach",
    )  # fmt: skip
    near = (ds.seconds <= 3.0 * ds.seconds.min()).values
    axis.plot(
        boxes[near], (model * _NS).values[near], color=style.REFERENCE, label="$a + b$ tests $+ c$ boxes"
    )
    particles = float(boxes[-1] / ds.boxes_per_particle[-1])
    interval = [float(ds.ideal_low) * particles, float(ds.ideal_high) * particles]
    if np.isfinite(interval[1]):
        axis.axvspan(*interval, color=style.GREY, alpha=0.25, lw=0)
    axis.axvline(
        float(ds.source_boxes_per_particle) * particles,
        color=_SOURCE,
        linestyle="--",
        ymax=0.45,
        label="F & M",
    )
    axis.set(xscale="log", yscale="log", ylabel="time per particle and step (ns)")
    axis.legend(loc="upper right")


def _scan_work(axis: Axes, ds: xr.Dataset, boxes: np.ndarray) -> None:
    axis.plot(boxes, ds.expected_tests, color=style.COLOURS[0])
    axis.plot(boxes, ds.expected_visits, color=style.COLOURS[1])
    kinds = {"pair_tests": "pair tests", "box_visits": "boxes searched", "boxes_emptied": "boxes emptied"}
    shown: list[Any] = [
        style.points(axis, boxes, ds[name], kind=kind, label=label)
        for kind, (name, label) in enumerate(kinds.items())
    ]
    colour = style.COLOURS[1]
    reached = ds.near_boxes_per_side.values.astype(float) ** 3
    shown.append(
        style.points(axis, reached, ds.near_box_visits, kind=1, hollow=True, label="searched, within reach")
    )
    shown += axis.plot(boxes, ds.in_reach, color=colour, linestyle="--", label="boxes within reach")
    shown += axis.plot(boxes, ds.touched, color=colour, linestyle=":", label="boxes touched (F & M)")
    axis.set(yscale="log", ylabel="per particle and step", ylim=(0.01, 1e8))
    axis.legend(handles=shown, loc="upper right")


def _round_widths(axis: Axes, ds: xr.Dataset) -> None:
    first, second = ds.isel(container=0), ds.isel(container=1)
    per_side = first.fine_boxes_per_side.values
    ratio = (first.fine_seconds / second.fine_seconds).values
    error = ratio * np.hypot(
        (first.fine_seconds_error / first.fine_seconds).values,
        (second.fine_seconds_error / second.fine_seconds).values,
    )
    places, is_round = np.arange(per_side.size), np.isin(per_side, ds.round_per_side.values)
    style.level(axis, 1.0)
    style.points(axis, places[~is_round], ratio[~is_round], error[~is_round], color=style.DATA)
    widths = ", ".join(f"{float(ds.container_side[0]) / n:g}" for n in ds.round_per_side.values)
    style.points(
        axis, places[is_round], ratio[is_round], error[is_round], kind=1, label=f"boxes of width {widths}"
    )
    axis.set_xticks(places, [str(int(n)) for n in per_side])
    axis.tick_params(axis="x", top=False)
    sides = [float(value) for value in ds.container_side]
    axis.set(xlabel="boxes per side", ylabel=f"time, side {sides[0]:g} / {sides[1]:g}")
    axis.legend(loc="upper left")


def _sectors(axis: Axes, ds: xr.Dataset) -> None:
    sectors = ds.sector_boxes_per_side.values.astype(float) ** 2
    style.points(axis, sectors, ds.sector_pair_tests, kind=0, linestyle="-", label="pair tests")
    style.points(axis, sectors, ds.sector_box_visits, kind=1, linestyle="-", label="sectors searched")
    style.points(axis, sectors, ds.sector_crossings, kind=2, linestyle="-", label="crossings")
    style.measured(
        axis, sectors, estimates(ds, "sector_seconds") * _US,
        color=style.DATA, marker="X", linestyle="-", label="time (µs)",
    )  # fmt: skip
    axis.set(xscale="log", yscale="log", xlabel="number of sectors", ylabel="event-driven, per event")
    axis.set_ylim(top=6e5)
    axis.legend(loc="upper right", ncols=2, columnspacing=0.8)


def ideal_boxes(ds: xr.Dataset) -> Figure:
    """The ideal number of boxes against N; and the time around its minimum."""
    figure, (top, bottom) = style.new((2.8,), (2.8,))
    count = ds["count"].values.astype(float)
    line = np.geomspace(0.7 * count.min(), 1.5 * count.max(), 50)
    top.fill_between(
        line, 7.0 * line, 10.0 * line, color=_SOURCE, alpha=0.4, lw=0, label="F & M: 7 to 10 per particle"
    )
    for kind, radius in enumerate(ds.series_radius.values):
        of = ds.isel(gas=np.flatnonzero(ds.radius.values == radius))
        _ideal(top, of, kind, f"ideal, $r = {radius:g}$")
        limit = float((of.most * of["count"])[0])
        label = f"boxes of a diameter, $r = {radius:g}$"
        top.axhline(limit, color=style.COLOURS[kind], linestyle=":", lw=0.8, label=label)
    plateaus = ds.plateau_boxes, ds.plateau_low, ds.plateau_high
    top.hlines(*plateaus, color=_SOURCE, lw=2.0, label="F & M: plateaus")
    top.set(xscale="log", yscale="log", xlabel="number of particles $N$", ylabel="ideal number of boxes")
    top.set_ylim(2e3, 1e8)
    top.legend(loc="lower right")
    shown = [int(n) for n in ds.source_gas]
    shown.insert(0, 1)
    for kind, gas in enumerate(shown):
        one = ds.isel(gas=gas)
        least = float(one.seconds.min())
        label = f"$N = {_thousands(one['count'])}$, $r = {float(one.radius):g}$"
        style.measured(
            bottom, one.boxes_per_particle, estimates(one, "seconds") / least,
            kind=kind, linestyle="-", label=label,
        )  # fmt: skip
    bottom.axvspan(7.0, 10.0, color=_SOURCE, alpha=0.4, lw=0)
    bottom.set(xscale="log", xlabel="boxes per particle", ylabel="time over the least", ylim=(0.9, 4.5))
    bottom.legend(loc="upper center")
    style.letters(top, bottom)
    return figure


def _thousands(number: float | xr.DataArray) -> str:
    """A whole number with thin spaces, for mathematical text."""
    return f"{int(number):,}".replace(",", r"\,")


def _ideal(axis: Axes, of: xr.Dataset, kind: int, label: str) -> None:
    """Ideal numbers with 95 % intervals.

    Hollow: without an interval; with an arrow where the time still falls at the finest partition timed.
    """
    count, interior = of["count"].values, of.ideal_interior.values.astype(bool)
    ideal, low, high = (of[name].values * count for name in ("ideal", "ideal_low", "ideal_high"))
    found = interior & np.isfinite(high) & (low > 0.0)
    bars = np.where(found, [ideal - low, high - ideal], 0.0)
    style.points(axis, count[found], ideal[found], bars[:, found], kind=kind, label=label)
    vague = interior & ~found
    style.points(axis, count[vague], ideal[vague], kind=kind, hollow=True)
    rest = ~interior
    style.points(axis, count[rest], ideal[rest], 0.6 * ideal[rest], kind=kind, hollow=True, lolims=True)


def linear_scaling(ds: xr.Dataset) -> Figure:
    """Time of a step with one box, the cheapest partition and a neighbour list; time, work per particle."""
    figure, (top, middle, bottom) = style.new((3.0,), (1.9, 1.7))
    count = ds["count"].values.astype(float)
    far = float(ds.extrapolated_count)
    naive = ds.naive_count.values
    line, carried = np.array([naive.min(), far]), float(ds.extrapolated_seconds)
    lines = (_SCAN, _SOURCE, "one box, 27 scans (F & M)"), (1.0, style.COLOURS[1], None)
    for factor, colour, label in lines if carried > 0.0 else ():  # noise of a timing may exceed a short one
        seconds = factor * carried
        top.plot(line, seconds * (line / far) ** 2, color=colour, linestyle="--", label=label)
        top.annotate(
            _duration(seconds),
            (far, seconds),
            xytext=(4, 0),
            textcoords="offset points",
            va="center",
            color=colour,
        )
    style.measured(top, naive, estimates(ds, "naive_seconds"), kind=1, label="one box")
    for kind, (radius, of) in enumerate(_by_radius(ds)):
        style.measured(
            top, of["count"], estimates(of, "seconds") * of["count"].values,
            kind=2 * kind, label=f"cheapest partition, $r = {radius:g}$",
        )  # fmt: skip
        n = of["count"].values
        style.measured(middle, n, estimates(of, "seconds") * _NS, kind=2 * kind, linestyle="-")
        style.points(bottom, n, of.box_visits, kind=2 * kind, linestyle="-")
        style.points(bottom, n, of.pair_tests, kind=2 * kind, linestyle="--", hollow=True)
    for radius in sorted(set(ds.list_radius.values.tolist()), reverse=True):
        of = ds.isel(listed=np.flatnonzero(ds.list_radius.values == radius))
        n, seconds = of.list_count.values, estimates(of, "list_seconds")
        label = None if radius < ds.list_radius.max() else "neighbour list (ours)"
        style.measured(top, n, seconds * n, kind=3, label=label)
        style.measured(middle, n, seconds * _NS, kind=3, linestyle="-")
        style.points(bottom, n, of.list_pair_tests, kind=3, linestyle="--", hollow=True)
    guide = np.array([count.min(), count.max()])
    top.plot(guide, guide * float(ds.seconds.min()), color=style.GREY, lw=0.8, zorder=1, label="linear")
    top.set(xscale="log", yscale="log", ylabel="time per step (s)", xlabel="number of particles $N$")
    top.set_xlim(right=50.0 * far)  # room for the times at the ends of the lines
    top.legend(loc="upper left")
    middle.set(xscale="log", yscale="log", ylabel="time per particle (ns)", ylim=(1.0, None))
    bottom.set(yscale="log", ylabel="per particle", xlabel="number of particles $N$", ylim=(0.02, 100.0))
    bottom.text(0.02, 0.85, "boxes searched", transform=bottom.transAxes)
    bottom.text(0.02, 0.06, "pair tests (hollow)", transform=bottom.transAxes)
    style.letters(top, middle, bottom)
    return figure


def _by_radius(ds: xr.Dataset) -> Iterator:
    for radius in sorted(set(ds.radius.values.tolist()), reverse=True):
        yield radius, ds.isel(gas=np.flatnonzero(ds.radius.values == radius))


def _duration(seconds: float) -> str:
    """A time in hours, minutes, seconds or milliseconds."""
    for unit, length in (("h", 3600.0), ("min", 60.0), ("s", 1.0)):
        if seconds >= length:
            return f"{seconds / length:.2g} {unit} a step"
    return f"{seconds * _MS:.2g} ms a step"


def event_scaling(ds: xr.Dataset) -> Figure:
    """Pair tests and time of an event against N, by each search."""
    figure, (top, bottom) = style.new((2.6,), (2.6,))
    names = {"pairs": "all pairs", "direct": "queue, all particles", "boxes": "queue and sectors"}
    methods = zip(ds.method_search.values, ds.method_dimension.values, strict=True)
    for kind, (search, dimension) in enumerate(methods):
        of = ds.isel(run=np.flatnonzero((ds.search.values == search) & (ds.dimension.values == dimension)))
        count, hollow = of["count"].values, bool(dimension == 3)
        label = f"{names[str(search)]}, {dimension}D"
        style.points(top, count, of.pair_tests, kind=kind, hollow=hollow, label=label)
        style.measured(bottom, count, estimates(of, "seconds") * _US, kind=kind, hollow=hollow)
        power = {"pairs": 2.0, "direct": 1.0, "boxes": 0.0}[str(search)]
        _guide(top, count, of.pair_tests.values, power, kind)
        if str(search) != "boxes":
            _guide(bottom, count, of.seconds.values * _US, power, kind)
    for axis, label in ((top, "pair tests per event"), (bottom, "time per event (µs)")):
        axis.set(xscale="log", yscale="log", xlabel="number of particles $N$", ylabel=label)
    top.legend(loc="upper left")
    style.letters(top, bottom)
    return figure


def _guide(axis: Axes, count: np.ndarray, values: np.ndarray, power: float, kind: int) -> None:
    """The power law that the search should follow, through the last point."""
    axis.plot(count, values[-1] * (count / count[-1]) ** power, color=style.COLOURS[kind], lw=0.8, zorder=1)
