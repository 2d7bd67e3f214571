"""Figures of the cost of features, and the gain from several cores."""

from __future__ import annotations

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from gaspart.rendering import style
from gaspart.reproduction.families.cost.claims import LARGEST_RATIO
from gaspart.reproduction.families.shared.timings import SLABS, speed_up
from gaspart.reproduction.table import Row, Table

WORK = {"pair_tests": "pair tests", "crossings": "crossings"}


def price_of_features(ds: xr.Dataset) -> Figure:
    """Draw relative time and counted operations per event, for each feature.

    Times are divided by the times of the scene without the feature.
    """
    figure, (times, counts) = style.new((2.9,), (2.9,))
    timed = Table(ds, "point")
    positions = {name: -k for k, name in enumerate(dict.fromkeys(timed.feature))}
    times.axvline(1.0, color=style.GREY, linewidth=0.6, zorder=1)
    times.axvspan(0.0, LARGEST_RATIO, color=style.GREY, alpha=0.18, linewidth=0, zorder=0)
    for kind, (engine, costs) in enumerate(timed.by("engine")):
        rows = np.array([positions[name] for name in costs.feature]) + 0.12 * (0.5 - kind)
        plain = costs[costs.feature == "plain"].seconds[0]
        style.points(times, costs.ratio, rows, kind=kind, label=f"{engine}: plain {1e6 * plain:.3g} µs")
        for hollow, (name, label) in enumerate(WORK.items()):
            work = getattr(costs, name)
            if work.any():
                style.points(counts, work, rows, kind=kind, hollow=bool(hollow), label=f"{engine}: {label}")
    for axis in (times, counts):
        axis.set_yticks(list(positions.values()), positions)
        axis.set_ylim(-len(positions) + 0.4, 1.6)
        axis.tick_params(axis="y", which="both", length=0)
        axis.legend(loc="upper right", ncols=2 if axis is counts else 1)
    most = (timed.ratio.value + timed.ratio.error).max()
    labels = "time per event / without the feature", "counted work per event"
    style.label_axes(times, labels[0], xlim=(0.0, max(1.6, 1.1 * most)))
    style.label_axes(counts, labels[1], xscale="log")
    style.letters(times, counts)
    return figure


_PANELS = {"DSMC": "DSMC", "time-stepped": "time-stepped", "event-driven": "event-driven"}
_MOST = 8  # largest number of cores for which the model is drawn
_LABEL = "speed-up"


def cores(dataset: xr.Dataset) -> Figure:
    """Draw speed on several cores against the numbers of particles and cores, with the model.

    The first panels are for two cores: threads of one run, and simultaneous runs. In the last panel the axis
    is the number of cores.
    """
    figure, axes = style.new((2.6,), (2.6,), (2.6,), (2.6,))
    runs, models = Table.from_prefixed(dataset, "run"), Table.from_prefixed(dataset, "model")
    fractions = sorted(set(runs.packing_fraction.tolist()))
    two = runs[runs.cores == 2]
    for axis, (name, short) in zip(axes, _PANELS.items(), strict=False):
        own = two[[str(engine).startswith(name) for engine in two.engine]]
        _by_count(axis, own.sorted_by("count"), models, fractions)
        highest = np.nanmax([2.36, *own.speed.value])
        axis.set(xscale="log", xlim=(0.6 * runs.count.min(), 1.6 * runs.count.max()))
        axis.set_ylim(0.0, 1.1 * highest)
        style.label_axes(axis, "number of particles $N$", f"{short}: {_LABEL}", legend="lower right")
    _by_cores(axes[-1], runs, models, dataset.cores)
    style.letters(*axes)
    return figure


def _by_count(axis: Axes, runs: Table, models: Table, fractions: list[float]) -> None:
    """Draw the runs of an engine against the number of particles, coloured by packing fraction."""
    named: set[str] = set()  # each label occurs once in the legend
    for engine, fraction, copies, gas in runs.by("engine", "packing_fraction", "copies"):
        kind = fractions.index(fraction)
        label = ", ".join([*engine.split(", ")[1:], f"$\\eta={fraction:g}$"])
        if copies > 1:
            label = "two runs at once" if engine != "event-driven" else f"{label}, two runs"
        style.points(axis, gas.count, gas.speed, kind=kind, hollow=copies > 1, label=_once(label, named))
        if copies == 1:
            count = np.geomspace(max(gas.count.min(), SLABS.get(engine, 0)), gas.count.max(), 100)
            speed = _model_speed(models, gas[0], 2.0, count)
            if np.isfinite(speed).all():
                axis.plot(count, speed, color=style.COLOURS[kind], linewidth=0.8, label=_once("model", named))
    style.level(axis, 1.0)
    style.level(axis, 2.0, linestyle="--")
    if not np.isfinite(runs.speed.value).any():
        axis.text(0.5, 0.6, "fewer than two cores: not timed", transform=axis.transAxes, ha="center")


def _by_cores(axis: Axes, runs: Table, models: Table, available: int) -> None:
    """Draw the gases that run on the most cores, and the model of threads.

    Lines are dotted where they exceed the number of cores of the machine.
    """
    fine = np.linspace(1.0, _MOST, 100)
    axis.plot(fine, fine, "--", color=style.GREY, linewidth=0.6, label="ideal")
    for kind, widest in enumerate(runs[runs.cores == runs.cores.max()].sorted_by("copies")):
        at_once = widest.copies > 1
        columns = ("engine", "packing_fraction", "count")
        alike = [getattr(runs, name) == widest[name] for name in columns]
        gas = runs[np.all([*alike, (runs.copies > 1) == at_once], axis=0)]
        label = f"{widest.engine}, {'runs at once' if at_once else 'threads'}"
        style.points(axis, gas.cores, gas.speed, kind=kind, hollow=at_once, label=label)
        if not at_once and widest.engine not in SLABS:
            for part, dashes in ((fine <= available, "-"), (fine >= available, ":")):
                speed = _model_speed(models, widest, fine[part], widest.count)
                axis.plot(fine[part], speed, dashes, color=style.COLOURS[kind], linewidth=0.8)
    cores = f"cores (dotted: beyond the {available} of this machine)"
    style.label_axes(
        axis, cores, _LABEL, legend="upper left", xlim=(0.8, _MOST + 0.2), ylim=(0.0, _MOST + 0.5)
    )


def _once(label: str, named: set[str]) -> str:
    """Return a label at its first use, then ""."""
    new = label not in named
    named.add(label)
    return label if new else ""


def _model_speed(models: Table, run: Row, cores: float | np.ndarray, count: float | np.ndarray) -> np.ndarray:
    """Compute the model's speed for the gas and engine of a run.

    The arguments are the numbers of cores and of particles.
    """
    same = (models.engine == run.engine) & (models.packing_fraction == run.packing_fraction)
    model = models[same][0]
    return speed_up(cores, count, model.serial.value, model.overhead.value)
