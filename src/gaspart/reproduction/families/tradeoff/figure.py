"""Figures of the cost of accuracy."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.colors import to_rgb
from matplotlib.figure import Figure
from matplotlib.patches import Patch

from gaspart.rendering import style
from gaspart.reproduction.families.tradeoff import ENGINES
from gaspart.reproduction.table import Row, Table

# Panels of the map of the cheapest engine, and of errors at two points, for each observable.


TITLES = {
    "collision_rate": "collision rate",
    "Z": "compressibility factor $Z$",
    "D": "diffusion coefficient $D$",
    "heat_flux": "heat flux between plates",
    "relaxation": "relaxation of speeds",
}
NAMES = dict(zip(ENGINES, ("event-driven", "time-stepped", "DSMC, Boltzmann", "DSMC, Enskog"), strict=True))
TINTS = {"event": (0, 0.65), "step": (1, 0.5), "boltzmann": (2, 0.6), "enskog": (2, 0.25)}
"""Colour of each engine, and the fraction of white in it, so that numbers on it are legible."""
PART_NAMES = ("model", "step, cells", "noise", "equilibration", "finite size")
PLACES = (("D", 0.01, 0.01), ("D", 0.3, 0.01))
"""Observable, packing fraction and accuracy of the errors that are drawn; if not measured, the nearest
measured values."""
HIGHEST = 1.6
"""Largest error that is drawn, divided by the accuracy."""
_SMALL = 5.6


def tint(engine: str) -> tuple[float, float, float]:
    """Return the colour of an engine."""
    kind, white = TINTS[engine]
    red, green, blue = (white + (1.0 - white) * part for part in to_rgb(style.COLOURS[kind]))
    return red, green, blue


def keys() -> list[Patch]:
    """Return the entries of a legend of the engines' colours."""
    return [Patch(facecolor=tint(engine), label=name) for engine, name in NAMES.items()]


def duration(seconds: float) -> str:
    """Format a time with one or two digits, in a unit that makes its number short."""
    steps = (("ms", 1.0), ("s", 1e3), ("min", 6e4), ("h", 3.6e6), ("d", 8.64e7), ("y", 3.156e10))
    milliseconds = 1e3 * seconds
    unit, size = max(
        (step for step in steps if step[1] <= max(milliseconds, 1.0) * 1.0001), key=lambda step: step[1]
    )
    value = milliseconds / size
    return f"{float(f'{value:.{1 if value < 9.5 else 2}g}'):g} {unit}"


def cheapest_engine(ds: xr.Dataset) -> Iterator[tuple[int, int, str, float]]:
    """Yield (fraction, accuracy, engine, cost) of one quantity where any engine was measured.

    The first two are indices. If no engine reaches the accuracy, the engine is "" and the cost infinite.
    """
    cost = Row(ds).cost.value  # indices: fraction, accuracy, solver
    for f, a in np.ndindex(*cost.shape[:2]):
        if not np.isnan(cost[f, a]).all():
            best = int(np.nanargmin(cost[f, a]))
            least = float(cost[f, a, best])
            yield f, a, ENGINES[best] if np.isfinite(least) else "", least


def map_of(axis: Axes, ds: xr.Dataset) -> None:
    """Draw one quantity: a field for each density and accuracy, with its cost.

    The colour represents the cheapest engine.
    """
    gas, fields = Row(ds), list(cheapest_engine(ds))
    columns = sorted({f for f, *_ in fields})
    colours = np.ones((len(gas.accuracy), max(1, len(columns)), 3))
    for f, a, engine, seconds in fields:
        x, y = columns.index(f), a
        colours[y, x] = tint(engine) if engine else (1.0, 1.0, 1.0)
        text = duration(seconds) if engine else "–"
        axis.text(x + 0.5, y + 0.5, text, ha="center", va="center", fontsize=_SMALL)
    axis.pcolormesh(
        *map(np.arange, np.add(colours.shape[1::-1], 1)), colours, edgecolor="white", linewidth=0.5
    )
    axis.set_xticks(np.arange(len(columns)) + 0.5, [_fraction(gas.fraction[f]) for f in columns])
    percent = [f"{100.0 * value:g}" for value in gas.accuracy]
    axis.set_yticks(np.arange(len(percent)) + 0.5, percent)
    axis.tick_params(length=0)
    style.label_axes(axis, r"packing fraction $\eta$", "accuracy (%)")


