"""Figures of the gain from space partitioning; source A is Frederickx and Meerts 2010."""

from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from gaspart.rendering import style
from gaspart.reproduction.table import Table

_NS, _US, _MS = 1e9, 1e6, 1e3
_SOURCE = style.COLOURS[4]
_SCAN = 27  # source A's program scans its single box once for each of the surrounding boxes


def naive_scaling(ds: xr.Dataset) -> Figure:
    """Draw the time of a step against N, and the time per pair test."""
    figure, (top, bottom) = style.new((2.4, 1.3))
    gases = Table(ds, "count")
    count, test = gases.count, gases.test_seconds.value
    line = np.geomspace(count.min(), count.max(), 50)
    law = 0.5 * line * (line - 1.0) * test
    scans = "scanned 27 times (Frederickx & Meerts)"
    top.plot(line, _SCAN * law * _MS, color=_SOURCE, linestyle="--", label=scans)
    top.plot(line, law * _MS, color=style.REFERENCE, label=r"$\frac{1}{2}N(N-1)$ tests, each once")
    style.points(top, count, gases.seconds * _MS, color=style.DATA, label="measured")
    top.set(xscale="log", yscale="log")
    style.label_axes(top, y="time per step (ms)", legend="upper left")
    each = gases.seconds * (_NS / gases.pair_tests)
    style.level(bottom, test * _NS)
    style.points(bottom, count, each, color=style.DATA)
    high = 1.6 * each.value.max()
    style.label_axes(bottom, "number of particles $N$", "time per test (ns)", ylim=(0.0, high))
    style.letters(top, bottom)
    return figure


def box_count(ds: xr.Dataset) -> Figure:
    """Draw time and work against the number of boxes, round widths, and sectors.

    The sectors belong to the event-driven engine.
    """
    figure, axes = style.new((2.3, 2.3), (1.9,), (2.5,))
    scan, near = Table(ds, "scan"), Table(ds, "near")
    _scan_time(axes[0], scan, near)
    _scan_work(axes[1], scan, near)
    axes[1].set(xscale="log", xlabel="number of boxes")
    _round_widths(axes[2], Table(ds, "container"))
    _sectors(axes[3], Table(ds, "sector"))
    style.letters(*axes)
    return figure


def _boxes(per_side: np.ndarray, dimension: int = 3) -> np.ndarray:
    return per_side.astype(float) ** dimension


def _scan_time(axis: Axes, scan: Table, near: Table) -> None:
    boxes, reached = _boxes(scan.boxes_per_side), _boxes(near.near_boxes_per_side)
    parts = scan.particle_seconds.value, scan.test_seconds.value, scan.box_seconds.value
    model = parts[0] + parts[1] * scan.pair_tests + parts[2] * scan.boxes_emptied
    style.points(axis, boxes, scan.seconds * _NS, color=style.DATA, label="measured")
    style.points(axis, reached, near.near_seconds * _NS, kind=1, hollow=True, label="boxes within reach")
    cheap = scan.seconds.value <= 3.0 * scan.seconds.value.min()
    label = "$a + b$ tests $+ c$ boxes"
    axis.plot(boxes[cheap], (model * _NS)[cheap], color=style.REFERENCE, label=label)
    particles = boxes[-1] / scan.boxes_per_particle[-1]
    interval = [scan.ideal_low * particles, scan.ideal_high * particles]
    if np.isfinite(interval[1]):
        axis.axvspan(*interval, color=style.GREY, alpha=0.25, lw=0)
    source = scan.source_boxes_per_particle * particles
    axis.axvline(source, color=_SOURCE, linestyle="--", ymax=0.45, label="number of F & M")
    axis.set(xscale="log", yscale="log")
    style.label_axes(axis, y="time per particle and step (ns)", legend="upper right")


def _scan_work(axis: Axes, scan: Table, near: Table) -> None:
    boxes, reached = _boxes(scan.boxes_per_side), _boxes(near.near_boxes_per_side)
    axis.plot(boxes, scan.expected_tests, color=style.COLOURS[0])
    axis.plot(boxes, scan.expected_visits, color=style.COLOURS[1])
    counted = {
        "pair tests": scan.pair_tests,
        "boxes searched": scan.box_visits,
        "boxes emptied": scan.boxes_emptied,
    }
    handles: list[Any] = [
        style.points(axis, boxes, work, kind=kind, label=label)
        for kind, (label, work) in enumerate(counted.items())
    ]
    look: dict[str, Any] = {"kind": 1, "hollow": True, "label": "searched, within reach"}
    handles.append(style.points(axis, reached, near.near_box_visits, **look))
    colour = style.COLOURS[1]
    handles += axis.plot(boxes, scan.in_reach, color=colour, linestyle="--", label="boxes within reach")
    handles += axis.plot(boxes, scan.touched, color=colour, linestyle=":", label="boxes touched (F & M)")
    axis.set(yscale="log", ylabel="number per particle and step", ylim=(0.01, 1e8))
    axis.legend(handles=handles, loc="upper right")


