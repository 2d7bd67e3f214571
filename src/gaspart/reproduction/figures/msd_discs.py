"""Displacement of discs: D(t), which does not converge, and its slope against ln t."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

import numpy as np
import xarray as xr

from gaspart import theory
from gaspart.analysis.motion import Curves, line, mask_between
from gaspart.rendering import style
from gaspart.rendering.style import Axes, Figure
from gaspart.reproduction.claims import Claim
from gaspart.reproduction.figure import Parts
from gaspart.reproduction.figures import _displacement as shared
from gaspart.reproduction.figures._displacement import MODE_COUPLING
from gaspart.reproduction.points.point import Point
from gaspart.reproduction.table import Table, table

TITLE, CHAPTER = "Displacement and velocity autocorrelation", "Motion and its memory"
LOGARITHM_FROM = 30.0  # collisions per particle after which hydrodynamic modes describe C


def measure(points: list[Point], settings: dict) -> xr.Dataset:
    """Measure D(t), the derivative of the msd over 2d, and its slope against ln t."""
    dataset = table("point", points, _discs, inner=("lag",), units=shared.UNITS)
    return dataset.assign_attrs(dimension=2, reduced_time=shared.REDUCED_TIME)


def _discs(point: Point) -> dict[str, Any]:
    """Measure a point, until sound has crossed the container: then particles are affected by its size. Zero
    total momentum affects them at once: without it all would share a velocity of mean square d / N. Therefore
    1 / N is added to C, t / N to D(t), d t^2 / N to the msd. `slope_expected` is that of the container's
    hydrodynamic modes, fitted alike.
    """
    state = shared.State(point)
    start = LOGARITHM_FROM / state.collision_rate
    stop, share = max(state.sound_time, 2.0 * start), 1.0 / state.count
    curves = [
        Curves(
            curve.time,
            curve.msd + 2.0 * share * curve.time**2,
            curve.correlation + share,
            curve.running + share * curve.time,
        )
        for curve in shared.replicas(point, stop)
    ]
    row = shared.columns(point, state, curves)
    if shared.is_short(row):
        return row | {"logarithmic_slope": shared.ABSENT, "slope_expected": math.nan}
    insides = [mask_between(curve.time, start, stop) for curve in curves]
    slopes = [
        line(np.log(curve.time[inside]), curve.running[inside])
        for curve, inside in zip(curves, insides, strict=True)
    ]
    time = row["time"][mask_between(row["time"], start, stop)]
    expected = theory.diffusion_modes(time, state.packing_fraction, 2, state.count)
    fit = {"slope_expected": line(np.log(time), expected), "fit_from": start, "fit_to": stop}
    return row | {"logarithmic_slope": shared.mean(slopes)} | fit


def claims(dataset: xr.Dataset) -> Iterator[Claim]:
    """Yield the claims on the slope of D(t) against ln t; discs have no finite D."""
    points = Table(dataset, "point")
    for gas in _long(points):
        yield Claim(
            f"slope of D(t) against ln t at packing fraction {gas.packing_fraction:g}",
            gas.logarithmic_slope, gas.slope_expected, 0.15 * gas.slope_expected, MODE_COUPLING,
            "a velocity autocorrelation that has no 1/t tail, so that D exists", alternative=0.0,
        )  # fmt: skip
    yield from shared.claim_short_times(points)


def _long(points: Table) -> Table:
    return points[np.isfinite(points.logarithmic_slope.value)]


def draw(dataset: xr.Dataset) -> Figure:
    """Draw the msd of discs, D(t), which does not converge, and its slope against ln t."""
    figure, axes = style.new((2.6,), (2.2,), (2.2,))
    points = Table(dataset, "point")
    shared.draw_displacement(axes[0], points)
    shared.draw_running(axes[1], points)
    _slopes(axes[2], _long(points).sorted_by("packing_fraction"))
    style.letters(*axes)
    return figure


def _slopes(axis: Axes, long: Table) -> None:
    """Draw the slope of D(t) against ln t, with mode coupling in infinite systems and in the container."""
    eta = long.packing_fraction
    curve = np.linspace(0.5 * eta.min(), 1.1 * eta.max(), 100)
    axis.plot(curve, theory.logarithmic_slope(curve), color=style.REFERENCE, label="infinite system")
    predicted = long[np.isfinite(long.slope_expected)]
    look: dict[str, Any] = {"color": style.REFERENCE, "label": "modes of the container", "zorder": 4}
    axis.plot(predicted.packing_fraction, predicted.slope_expected, "x", **look)
    style.points(axis, eta, long.logarithmic_slope, color=style.DATA, label="measured")
    axis.set_ylim(0.0)
    slope = r"$\mathrm{d}D/\mathrm{d}\ln t\ (\sigma\sqrt{k_\mathrm{B}T/m})$"
    style.label_axes(axis, r"packing fraction $\eta$", slope, "lower left")


FIGURES = {"msd_discs": Parts({}, measure, claims, draw, key=1)}