def _fraction(value: float) -> str:
    """Return a packing fraction as text, a small one as a power of ten."""
    return rf"$10^{{{round(math.log10(value))}}}$" if value < 0.005 else f"{value:g}"


def places(ds: xr.Dataset) -> list[Row]:
    """Return the distinct `PLACES`, or the measured values nearest to them."""
    rows: dict[tuple[str, float, float], Row] = {}
    for quantity, fraction, accuracy in PLACES:
        of = ds.sel(quantity=quantity)
        of = of.isel(fraction=np.isfinite(of.cost).any(("accuracy", "solver")).values)
        if of.sizes["fraction"]:
            of = of.isel(fraction=_nearest(of.fraction, fraction))
            at = Row(of.isel(accuracy=_nearest(of.accuracy, accuracy)))
            rows.setdefault((quantity, float(at.fraction), float(at.accuracy)), at)
    return list(rows.values())


def _nearest(values: xr.DataArray, target: float) -> int:
    """Return the index of the value whose ratio to `target` is nearest to 1."""
    return int(np.argmin(np.abs(np.log(values.values / target))))


def draw_breakdown(axis: Axes, ds: xr.Dataset) -> None:
    """Draw errors divided by the required accuracy at the `PLACES`, by engine and cause."""
    rows: list[tuple[float, str]] = []
    for p, at in enumerate(places(ds)):
        top = -(len(ENGINES) + 1.5) * p
        title = rf"${at.quantity}$ to {100 * at.accuracy:g} % at $\eta={at.fraction:g}$"
        axis.text(0.03, top, title, va="center")
        for e, (engine, parts) in enumerate(zip(at.solver, at.error, strict=True)):
            y = top - 1.0 - e
            rows.append((y, NAMES[engine]))
            _stack(axis, y, list(parts / at.accuracy))
    line = axis.axvline(1.0, color="black", linewidth=0.8, label="required")
    patches = [Patch(facecolor=style.COLOURS[kind], label=name) for kind, name in enumerate(PART_NAMES)]
    axis.legend(handles=[*patches, line], loc="center right", fontsize=7)
    axis.set_yticks(*zip(*rows, strict=True) if rows else ([], []))
    axis.set_ylim(rows[-1][0] - 0.7 if rows else -1.0, 0.7)
    axis.set_xticks([0.0, 0.5, 1.0, 1.5])
    axis.set_xlim(0.0, 2.4 * HIGHEST)  # with space for the legend
    axis.tick_params(axis="y", length=0)
    axis.set_xlabel("error / required accuracy")


def _stack(axis: Axes, y: float, parts: list[float]) -> None:
    """Draw a stacked bar of parts, truncated at `HIGHEST`.

    A truncated bar is labelled with its length.
    """
    low = 0.0
    for kind, part in enumerate(parts):
        if math.isfinite(part) and low < HIGHEST:
            end = min(low + part, HIGHEST)
            axis.barh(y, end - low, left=low, color=style.COLOURS[kind], height=0.8)
            low = end
    total = float(np.nansum(parts))
    if total > HIGHEST:
        axis.text(HIGHEST + 0.04, y, f"{float(f'{total:.2g}'):g}", ha="left", va="center", fontsize=6.5)


SHOWN = {"4 passes": "-", "1 pass, no rewinding": "--"}
"""Line style of each setting that is drawn: the default, and the source's setting. The claims also cover the
other settings."""
MARKERS = {"boltzmann": "s", "enskog": "D"}
"""Markers of the DSMC engine's models."""