def _round_widths(axis: Axes, containers: Table) -> None:
    per_side, (first, second) = containers.fine_boxes_per_side[0], containers.container_side
    ratio = containers.fine_seconds[0] / containers.fine_seconds[1]
    positions, is_round = np.arange(per_side.size), np.isin(per_side, containers.round_per_side)
    style.level(axis, 1.0)
    style.points(axis, positions[~is_round], ratio[~is_round], color=style.DATA)
    widths = ", ".join(f"{first / n:g}" for n in containers.round_per_side)
    style.points(axis, positions[is_round], ratio[is_round], kind=1, label=f"boxes of width {widths}")
    axis.set_xticks(positions, [str(int(n)) for n in per_side])
    axis.tick_params(axis="x", top=False)
    style.label_axes(axis, "boxes per side", f"time, side {first:g} / {second:g}", "upper left")


def _sectors(axis: Axes, scan: Table) -> None:
    sectors = _boxes(scan.sector_boxes_per_side, 2)
    style.points(axis, sectors, scan.sector_pair_tests, kind=0, linestyle="-", label="pair tests")
    style.points(axis, sectors, scan.sector_box_visits, kind=1, linestyle="-", label="sectors searched")
    style.points(axis, sectors, scan.sector_crossings, kind=2, linestyle="-", label="crossings")
    look: dict[str, Any] = {"color": style.DATA, "marker": "X", "linestyle": "-", "label": "time (µs)"}
    style.points(axis, sectors, scan.sector_seconds * _US, **look)
    axis.set(xscale="log", yscale="log", xlabel="number of sectors", ylabel="per event (event-driven)")
    axis.set_ylim(top=6e5)
    axis.legend(loc="upper right", ncols=2, columnspacing=0.8)


def ideal_boxes(ds: xr.Dataset) -> Figure:
    """Draw the ideal number of boxes against N, and the time around its minimum."""
    figure, (top, bottom) = style.new((2.8,), (2.8,))
    gases = Table(ds, "gas")
    line = np.geomspace(0.7 * gases.count.min(), 1.5 * gases.count.max(), 50)
    source: dict[str, Any] = {"color": _SOURCE, "alpha": 0.4, "lw": 0}
    top.fill_between(line, 7.0 * line, 10.0 * line, label="F & M: 7 to 10 per particle", **source)
    for kind, radius in enumerate(gases.series_radius):
        own = gases[gases.radius == radius]
        _ideal(top, own, kind, f"ideal, $r = {radius:g}$")
        limit, label = own.most[0] * own.count[0], f"boxes of a diameter, $r = {radius:g}$"
        top.axhline(limit, color=style.COLOURS[kind], linestyle=":", lw=0.8, label=label)
    plateaus = gases.plateau_boxes, gases.plateau_low, gases.plateau_high
    top.hlines(*plateaus, color=_SOURCE, lw=2.0, label="F & M: plateaus")
    top.set(xscale="log", yscale="log", ylim=(2e3, 1e8))
    style.label_axes(top, "number of particles $N$", "ideal number of boxes", "lower right")
    for kind, gas in enumerate(gases[[1, *map(int, gases.source_gas)]]):
        label = f"$N = {_thousands(gas.count)}$, $r = {gas.radius:g}$"
        time = gas.seconds / np.nanmin(gas.seconds.value)
        style.points(bottom, gas.boxes_per_particle, time, kind=kind, linestyle="-", label=label)
    bottom.axvspan(7.0, 10.0, **source)
    bottom.set(xscale="log", ylim=(0.9, 4.5))
    style.label_axes(bottom, "boxes per particle", "time / least time", "upper center")
    style.letters(top, bottom)
    return figure


def _thousands(number: float) -> str:
    """Return an integer with thin spaces, as mathematical text."""
    return f"{int(number):,}".replace(",", r"\,")


