"""Figures of the cost of accuracy."""

from __future__ import annotations

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from gaspart.rendering import style
from gaspart.reproduction.families.shared.rows import estimates
from gaspart.reproduction.families.tradeoff import panels

SHOWN = {"4 passes": "-", "1 pass, no rewinding": "--"}
"""Line of each setting that is drawn: the default one, and the source's. The claims have the others."""
MARKERS = {"boltzmann": "s", "enskog": "D"}
"""Of the models of the DSMC engine."""


def speed_accuracy(ds: xr.Dataset) -> Figure:
    """Errors of the collision rate, Z and D of spheres against the time step; time against the error of Z."""
    figure, axes = style.new((2.3,), (2.3,), (2.3,), (2.3,))
    spheres = ds.isel(row=(ds.dimension == 3).values)
    fractions = sorted(set(spheres.packing_fraction.values))
    titles = {"collision_rate": "collision rate", "Z": "$Z$", "D": "$D$"}
    for kind, fraction in enumerate(fractions):
        rows = spheres.isel(row=(spheres.packing_fraction == fraction).values)
        for setting, line in SHOWN.items():
            chosen = rows.isel(row=(rows.setting == setting).values)
            if not chosen.sizes["row"]:
                continue
            row = chosen.isel(row=0)
            for axis, observable in zip(axes, titles, strict=False):
                _errors(axis, row.sel(observable=observable), kind, line)
            if setting == "4 passes":
                _costs(axes[3], row, kind)
        same = (ds.dsmc_dimension == 3) & (ds.dsmc_packing_fraction == fraction)
        _models(axes[3], ds.isel(dsmc=same.values), kind)
        axes[1].plot([], [], color=style.COLOURS[kind], lw=3.0, label=rf"$\eta={fraction:g}$")
    for axis, (observable, title) in zip(axes, titles.items(), strict=False):
        axis.set(xscale="log", yscale="log", xlabel=r"time step $\Delta t\,v_\mathrm{th}/\sigma$")
        axis.set(ylabel=f"error of {title} (%)", ylim=(1e-4 if observable != "D" else 1e-2, 100.0))
    axes[3].set(xscale="log", yscale="log", xlabel="error of $Z$ (%)", ylabel=r"time per collision (µs)")
    for name, line in SHOWN.items():
        axes[0].plot([], [], color=style.GREY, ls=line, label=name)
    axes[0].plot(
        [], [], marker="o", ls="none", markerfacecolor="white", markeredgecolor=style.GREY,
        label="no error seen: bound",
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


def _errors(axis: Axes, at: xr.Dataset, kind: int, line: str) -> None:
    """Sizes of errors of one observable, filled if more than two standard errors, else hollow at that bound;
    and the fitted order."""
    size, error = 100.0 * np.abs(at.bias.values), 100.0 * at.bias_error.values
    step, seen = at.time_step.values, size > 2.0 * error
    style.points(axis, step[seen], size[seen], error[seen], kind=kind, marker="o")
    unseen = ~seen & np.isfinite(size)
    style.points(axis, step[unseen], 2.0 * error[unseen], kind=kind, marker="o", hollow=True, alpha=0.5)
    if np.isfinite(at.order) and seen.any():
        x = step[seen]
        y = np.exp(np.log(size[seen]).mean() + float(at.order) * (np.log(x) - np.log(x).mean()))
        axis.plot(x, y, color=style.COLOURS[kind], ls=line, lw=0.7)


def _costs(axis: Axes, row: xr.Dataset, kind: int) -> None:
    """Time per collision against the size of the error, or its bound; the event-driven engine as a line."""
    z = row.sel(observable="Z")
    error = 100.0 * np.maximum(np.abs(z.bias), 2.0 * z.bias_error).values
    timed = np.isfinite(row.seconds.values) & np.isfinite(error)
    seconds = 1e6 * estimates(row, "seconds")[:, timed]
    style.measured(axis, error[timed], seconds, kind=kind, marker="o", linestyle="-", linewidth=0.5)
    axis.axhline(1e6 * float(row.event_seconds), color=style.COLOURS[kind], ls=":")


def _models(axis: Axes, ds: xr.Dataset, kind: int) -> None:
    """Time per collision against the error of the models of the DSMC engine."""
    for model, marker in MARKERS.items():
        of = ds.isel(dsmc=(ds.dsmc_model == model).values)
        seconds = 1e6 * estimates(of, "dsmc_seconds")
        style.measured(axis, 100.0 * of.dsmc_bias, seconds, kind=kind, marker=marker, markersize=5.0)


def time_to_accuracy(ds: xr.Dataset) -> Figure:
    """The cheapest engine and its cost against density and accuracy, for each observable; and what makes the
    errors of each engine."""
    figure, axes = style.new(*((2.0,),) * len(panels.TITLES), (2.4,))
    for axis, letter, (quantity, title) in zip(axes, "abcde", panels.TITLES.items(), strict=False):
        panels.map_of(axis, ds.sel(quantity=quantity))
        style.letter(axis, f"({letter}) {title}")
    panels.breakdown(axes[-1], ds)
    style.letter(axes[-1], "(f) what makes the error")
    figure.legend(
        handles=panels.keys(), loc="outside upper center", ncols=4 if style.width() > style.COLUMN else 2,
        title=f"cheapest engine; time of a run of {int(ds['count'][0])} spheres",
    )  # fmt: skip
    return figure
