"""Figures of the cost of accuracy."""

from __future__ import annotations

from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from gaspart.rendering import style

SETTINGS = ("4 passes", "4 passes, float32", "1 pass", "1 pass, no rewinding")


def speed_accuracy(ds: xr.Dataset) -> Figure:
    """Errors of the collision rate and of Z against the time step, and time against the error of Z."""
    fractions = sorted(set(ds.packing_fraction.values[ds.dimension.values == 3]))
    figure, axes = style.new(rows=3, columns=len(fractions), height=7.2, share_x=False)
    axes = np.reshape(axes, (3, len(fractions)))
    for column, fraction in zip(axes.T, fractions, strict=True):
        rows = [ds.isel(row=n) for n in np.flatnonzero(ds.packing_fraction.values == fraction)]
        for axis, observable in zip(column, ("collision_rate", "Z"), strict=False):
            _errors(axis, rows, observable)
        _costs(column[2], rows)
        column[0].set_title(rf"$\eta = {fraction:g}$")
        column[1].set_xlabel(r"time step $\Delta t\,v_\mathrm{th}/\sigma$")
        column[2].set_xlabel("error of $Z$ (%)")
    axes[0, 0].set_ylabel("error of collision rate (%)")
    axes[1, 0].set_ylabel("error of $Z$ (%)")
    axes[2, 0].set_ylabel(r"time per collision ($\mu$s)")
    handles, labels = axes[0, 0].get_legend_handles_labels()
    handles += axes[2, 0].get_legend_handles_labels()[0][-1:]
    figure.legend(handles, [*labels, "event-driven"], loc="outside upper center", ncols=3)
    style.letters(*axes[:, 0])
    return figure


def _errors(axis: Axes, rows: list[xr.Dataset], observable: str) -> None:
    """Sizes of errors: filled if more than two standard errors, else hollow at that bound."""
    axis.set(xscale="log", yscale="log")
    for row in sorted(rows, key=lambda row: (-int(row.dimension), _kind(row))):
        flat = int(row.dimension) == 2
        at = row.sel(observable=observable)
        size, error = 100.0 * np.abs(at.bias.values), 100.0 * at.bias_error.values
        seen = size > 2.0 * error
        options = {"color": style.GREY, "marker": "P"} if flat else {"kind": _kind(row)}
        label = "discs, 4 passes" if flat else str(row.setting.values)
        style.points(axis, row.time_step.values[seen], size[seen], error[seen], label=label, **options)
        unseen = ~seen & np.isfinite(size)
        style.points(
            axis, row.time_step.values[unseen], 2.0 * error[unseen], hollow=True, alpha=0.5, **options
        )
        if not flat and str(row.setting.values) == "4 passes":
            axis.fill_between(
                row.time_step.values, 1e-4, np.maximum(error, 1e-4), color=style.GREY, alpha=0.18, lw=0
            )
        if np.isfinite(at.order) and seen.any():
            x = row.time_step.values[seen]
            y = np.exp(np.log(size[seen]).mean() + float(at.order) * (np.log(x) - np.log(x).mean()))
            axis.plot(x, y, color=options.get("color", style.COLOURS[_kind(row)]), lw=0.7)
    axis.set_ylim(1e-4, 100.0)


def _costs(axis: Axes, rows: list[xr.Dataset]) -> None:
    """Time per collision against the size of the error, or its bound; the event-driven engine as a line."""
    axis.set(xscale="log", yscale="log")
    for row in rows:
        if int(row.dimension) == 2:
            continue
        z = row.sel(observable="Z")
        error = 100.0 * np.maximum(np.abs(z.bias), 2.0 * z.bias_error).values
        timed = np.isfinite(row.seconds.values) & np.isfinite(error)
        options: dict[str, Any] = {"kind": _kind(row), "linestyle": "-", "linewidth": 0.5}
        style.points(
            axis,
            error[timed],
            1e6 * row.seconds.values[timed],
            1e6 * row.seconds_error.values[timed],
            **options,
        )
        event = 1e6 * float(row.event_seconds)
    axis.axhline(event, color=style.DATA, ls="--", label="event-driven")
    axis.set_xlim(1e-4, 100.0)


def _kind(row: xr.Dataset) -> int:
    return SETTINGS.index(str(row.setting.values))


def time_to_accuracy(ds: xr.Dataset) -> Figure:
    """Cost against accuracy by engine, measured and predicted; and the excess cost of the model's choice."""
    figure, axes = style.new(rows=3, columns=max(2, ds.sizes["gas"]), height=6.6, height_ratios=(2, 2, 1))
    for column, g in zip(axes.T, range(ds.sizes["gas"]), strict=False):
        gas = ds.isel(gas=g)
        for axis, observable in zip(column, ("Z", "D"), strict=False):
            _times(axis, gas.sel(observable=observable))
        for kind, observable in enumerate(("Z", "D")):
            for count, hollow in zip(ds["count"].values, (False, True), strict=False):
                at = gas.sel(observable=observable, count=count)
                style.points(
                    column[2], 100 * ds.accuracy, at.regret, at.regret_error, kind=2 + kind, hollow=hollow
                )
        column[2].axhline(1.5, color=style.GREY, ls=":")
        column[2].set(ylim=(0.8, 2.0), xlabel="accuracy (%)")
        column[0].set_title(rf"spheres, $\eta = {float(gas.gas_packing_fraction):g}$")
    for axis in axes.T[ds.sizes["gas"] :].flat:
        axis.set_visible(False)
    for axis, label in zip(
        axes[:, 0], ("time for $Z$ (s)", "time for $D$ (s)", "choice / best"), strict=True
    ):
        axis.set_ylabel(label)
    axes[0, 0].legend(fontsize=6.5)
    return figure


def _times(axis: Axes, gas: xr.Dataset) -> None:
    """Points measured, lines of the model; hollow and dashed for the larger number of bodies."""
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