def _ideal(axis: Axes, gases: Table, kind: int, label: str) -> None:
    """Draw ideal numbers with 95 % intervals.

    Symbols without an interval are hollow. An arrow marks gases whose time still falls at the finest timed
    partition.
    """
    count, interior = gases.count, gases.ideal_interior.astype(bool)
    ideal, low, high = gases.ideal * count, gases.ideal_low * count, gases.ideal_high * count
    bounded = interior & np.isfinite(high) & (low > 0.0)
    bars = np.where(bounded, [ideal - low, high - ideal], 0.0)
    style.points(axis, count[bounded], ideal[bounded], bars[:, bounded], kind=kind, label=label)
    vague = interior & ~bounded
    style.points(axis, count[vague], ideal[vague], kind=kind, hollow=True)
    rest = ~interior
    style.points(axis, count[rest], ideal[rest], 0.6 * ideal[rest], kind=kind, hollow=True, lolims=True)


def linear_scaling(ds: xr.Dataset) -> Figure:
    """Draw the time of a step by method, and time and work per particle.

    The methods are one box, the cheapest partition, and a neighbour list.
    """
    figure, (top, middle, bottom) = style.new((3.0,), (1.9, 1.7))
    gases, naive, lists = Table(ds, "gas"), Table(ds, "naive"), Table(ds, "listed")
    _extrapolate(top, naive)
    style.points(top, naive.naive_count, naive.naive_seconds, kind=1, label="one box")
    for kind, (radius, own) in enumerate(reversed(list(gases.by("radius")))):
        n, label = own.count, f"cheapest partition, $r = {radius:g}$"
        style.points(top, n, own.seconds * n, kind=2 * kind, label=label)
        style.points(middle, n, own.seconds * _NS, kind=2 * kind, linestyle="-")
        style.points(bottom, n, own.box_visits, kind=2 * kind, linestyle="-")
        style.points(bottom, n, own.pair_tests, kind=2 * kind, linestyle="--", hollow=True)
    for radius, own in reversed(list(lists.by("list_radius"))):
        n, name = own.list_count, None if radius < lists.list_radius.max() else "neighbour list (ours)"
        style.points(top, n, own.list_seconds * n, kind=3, label=name)
        style.points(middle, n, own.list_seconds * _NS, kind=3, linestyle="-")
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


def _extrapolate(axis: Axes, naive: Table) -> None:
    """Draw the extrapolated time of one box for many particles; nothing if it is negative."""
    far, carried = float(naive.extrapolated_count), naive.extrapolated_seconds.value
    line = np.array([naive.naive_count.min(), far])
    lines = (_SCAN, _SOURCE, "one box, 27 scans (F & M)"), (1.0, style.COLOURS[1], None)
    for factor, colour, label in lines if carried > 0.0 else ():
        seconds = factor * carried
        axis.plot(line, seconds * (line / far) ** 2, color=colour, linestyle="--", label=label)
        look: dict[str, Any] = {"textcoords": "offset points", "va": "center", "color": colour}
        axis.annotate(_duration(seconds), (far, seconds), xytext=(4, 0), **look)


def _duration(seconds: float) -> str:
    """Format a time in hours, minutes, seconds or milliseconds."""
    for unit, length in (("h", 3600.0), ("min", 60.0), ("s", 1.0)):
        if seconds >= length:
            return f"{seconds / length:.2g} {unit} a step"
    return f"{seconds * _MS:.2g} ms a step"


def event_scaling(ds: xr.Dataset) -> Figure:
    """Draw pair tests and time per event against N, by search method."""
    figure, (top, bottom) = style.new((2.6,), (2.6,))
    names = {"pairs": "all pairs", "direct": "queue, all particles", "boxes": "queue and sectors"}
    powers = {"pairs": 2.0, "direct": 1.0, "boxes": 0.0}
    runs = Table(ds, "run")
    for kind, method in enumerate(Table(ds, "method")):
        search, dimension = method.method_search, method.method_dimension
        own = runs[(runs.search == search) & (runs.dimension == dimension)]
        hollow, label = dimension == 3, f"{names[search]}, {dimension}D"
        style.points(top, own.count, own.pair_tests, kind=kind, hollow=hollow, label=label)
        style.points(bottom, own.count, own.seconds * _US, kind=kind, hollow=hollow)
        _guide(top, own.count, own.pair_tests, powers[search], kind)
        if search != "boxes":
            _guide(bottom, own.count, own.seconds.value * _US, powers[search], kind)
    for axis, label in ((top, "pair tests per event"), (bottom, "time per event (µs)")):
        axis.set(xscale="log", yscale="log", xlabel="number of particles $N$", ylabel=label)
    top.legend(loc="upper left")
    style.letters(top, bottom)
    return figure


def _guide(axis: Axes, count: np.ndarray, values: np.ndarray, power: float, kind: int) -> None:
    """Draw the expected power law of a search method through the last point."""
    axis.plot(count, values[-1] * (count / count[-1]) ** power, color=style.COLOURS[kind], lw=0.8, zorder=1)
