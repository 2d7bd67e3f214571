"""Errors and costs of time stepping relative to event-driven runs, and of the models of DSMC."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
import xarray as xr

from gaspart import theory
from gaspart.accuracy.tabulated import model_error
from gaspart.analysis.estimate import Estimate
from gaspart.analysis.statistics import fit_power_law
from gaspart.keys import names, positive
from gaspart.rendering import style
from gaspart.rendering.style import Axes, Figure
from gaspart.reproduction.claims import Claim
from gaspart.reproduction.figure import PARTICLES, Parts, pressure
from gaspart.reproduction.figures._tradeoff import (
    NAMES,
    OBSERVABLES,
    Cells,
    Timing,
    Timings,
    cells_by_fraction,
    compare_steps,
    setting_name,
)
from gaspart.reproduction.points.point import Point
from gaspart.reproduction.table import Row, Table, from_rows, table
from gaspart.theory.discretisation import MISSED_CONTACTS, ONE_PASS

TITLE, CHAPTER = "Speed against accuracy", "Speed and accuracy"
SETTINGS = {
    "order_up_to": positive("largest relative error that the fits of the order use"),
    "cells": names("experiments of the Enskog model in its default cells"),
}
SEEN = 3.5  # smallest significant error, in standard errors of a normal distribution
FITTED = 3  # errors in a fit of their order: two always have one, even if the error changes its sign


def measure(points: list[Point], settings: dict) -> xr.Dataset:
    """Measure errors over the time steps of each gas and setting, and costs per contact of the exact gas.
    Long runs of the time-stepped engine have the error in the steady state. `order` is that of the error in
    the time step. `dsmc_bias` is a bound on the bias of Z of the models of DSMC.
    """
    timed = Timings(points)
    rows = compare_steps(points, timed)
    rows = sorted(rows, key=lambda row: (-row["dimension"], row["packing_fraction"]))
    inner = {name: ("observable", "step")[2 - np.ndim(value) :] for name, value in rows[0].items()}
    dataset = from_rows("row", rows, inner).assign_coords(observable=list(OBSERVABLES))
    orders = np.array([error_orders(row, settings["order_up_to"]) for row in rows])
    for n, name in enumerate(("order", "order_error", "order_freedom")):
        dataset[name] = (("row", "observable"), orders[..., n])
    long = [
        point for point in points if point.job == "simulate" and point.experiment not in settings["cells"]
    ]
    events = [timing for timing in timed if timing.setting == "event"]
    models = _models(timed, cells_by_fraction(points, settings["cells"]))
    steps = dict.fromkeys(("dsmc_step", "dsmc_step_seconds"), ("part",))
    for part in (
        table("steady", long, _steady, rows),
        table("timed", events, _time_per_collision),
        from_rows("dsmc", models, steps),
    ):
        dataset = dataset.assign(part)
    return dataset


def error_orders(row: dict, largest: float) -> list[tuple[float, float, float]]:
    """Fit the order of each observable's error in the time step; its error is scaled by the scatter, and has
    the degrees of freedom of the errors. The order is NaN without `FITTED` errors of equal sign.
    """
    orders = []
    for bias, error, freedom in zip(row["bias"], row["bias_error"], row["bias_freedom"], strict=True):
        size = np.abs(bias)
        seen = (Estimate(size, error, freedom).deviation > SEEN) & (size < largest)
        if seen.sum() < FITTED or np.unique(np.sign(bias[seen])).size > 1:
            orders.append((np.nan, np.nan, np.nan))
            continue
        law = fit_power_law(row["time_step"][seen], size[seen], error[seen])
        scatter = max(1.0, law.chi_square / max(1, law.degrees_of_freedom)) ** 0.5
        orders.append((law.exponent, law.exponent_error * scatter, float(freedom[0])))
    return orders


def _steady(point: Point, rows: list[dict]) -> dict[str, Any]:
    """Return the error of Z in a long run, minus that of the paired runs of the same gas."""
    own = point.settings
    long, fraction, dimension = pressure(point).z, own["packing_fraction"], own["dimension"]
    gas = (dimension, fraction, setting_name(own))
    row = next(row for row in rows if (row["dimension"], row["packing_fraction"], row["setting"]) == gas)
    at = OBSERVABLES.index("Z"), int(np.argmin(np.abs(row["time_step"] - own["time_step"])))
    exact = float(theory.compressibility_factor(fraction, dimension))
    exact += float(theory.finite_size_correction(fraction, dimension, point.extents[0], ensemble="canonical"))
    return {
        "steady_dimension": dimension,
        "steady_packing_fraction": fraction,
        "steady_setting": gas[2],
        "steady_step": own["time_step"],
        "build_up": long / exact - (1.0 + Estimate(row["bias"][at], row["bias_error"][at])),
    }


def _time_per_collision(event: Timing) -> dict[str, Any]:
    each = event.seconds[0] / event.contacts
    return {
        "timed_dimension": event.gas[0],
        "timed_packing_fraction": event.gas[1],
        "timed_seconds": each.value,
        "timed_error": each.error,
    }


def _models(timed: Timings, cells: dict[float, Cells]) -> list[dict[str, Any]]:
    """Return the cost of each DSMC model, with its cheapest step, and its error of Z, in each gas. Z does not
    depend on the step. For the Enskog model, the error due to cells must have been measured, in spheres.
    """
    rows = []
    for event in (timing for timing in timed if timing.setting == "event"):
        dimension, fraction = event.gas
        own_cells = cells.get(fraction) if dimension == 3 else None
        for timing in timed.of(*event.gas):
            model = timing.setting
            if model != "boltzmann" and not (model == "enskog" and own_cells):
                continue
            seconds = timing.seconds / event.contacts
            cheapest = seconds[np.argmin(seconds.value)]
            of_cells = own_cells.error if own_cells and model == "enskog" else 0.0
            rows.append(
                {
                    "dsmc_model": model,
                    "dsmc_dimension": dimension,
                    "dsmc_packing_fraction": fraction,
                    "dsmc_seconds": cheapest.value,
                    "dsmc_seconds_error": cheapest.error,
                    "dsmc_step": timing.step_parts,
                    "dsmc_step_seconds": seconds.value,
                    "dsmc_step_seconds_error": seconds.error,
                    "dsmc_bias": model_error(fraction, dimension, model, "Z") + of_cells,
                }
            )
    return rows


# Half width of the interval around an order, and largest uncertainty of a measured order that is conclusive.
BAND, REQUIRED = {1.0: 0.15, 2.0: 0.3, 3.0: 0.6}, {1.0: 0.1, 2.0: 0.2, 3.0: 0.4}
FLOOR = 1e-3  # largest uncertainty of an error in the steady state


def claims(dataset: xr.Dataset) -> Iterator[Claim]:
    """Yield the claims on error orders, contacts missed in a dilute gas, and the steady state."""
    errors = Table(dataset, "row")
    for row in errors:
        if row.setting != "4 passes, float32":
            yield from _orders(row)
    for row in errors[errors.packing_fraction <= 0.01]:
        if row.setting not in ("4 passes", "1 pass"):
            continue
        factor = MISSED_CONTACTS[row.dimension] * (1.0 if row.setting == "4 passes" else ONE_PASS)
        lost = factor * row.time_step**2  # in units with v_th = sigma = 1
        at = int(np.argmax(np.where(lost <= 0.02, lost, -1.0)))  # the longest step that loses at most 2 %
        yield Claim(
            f"collisions lost to steps of {row.time_step[at]:g}, {row.setting}, "
            f"{_gas(row.dimension, row.packing_fraction)}", -_of(row, "collision_rate").bias[at], lost[at],
            0.1 * lost[at], "flux of pairs through chords crossed within a step (docs/time-stepped.md)",
            "contacts that touch and part within a step are found, or others are not",
        )  # fmt: skip
    for at in Table(dataset, "steady"):
        setting = at.steady_setting
        # A single pass leaves pairs that overlap. In the steady state there are more of these pairs.
        builds_up = "what one pass leaves builds up; advice takes several passes"
        yield Claim(
            f"error of Z in the steady state minus that of paired runs, dt = {at.steady_step:g}, "
            f"{setting}, {_gas(at.steady_dimension, at.steady_packing_fraction)}", at.build_up, 0.0, FLOOR,
            "[Kolafa 2004], first order in 1/N", "errors accumulate over many steps",
            no_verdict="" if setting.startswith("4 passes") else builds_up,
        )  # fmt: skip


def _orders(row: Row) -> Iterator[Claim]:
    expected, source = [("Z", 1.0)], "contacts late by half a step"
    if "no rewinding" not in row.setting:
        expected = [("collision_rate", 2.0)]
        source = "contacts at their true positions; grazing ones are missed"
        if row.packing_fraction <= 0.01:
            expected.append(("Z", 3.0))
    for observable, order in expected:
        yield Claim.within(
            f"order of the error of {observable} in the time step, {row.setting}, "
            f"{_gas(row.dimension, row.packing_fraction)}", _of(row, observable).order, order, BAND[order],
            source, "a contact is resolved at the wrong place or time, or lost", required=REQUIRED[order],
        )  # fmt: skip


def _of(row: Row, observable: str) -> Row:
    """Return a row restricted to one observable."""
    return Row(row.dataset.sel(observable=observable))


def _gas(dimension: int, fraction: float) -> str:
    return f"{PARTICLES[dimension]}, packing fraction {fraction:g}"


# Line style of each setting that is drawn: the default, and the source's setting.
SHOWN = {"4 passes": "-", "1 pass, no rewinding": "--"}
MARKERS = {"boltzmann": "s", "enskog": "D"}


def draw(dataset: xr.Dataset) -> Figure:
    """Draw errors for spheres against the time step, and time against the error of Z."""
    figure, (*steps, cost) = style.new((2.3,), (2.3,), (2.3,), (2.3,))
    errors, models = Table(dataset, "row"), Table(dataset, "dsmc")
    models = models[models.dsmc_dimension == 3]
    titles = {"collision_rate": "collision rate", "Z": "$Z$", "D": "$D$"}
    for kind, (fraction, gas) in enumerate(errors[errors.dimension == 3].by("packing_fraction")):
        for setting, line in SHOWN.items():
            for row in gas[gas.setting == setting][:1]:
                for axis, observable in zip(steps, titles, strict=True):
                    _errors(axis, _of(row, observable), kind, line)
                if setting == "4 passes":
                    _costs(cost, _of(row, "Z"), kind)
        for model, marker in MARKERS.items():
            own = models[(models.dsmc_packing_fraction == fraction) & (models.dsmc_model == model)]
            look: dict[str, Any] = {"kind": kind, "marker": marker, "markersize": 5.0}
            style.points(cost, 100.0 * own.dsmc_bias, 1e6 * own.dsmc_seconds, **look)
        steps[1].plot([], [], color=style.COLOURS[kind], lw=3.0, label=rf"$\eta={fraction:g}$")
    for axis, (observable, title) in zip(steps, titles.items(), strict=True):
        axis.set(xscale="log", yscale="log", xlabel=r"time step $\Delta t\,v_\mathrm{th}/\sigma$")
        axis.set(ylabel=f"error of {title} (%)", ylim=(1e-4 if observable != "D" else 1e-2, 100.0))
    cost.set(xscale="log", yscale="log", xlabel="error of $Z$ (%)", ylabel=r"time per collision (µs)")
    _legends(steps[0], cost)
    steps[1].legend(loc="lower right")
    style.letters(*steps, cost)
    return figure


def _legends(first: Axes, cost: Axes) -> None:
    for name, line in SHOWN.items():
        first.plot([], [], color=style.GREY, ls=line, label=name)
    hollow: dict[str, Any] = {"markerfacecolor": "white", "markeredgecolor": style.GREY}
    first.plot([], [], marker="o", ls="none", label="no error resolved: bound", **hollow)
    cost.plot([], [], color=style.GREY, ls=":", label="event-driven, no error")
    cost.plot([], [], color=style.GREY, marker="o", lw=0.5, label="time-stepped")
    for model, marker in MARKERS.items():
        cost.plot([], [], color=style.GREY, marker=marker, ls="none", label=NAMES[model])
    first.legend(loc="lower right")
    cost.legend(loc="upper right")


def _errors(axis: Axes, at: Row, kind: int, line: str) -> None:
    """Draw the absolute errors of one observable, and the fitted order. An error above two standard errors is
    drawn filled, otherwise hollow at this bound.
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
    """Draw the time per collision against the absolute error of Z, or its bound; the events are a line."""
    error = 100.0 * np.maximum(np.abs(z.bias.value), 2.0 * z.bias.error)
    timed = np.isfinite(z.seconds.value) & np.isfinite(error)
    look: dict[str, Any] = {"kind": kind, "marker": "o", "linestyle": "-", "linewidth": 0.5}
    style.points(axis, error[timed], 1e6 * z.seconds[timed], **look)
    axis.axhline(1e6 * z.event_seconds, color=style.COLOURS[kind], ls=":")


FIGURES = {"speed_accuracy": Parts(SETTINGS, measure, claims, draw)}
