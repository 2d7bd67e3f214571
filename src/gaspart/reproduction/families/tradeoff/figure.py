"""Figures of the cost of accuracy."""

from __future__ import annotations

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from gaspart.rendering import style
from gaspart.reproduction.families.tradeoff import panels
from gaspart.reproduction.table import Row, Table

SHOWN = {"4 passes": "-", "1 pass, no rewinding": "--"}
"""Line of each setting that is drawn: the default one, and the source's. The claims have the others."""
MARKERS = {"boltzmann": "s", "enskog": "D"}
"""Markers of the models of the DSMC engine."""


def speed_accuracy(ds: xr.Dataset) -> Figure:
    """Draw errors of spheres against the time step, and time against the error of Z.

    The errors are of the collision rate, Z and D.
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
        axes[3].plot([], [], color=style.GREY, marker=marker, ls="none", label=panels.NAMES[model])
    axes[0].legend(loc="lower right")
    axes[1].legend(loc="lower right")
    axes[3].legend(loc="upper right")
    style.letters(*axes)
    return figure


def _of(row: Row, observable: str) -> Row:
    """Return a row restricted to one observable."""
    return Row(row.dataset.sel(observable=observable))


def _errors(axis: Axes, at: Row, kind: int, line: str) -> None:
    """Draw sizes of errors of one observable, and the fitted order.

    They are filled if more than two standard errors, else hollow at that bound.
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
    """Draw time per collision against the size of the error of Z, or its bound.

    The event-driven engine is a line.
    """
    error = 100.0 * np.maximum(np.abs(z.bias.value), 2.0 * z.bias.error)
    timed = np.isfinite(z.seconds.value) & np.isfinite(error)
    look: dict = {"kind": kind, "marker": "o", "linestyle": "-", "linewidth": 0.5}
    style.points(axis, error[timed], 1e6 * z.seconds[timed], **look)
    axis.axhline(1e6 * z.event_seconds, color=style.COLOURS[kind], ls=":")


def _models(axis: Axes, models: Table, kind: int) -> None:
    """Time per collision against the error of the models of the DSMC engine."""
    for model, marker in MARKERS.items():
        own = models[models.dsmc_model == model]
        look: dict = {"kind": kind, "marker": marker, "markersize": 5.0}
        style.points(axis, 100.0 * own.dsmc_bias, 1e6 * own.dsmc_seconds, **look)


def time_to_accuracy(ds: xr.Dataset) -> Figure:
    """Draw the cheapest engine and its cost, and the parts of the errors of each engine.

    The cost is against density and accuracy, for each observable.
    """
    figure, axes = style.new(*((2.0,),) * len(panels.TITLES), (2.4,))
    for axis, letter, (quantity, title) in zip(axes, "abcde", panels.TITLES.items(), strict=False):
        panels.map_of(axis, ds.sel(quantity=quantity))
        style.letter(axis, f"({letter}) {title}")
    panels.draw_breakdown(axes[-1], ds)
    style.letter(axes[-1], "(f) parts of the error")
    figure.legend(
        handles=panels.keys(), loc="outside upper center", ncols=4 if style.width() > style.COLUMN else 2,
        title=f"cheapest engine; time of a run of {ds['count'].values[0]} spheres",
    )  # fmt: skip
    return figure