def speed_accuracy(ds: xr.Dataset) -> Figure:
    """Draw errors for spheres against the time step, and time against the error of Z.

    The errors are of collision rate, Z and D.
    """
    figure, axes = style.new((2.3,), (2.3,), (2.3,), (2.3,))
    errors, models = Table(ds, "row"), Table(ds, "dsmc")
    models = models[models.dsmc_dimension == 3]
    titles = {"collision_rate": "collision rate", "Z": "$Z$", "D": "$D$"}
    spheres = errors[errors.dimension == 3]
    for kind, (fraction, gas) in enumerate(spheres.by("packing_fraction")):
        for setting, line in SHOWN.items():
            for row in gas[gas.setting == setting][:1]:
                for axis, observable in zip(axes, titles, strict=False):
                    _errors(axis, _of(row, observable), kind, line)
                if setting == "4 passes":
                    _costs(axes[3], _of(row, "Z"), kind)
        _models(axes[3], models[models.dsmc_packing_fraction == fraction], kind)
        axes[1].plot([], [], color=style.COLOURS[kind], lw=3.0, label=rf"$\eta={fraction:g}$")
    for axis, (observable, title) in zip(axes, titles.items(), strict=False):
        axis.set(xscale="log", yscale="log", xlabel=r"time step $\Delta t\,v_\mathrm{th}/\sigma$")
        axis.set(ylabel=f"error of {title} (%)", ylim=(1e-4 if observable != "D" else 1e-2, 100.0))
    axes[3].set(xscale="log", yscale="log", xlabel="error of $Z$ (%)", ylabel=r"time per collision (µs)")
    for name, line in SHOWN.items():
        axes[0].plot([], [], color=style.GREY, ls=line, label=name)
    axes[0].plot(
        [], [], marker="o", ls="none", markerfacecolor="white", markeredgecolor=style.GREY,
        label="no error resolved: bound",
    )  # fmt: skip
    axes[3].plot([], [], color=style.GREY, ls=":", label="event-driven, no error")
    axes[3].plot([], [], color=style.GREY, marker="o", lw=0.5, label="time-stepped")
    for model, marker in MARKERS.items():
        axes[3].plot([], [], color=style.GREY, marker=marker, ls="none", label=NAMES[model])
    axes[0].legend(loc="lower right")
    axes[1].legend(loc="lower right")
    axes[3].legend(loc="upper right")
    style.letters(*axes)
    return figure


def _of(row: Row, observable: str) -> Row:
    """Return a row restricted to one observable."""
    return Row(row.dataset.sel(observable=observable))


def _errors(axis: Axes, at: Row, kind: int, line: str) -> None:
    """Draw the absolute errors of one observable, and the fitted order.

    An error above two standard errors is drawn filled, otherwise hollow at this bound.
    """
    size, error, step = 100.0 * np.abs(at.bias.value), 100.0 * at.bias.error, at.time_step
    seen = size > 2.0 * error
    style.points(axis, step[seen], size[seen], error[seen], kind=kind, marker="o")
    unseen = ~seen & np.isfinite(size)
    style.points(axis, step[unseen], 2.0 * error[unseen], kind=kind, marker="o", hollow=True, alpha=0.5)
    if np.isfinite(at.order.value) and seen.any():
        x = step[seen]
        y = np.exp(np.log(size[seen]).mean() + at.order.value * (np.log(x) - np.log(x).mean()))
        axis.plot(x, y, color=style.COLOURS[kind], ls=line, lw=0.7)


def _costs(axis: Axes, z: Row, kind: int) -> None:
    """Draw the time per collision against the absolute error of Z, or its bound.

    The event-driven engine is a line.
    """
    error = 100.0 * np.maximum(np.abs(z.bias.value), 2.0 * z.bias.error)
    timed = np.isfinite(z.seconds.value) & np.isfinite(error)
    look: dict = {"kind": kind, "marker": "o", "linestyle": "-", "linewidth": 0.5}
    style.points(axis, error[timed], 1e6 * z.seconds[timed], **look)
    axis.axhline(1e6 * z.event_seconds, color=style.COLOURS[kind], ls=":")


def _models(axis: Axes, models: Table, kind: int) -> None:
    """Draw time per collision against the error of the DSMC engine's models."""
    for model, marker in MARKERS.items():
        own = models[models.dsmc_model == model]
        look: dict = {"kind": kind, "marker": marker, "markersize": 5.0}
        style.points(axis, 100.0 * own.dsmc_bias, 1e6 * own.dsmc_seconds, **look)


def time_to_accuracy(ds: xr.Dataset) -> Figure:
    """Draw the cheapest engine and its cost, and the parts of the errors of each engine.

    The cost is drawn against density and accuracy, for each observable.
    """
    figure, axes = style.new(*((2.0,),) * len(TITLES), (2.4,))
    for axis, letter, (quantity, title) in zip(axes, "abcde", TITLES.items(), strict=False):
        map_of(axis, ds.sel(quantity=quantity))
        style.letter(axis, f"({letter}) {title}")
    draw_breakdown(axes[-1], ds)
    style.letter(axes[-1], "(f) parts of the error")
    figure.legend(
        handles=keys(), loc="outside upper center", ncols=4 if style.width() > style.COLUMN else 2,
        title=f"cheapest engine; time of a run of {ds['count'].values[0]} spheres",
    )  # fmt: skip
    return figure
