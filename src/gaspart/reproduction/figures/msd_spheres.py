"""Displacement of spheres, from ballistic to diffusive motion, and their diffusion coefficient D."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

import numpy as np
import xarray as xr

from gaspart import theory
from gaspart.analysis.diffusion import LINEAR_FROM
from gaspart.analysis.motion import Curves, line, mask_between
from gaspart.analysis.statistics import combine_estimates, fit_polynomial
from gaspart.errors import SceneError
from gaspart.rendering import style
from gaspart.rendering.style import Axes, Figure
from gaspart.reproduction.claims import Claim, Estimate
from gaspart.reproduction.figure import ENSKOG_LIMIT, Parts
from gaspart.reproduction.figures import _displacement as shared
from gaspart.reproduction.points.point import Point
from gaspart.reproduction.table import Table, entries, table
from gaspart.theory.diffusion import ERPENBECK_WOOD_UNCERTAINTY, VISCOSITY_RATIO_UNCERTAINTY

TITLE, CHAPTER = "Displacement and velocity autocorrelation", "Motion and its memory"
# D is the slope of the msd from t to 2t; t is LINEAR_FROM collisions per particle, or so many decay times of
# the container's slowest shear mode, whichever is later.
SETTLE_SHEAR_TIMES = 3.0
DILUTE_BAND = 0.007  # relative difference of D from Enskog's; by Erpenbeck and Wood's fit 0.6 % at 0.02


def spheres(point: Point) -> dict[str, Any]:
    """Measure D of a point, its correction to an infinite container, and the curves. With zero total
    momentum, D of N particles is smaller by (N - 1) / N, exactly in a dilute gas, where each other particle
    carries -1 / (N - 1) of a particle's momentum; the curves are divided by this. The rest is hydrodynamic:
    Yeh and Hummer's, with the measured viscosity plus rho D, as a particle also leaves a vortex by its own
    diffusion and each mode decays with nu + D (Ernst, Hauge and van Leeuwen 1970). Its uncertainty is that of
    the viscosity and (2 pi mean free path / side)^2, the next order in the slowest mode.
    """
    state = shared.State(point)
    start = max(LINEAR_FROM / state.collision_rate, SETTLE_SHEAR_TIMES * state.shear_time)
    factor = state.count / (state.count - 1.0)
    curves = [
        Curves(curve.time, factor * curve.msd, factor * curve.correlation, factor * curve.running)
        for curve in shared.replicas(point, 2.0 * start)
    ]
    row = shared.columns(point, state, curves)
    if shared.is_short(row):
        return row | {"diffusion": shared.ABSENT}
    time = row["time"]
    if time[-1] + time[1] < 2.0 * start:
        where = f"experiments.{point.experiment}[{point.name}]: collisions per particle"
        collisions = math.ceil(4.0 * start * state.collision_rate)
        rule = f"must be {collisions} or more, and `lags` reach half of it, for a straight stretch of the msd"
        raise SceneError(where, round(point.schedule.samples * row["interval"]), rule)
    insides = [mask_between(curve.time, start, 2.0 * start) for curve in curves]
    diffusion = shared.mean([
        line(curve.time[inside], curve.msd[inside]) / 6.0
        for curve, inside in zip(curves, insides, strict=True)
    ])  # fmt: skip
    carried = float(theory.number_density(state.packing_fraction, 3)) * diffusion.value
    correction = float(theory.yeh_hummer(state.side, state.viscosity + carried))
    next_order = (2.0 * math.pi * state.mean_free_path / state.side) ** 2
    relative = min(1.0, math.hypot(VISCOSITY_RATIO_UNCERTAINTY, next_order))
    return row | {
        "diffusion": diffusion,
        "correction": correction,
        "correction_uncertainty": correction * relative,
        "fit_from": start,
        "fit_to": 2.0 * start,
    }


def measure(points: list[Point], settings: dict) -> xr.Dataset:
    """Measure `spheres`; mark the long run of most particles at a packing fraction, and series of sizes."""
    dataset = table("point", points, spheres, inner=("lag",), units=shared.UNITS)
    runs = Table(dataset.assign_attrs(dimension=3, reduced_time=shared.REDUCED_TIME), "point")
    eta, long = runs.packing_fraction.round(6), np.isfinite(runs.diffusion.value)
    same = long & long[:, None] & (eta == eta[:, None])
    most = np.where(same, runs.count, 0).max(axis=1) == runs.count
    return size_series(runs.assign(largest=long & most, in_series=long & (same.sum(axis=1) >= 3)).dataset)


def size_series(dataset: xr.Dataset) -> xr.Dataset:
    """Add lines of D against 1/L through the points `in_series`: a fit, and one of Yeh and Hummer's slope."""
    runs = Table(dataset, "point")
    sizes = runs[runs.in_series]
    if not sizes:
        return dataset
    inverse, predicted = 1.0 / sizes.side, -sizes.correction[0] * sizes.side[0]
    fit = fit_polynomial(inverse, sizes.diffusion)
    limit = fit_polynomial(inverse, sizes.diffusion, powers=(0,), fixed={1: predicted}).values[0]
    coefficients = {"size_intercept": fit.estimate(0), "size_slope": fit.estimate(1)}
    return dataset.assign(entries(coefficients) | {"size_limit": float(limit)})


def infinite(points: Table) -> Estimate:
    """Compute D in an infinite container."""
    return points.diffusion + Estimate(points.correction, points.correction_uncertainty)


