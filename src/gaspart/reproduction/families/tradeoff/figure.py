"""Figures of the cost of accuracy."""

from __future__ import annotations

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from gaspart.rendering import style
from gaspart.reproduction.families.shared.rows import estimates

SHOWN = {"4 passes": "-", "1 pass, no rewinding": "--"}
"""Line of each setting that is drawn: the default one, and the source's. The claims have the others."""


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
                _costs(axes[3], row, kind, rf"$\eta={fraction:g}$")
    for axis, (observable, title) in zip(axes, titles.items(), strict=False):
        axis.set(xscale="log", yscale="log", xlabel=r"time step $\Delta t\,v_\mathrm{th}/\sigma$")
        axis.set(ylabel=f"error of {title} (%)", ylim=(1e-4 if observable != "D" else 1e-2, 100.0))
    axes[3].set(xscale="log", yscale="log", xlabel="error of $Z$ (%)", ylabel=r"time per collision (µs)")
    for name, line in SHOWN.items():
        axes[0].plot([], [], color=style.GREY, ls=line, label=name)
    axes[3].plot([], [], color=style.GREY, ls=":", label="event-driven")
    axes[0].legend(loc="lower right")
    axes[3].legend(loc="upper right")
    style.letters(*axes)
    return figure


def _errors(axis: Axes, at: xr.Dataset, kind: int, line: str) -> None:
    """Sizes of errors of one observable, filled if more than two standard errors, else hollow at that bound;
    and the fitted order."""
    size, error = 100.0 * np.abs(at.bias.values), 100.0 * at.bias_error.values
    step, seen = at.time_step.values, size > 2.0 * error
    style.points(axis, step[seen], size[seen], error[seen], kind=kind)
    unseen = ~seen & np.isfinite(size)
    style.points(axis, step[unseen], 2.0 * error[unseen], kind=kind, hollow=True, alpha=0.5)
    if np.isfinite(at.order) and seen.any():
        x = step[seen]
        y = np.exp(np.log(size[seen]).mean() + float(at.order) * (np.log(x) - np.log(x).mean()))
        axis.plot(x, y, color=style.COLOURS[kind], ls=line, lw=0.7)


def _costs(axis: Axes, row: xr.Dataset, kind: int, label: str) -> None:
    """Time per collision against the size of the error, or its bound; the event-driven engine as a line."""
    z = row.sel(observable="Z")
    error = 100.0 * np.maximum(np.abs(z.bias), 2.0 * z.bias_error).values
    timed = np.isfinite(row.seconds.values) & np.isfinite(error)
    seconds = 1e6 * estimates(row, "seconds")[:, timed]
    style.measured(axis, error[timed], seconds, kind=kind, linestyle="-", linewidth=0.5, label=label)
    axis.axhline(1e6 * float(row.event_seconds), color=style.COLOURS[kind], ls=":")


def time_to_accuracy(ds: xr.Dataset) -> Figure:
    """Cost against accuracy of Z and of D by engine, measured and by the model, for each gas."""
    figure, axes = style.new(*((2.3, 2.3),) * ds.sizes["gas"])
    for g in range(ds.sizes["gas"]):
        gas, panels = ds.isel(gas=g), axes[2 * g : 2 * g + 2]
        for axis, observable in zip(panels, ("Z", "D"), strict=True):
            _times(axis, gas.sel(observable=observable))
            axis.set_ylabel(f"time for ${observable}$ (s)")
        panels[1].set_xlabel("required accuracy (%)")
        style.letter(panels[0], rf"({'abcd'[g]}) spheres, $\eta = {float(gas.gas_packing_fraction):g}$")
    axes[0].legend(loc="upper right")
    return figure


def _times(axis: Axes, gas: xr.Dataset) -> None:
    """Points measured, lines of the model; hollow and dashed for the larger number of particles."""
    axis.set(xscale="log", yscale="log")
    names = {"event": "event-driven", "step": "time-stepped"}
    for kind, engine in enumerate(gas.engine.values):
        for n, count in enumerate(gas["count"].values):
            at = gas.sel(engine=engine, count=count)
            style.points(
                axis,
                100 * gas.accuracy,
                at.measured,
                kind=kind,
                hollow=n > 0,
                label=f"{names[str(engine)]}, $N = {count}$",
            )
            axis.plot(100 * gas.accuracy, at.model, color=style.COLOURS[kind], ls="--" if n else "-", lw=0.8)