def claims(dataset: xr.Dataset) -> Iterator[Claim]:
    """Yield the claims on D: Enskog theory in dilute gases, published simulations in dense ones."""
    points = Table(dataset, "point")
    largest = points[points.largest]
    is_dilute = largest.packing_fraction <= ENSKOG_LIMIT * (1.0 + 1e-6)
    dilute, dense = largest[is_dilute], largest[~is_dilute]
    yield Claim.within(
        f"D over Enskog's in the dilute limit (packing fraction {ENSKOG_LIMIT:g} and below)",
        combine_estimates(infinite(dilute) / theory.enskog_diffusion(dilute.packing_fraction, 3)),
        1.0, DILUTE_BAND,
        "Enskog theory, 1.01895 times the first Sonine approximation",
        "a wrong mean free path, or a msd not yet straight; the first approximation is 1.9 % low",
        alternative=1.0 / 1.01895,
    )  # fmt: skip
    ratios = infinite(dense) / theory.erpenbeck_wood_diffusion(dense.packing_fraction)
    for gas, ratio in zip(dense, ratios, strict=True):
        yield Claim(
            f"D over Erpenbeck and Wood's at packing fraction {gas.packing_fraction:g}",
            ratio, Estimate(1.0, ERPENBECK_WOOD_UNCERTAINTY), 0.015, "[Erpenbeck 1991]",
            "correlated collisions missing, a msd not yet straight, a wrong finite-size correction",
            allowance_source="its largest difference from [Pieprzyk 2019]",
        )  # fmt: skip
    if points.in_series.any():
        first = points[points.in_series][0]
        expected = -first.correction * first.side
        yield Claim(
            f"slope of D against 1/L at packing fraction {first.packing_fraction:g}",
            points.size_slope, expected, 0.15 * abs(expected),
            "[Yeh 2004], with the measured viscosity and modes that decay with nu + D",
            "D that does not depend on the container as hydrodynamics states", alternative=0.0,
        )  # fmt: skip
    yield from shared.claim_short_times(points)


def draw(dataset: xr.Dataset) -> Figure:
    """Draw the msd, D(t) from displacements and velocities, and D against density and 1/L."""
    figure, axes = style.new((2.4,), (2.4,), (2.3,), (2.3,))
    points = Table(dataset, "point")
    shared.draw_displacement(axes[0], points)
    fine = np.isfinite(points.integral_difference.value)
    mask = np.isin(points.packing_fraction.round(6), shared.fractions(points)) & (points.largest | fine)
    shared.draw_running(axes[1], points[mask])
    _density(axes[2], points[points.largest].sorted_by("packing_fraction"))
    _size(axes[3], points[points.in_series])
    style.letters(*axes)
    return figure


def _density(axis: Axes, largest: Table) -> None:
    eta = largest.packing_fraction
    enskog = theory.enskog_diffusion(eta, 3)
    curve = np.linspace(0.0, 1.08 * eta.max(), 200)
    ratio, band = theory.erpenbeck_wood_ratio(curve), ERPENBECK_WOOD_UNCERTAINTY
    axis.fill_between(curve, ratio * (1 - band), ratio * (1 + band), color=style.REFERENCE, alpha=0.2, lw=0)
    axis.plot(curve, ratio, color=style.REFERENCE, label=rf"Erpenbeck & Wood, $\pm{100.0 * band:g}\,\%$")
    axis.axhline(1.0, color=style.DATA, lw=0.8, label="Enskog")
    style.points(axis, eta, largest.diffusion / enskog, kind=1, hollow=True, label="finite container")
    style.points(axis, eta, infinite(largest) / enskog, color=style.DATA, label="infinite container")
    axis.set(xlim=(0.0, curve[-1]), ylim=(0.93, 1.72))
    style.label_axes(axis, r"packing fraction $\eta$", r"$D/D_\mathrm{Enskog}$", "upper right")


def _size(axis: Axes, sizes: Table) -> None:
    """Draw D_L against 1/L, with fitted line and the slope that hydrodynamics predicts."""
    if not sizes:
        axis.set_axis_off()
        return
    first, inverse = sizes[0], 1.0 / sizes.side
    x, eta = np.linspace(0.0, 1.15 * inverse.max(), 2), first.packing_fraction
    fit = sizes.size_intercept.value + sizes.size_slope.value * x
    axis.plot(x, fit, color=style.DATA, lw=0.8, label="fit")
    hydrodynamic = sizes.size_limit - first.correction * first.side * x
    axis.plot(x, hydrodynamic, color=style.REFERENCE, ls="--", label="Yeh & Hummer's slope")
    published = Estimate([1.0], ERPENBECK_WOOD_UNCERTAINTY)
    published = float(theory.erpenbeck_wood_diffusion(eta)) * published
    look: dict[str, Any] = {"color": style.REFERENCE, "marker": "s", "clip_on": False}
    style.points(axis, [0.0], published, label="Erpenbeck & Wood", **look)
    style.points(axis, inverse, sizes.diffusion, color=style.DATA, label=rf"$\eta={eta:g}$")
    for abscissa, size in zip(inverse, sizes, strict=True):
        at = (abscissa, size.diffusion.value)
        axis.annotate(f"{size.count:.0f}", at, (3, 5), textcoords="offset points")
    axis.set_xlim(0.0, x[-1])
    style.label_axes(axis, r"$\sigma/L$", r"$D_L\ (\sigma\sqrt{k_\mathrm{B}T/m})$", "upper right")


FIGURES = {"msd_spheres": Parts({}, measure, claims, draw, key=2)}
