"""Freezing of spheres: both branches of Z, order, and a crystal beside its fluid."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

import numpy as np
import xarray as xr

from gaspart import theory
from gaspart.analysis import bond_order
from gaspart.analysis.estimate import Estimate
from gaspart.analysis.flow import Grid
from gaspart.analysis.run import Run
from gaspart.analysis.statistics import correlated_mean, mean_of
from gaspart.rendering import style
from gaspart.rendering.style import Axes, Figure
from gaspart.reproduction.claims import Claim
from gaspart.reproduction.figure import Parts, runs, series_of
from gaspart.reproduction.figures._freezing import (
    LOOKS,
    TOLERANCE,
    draw_order,
    draw_points,
    extreme,
    mean_and_drift,
    measure_state,
    measure_states,
    starts,
    with_drift,
)
from gaspart.reproduction.points.point import Point
from gaspart.reproduction.table import Row, Table, entries
from gaspart.theory.packing import ETOMICA_CRYSTAL_UNCERTAINTY

TITLE, CHAPTER = "Freezing and melting", "Equation of state and structure"
CRYSTAL_ORDER = 0.3  # smallest global Q_6 of a crystal; it is 0.45 and more near melting, 0.03 in the fluid
LOCAL_CRYSTAL = 0.32  # smallest averaged local q_6, half-way between 0.48 (crystal) and 0.16 (fluid)


def measure(points: list[Point], settings: dict) -> xr.Dataset:
    """Measure Z and Q_6 of spheres against packing fraction from both starts, and coexistence. Z is that of
    the infinite system, `reference` that of the equation for the branch of the run, NaN beyond its range. A
    `slab` holds both phases; its profiles and fraction of crystal are those of both halves.
    """
    slabs = [point for point in points if point.settings.get("arrangement") == "slab"]
    dataset = measure_states([point for point in points if point not in slabs], _sphere)
    dataset["crystalline"] = (dataset["crystalline"] == 1).astype(int)  # 0 if there is no run
    return dataset.merge(_slab(slabs), join="outer", compat="no_conflicts", combine_attrs="no_conflicts")


def _sphere(point: Point) -> dict[str, Any]:
    row = measure_state(point, bond_order.global_steinhardt)
    eta, solid = row["packing_fraction"], row["order"].value > CRYSTAL_ORDER
    z, finite, reference = row["pressure"] / row["density"], 0.0, np.nan
    if solid:
        finite = float(theory.crystal_finite_size_correction(z.value, row["count"]))
        reference = float(theory.etomica_crystal(eta)) if eta >= theory.LOWEST_CRYSTAL[3] else np.nan
    elif eta <= theory.HIGHEST_PACKING_FRACTION[3]:
        finite = float(theory.finite_size_correction(eta, 3, row["count"], ensemble="canonical"))
        reference = float(theory.compressibility_factor(eta, 3))
    row |= {"crystalline": int(solid), "finite_size": finite, "reference": reference}
    return row | {"Z": z - finite}


def _slab(points: list[Point]) -> xr.Dataset:
    """Measure pressure and profiles of containers with crystal and fluid, averaged over replicas."""
    (point,) = points
    scene = point.scene
    lengths, diameter = scene.container.lengths, 2.0 * scene.largest_radius
    axis = int(np.argmax(lengths))
    # A bin for each cell of the crystal, so that each bin has the same number of layers.
    cell = (4.0 / theory.COEXISTENCE_DENSITY[3][1]) ** (1.0 / 3.0) * diameter
    grid = Grid.line(0.0, lengths[axis], round(lengths[axis] / cell))
    pressures, profiles = [], []
    for run in runs(point):
        pressures.append(series_of(run).z * scene.number_density * diameter**3)
        profiles.append(_profiles(run, grid, axis))
    order, density, fraction = (np.mean(parts, axis=0) for parts in zip(*profiles, strict=True))
    pressure, drift = mean_and_drift(pressures)
    if len(pressures) > 2:  # interfaces move slowly: replicas show a scatter that blocks of one run do not
        scattered = mean_of([correlated_mean(series).estimate.value for series in pressures])
        pressure = max(pressure, scattered, key=lambda estimate: estimate.error)
    both = "half", "position"
    return xr.Dataset(
        {
            **entries({"slab_pressure": pressure, "slab_drift": drift}),
            "slab_length": lengths[axis] / diameter,
            "slab_count": scene.count,
            "crystal_fraction": ("half", fraction),
            "slab_order": (both, order),
            "slab_density": (both, density),
        },
        coords={"position": grid.middles[0] / diameter},
        attrs={"slab_packing_fraction": scene.packing_fraction},
    )


def _profiles(run: Run, grid: Grid, axis: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Compute local order and reduced density (2, bins) of both halves, and crystalline fractions (2,)."""
    scene, frames = run.scene, run.data["coordinates"].values[1:]
    local = np.array([bond_order.local_steinhardt(frame, scene.container.lengths) for frame in frames])
    half = np.arange(2).repeat([(len(frames) + 1) // 2, len(frames) // 2])
    cells = grid.cells(frames[..., axis, None], inside=True)
    numbers = grid.sums(cells, blocks=half)
    volume = scene.container.volume / grid.size / (2.0 * scene.largest_radius) ** 3
    return (
        grid.sums(cells, local, half) / numbers,
        numbers / np.bincount(half)[:, None] / volume,
        np.array([(local[half == k] > LOCAL_CRYSTAL).mean() for k in (0, 1)]),
    )


def claims(dataset: xr.Dataset) -> Iterator[Claim]:
    """Yield claims on melting and stability of a crystal, branches of Z, and coexistence."""
    sides = starts(dataset, finite="order")
    crystal = sides["crystal"]
    eta = crystal.packing_fraction
    for part, melted in ((crystal[eta <= 0.4501], True), (crystal[eta >= 0.5599], False)):
        if part:
            yield _lattice(part, melted)
    for side in sides.values():
        for one in side:
            yield _branch(one)
    yield from _coexistence(Row(dataset))


def _lattice(crystal: Table, melted: bool) -> Claim:
    eta = crystal.packing_fraction
    make, bound = (Claim.at_most, 0.1) if melted else (Claim.at_least, 0.4)
    return make(
        f"{'largest' if melted else 'smallest'} global Q_6 from a face-centred cubic start, "
        f"packing fractions {f'up to {eta.max():.4g}' if melted else f'from {eta.min():.4g}'}",
        extreme(crystal.order, melted), bound, 0.02,
        "spheres melt below 0.49 and are stable above 0.55 ([Hoover 1968])",
        "a crystal that cannot melt, or one that disintegrates: contacts are wrong",
    )  # fmt: skip


def _branch(one: Row) -> Claim:
    """Return the claim on Z on the branch of a run; a superheated crystal may melt, and has no verdict."""
    eta, reference, allowance = one.packing_fraction, one.reference, 0.0
    if one.crystalline:
        phase, source = "crystal", "etomica's fit to simulations of its authors"
        origin = "its distance from runs behind [Pieprzyk 2019]; the next order of finite numbers"
        next_order = (theory.CLOSE_PACKING[3] / eta - 1.0) * one.finite_size
        allowance = math.hypot(ETOMICA_CRYSTAL_UNCERTAINTY * reference, next_order)
    else:
        phase, source = "fluid", "[Kolafa 2004]"
        origin = "its distance from etomica's equation, or from the virial series"
        if math.isfinite(reference):
            allowance = float(theory.compressibility_uncertainty(eta, 3))
    superheated = one.crystalline and eta < theory.coexistence_packing_fractions(3)[1]
    return Claim(
        f"Z of the {phase} at packing fraction {eta:.4g}, from the {one.start}",
        with_drift(one.Z, one.pressure_drift / one.density), Estimate(reference, allowance),
        2e-3 * reference, source, "contacts are missed, defects, or the other phase has begun to grow",
        allowance_source=origin,
        no_verdict="a superheated crystal, which may be melting" if superheated else "",
    )  # fmt: skip


def _coexistence(slab: Row) -> Iterator[Claim]:
    expected, pressure, drift = theory.COEXISTENCE_PRESSURE[3], slab.slab_pressure, slab.slab_drift
    early, late = slab.crystal_fraction
    yield Claim.within(
        "pressure of crystal beside fluid, k_B T / sigma^3",
        Estimate(pressure.value, math.hypot(pressure.error, 0.5 * drift.value), pressure.freedom),
        expected, TOLERANCE * expected, "[Fernandez 2012]",
        "one phase has vanished, the crystal is strained, or contacts are missed",
    )  # fmt: skip
    yield Claim(
        "pressure of crystal beside fluid: second half of the run minus the first, k_B T / sigma^3",
        drift, 0.0, TOLERANCE * expected, "a stationary state", "one phase is still growing",
    )  # fmt: skip
    yield Claim.within(
        "part of the spheres that are crystalline at the end of the run",
        Estimate(late, abs(late - early)), 0.5, 0.3,
        "the container holds both phases at the mean of their densities (lever rule)",
        "one phase has vanished",
    )  # fmt: skip


def draw(dataset: xr.Dataset) -> Figure:
    """Draw pressure of both branches, its residuals, Q_6, and profiles of coexistence."""
    figure, axes = style.new((2.4, 1.2), (1.5,), (2.0,))
    upper, middle, order, slab = axes
    sides = starts(dataset)
    _branches(upper, Table(dataset, "packing_fraction").packing_fraction, sides)
    _both_phases(upper, Row(dataset))
    _residuals(middle, sides)
    draw_order(order, sides, 3)
    style.label_axes(order, y="global $Q_6$", ylim=(0.0, 0.6), xlim=upper.get_xlim())
    _draw_profiles(slab, Table(dataset, "half"))
    style.letters(*axes)
    return figure


def _branches(axis: Axes, eta: np.ndarray, sides: dict[str, Table]) -> None:
    expected = theory.COEXISTENCE_PRESSURE[3]
    style.level(axis, expected)
    densities = theory.coexistence_packing_fractions(3)
    axis.plot(densities, [expected] * 2, color=style.GREY, linewidth=2.5, alpha=0.6)
    fluid = np.linspace(eta[0], theory.HIGHEST_PACKING_FRACTION[3], 100)
    crystal = np.linspace(theory.LOWEST_CRYSTAL[3], eta[-1], 100)
    for at, z, label, kind in (
        (fluid, theory.compressibility_factor(fluid, 3), "fluid (KLM)", 2),
        (crystal, theory.etomica_crystal(crystal), "crystal (etomica)", 3),
    ):
        axis.plot(at, at / (np.pi / 6.0) * z, color=style.COLOURS[kind], label=label)
    for start, side in sides.items():
        draw_points(axis, side, side.pressure, LOOKS[start], f"from the {start}")


def _both_phases(axis: Axes, slab: Row) -> None:
    """Draw the pressure of coexisting crystal and fluid, at their mean density."""
    style.points(axis, slab.slab_packing_fraction, slab.slab_pressure, kind=6, label="coexistence")
    style.label_axes(axis, y="pressure $P\\sigma^3/k_\\mathrm{B}T$", legend="upper left")


def _residuals(axis: Axes, sides: dict[str, Table]) -> None:
    style.level(axis, 0.0)
    for start, side in sides.items():
        finite = side[np.isfinite(side.reference)]
        draw_points(axis, finite, 100.0 * (finite.Z / finite.reference - 1.0), LOOKS[start])
    labels = r"packing fraction $\eta$", "$Z/Z_\\mathrm{branch}-1$  (%)"
    style.label_axes(axis, *labels, ylim=(-0.5, 0.5))


def _draw_profiles(axis: Axes, halves: Table) -> None:
    """Draw local order (left) and density (right) along the container, in both halves of the run."""
    other = axis.twinx()
    for half, line in zip(halves, (":", "-"), strict=True):
        axis.plot(half.position, half.slab_order, linestyle=line, color=style.COLOURS[1])
        other.plot(half.position, half.slab_density, linestyle=line, color=style.COLOURS[0])
    for density in theory.COEXISTENCE_DENSITY[3]:
        other.axhline(density, color=style.COLOURS[0], linewidth=0.6, alpha=0.6)
    axis.set(
        xlabel="position along the container $/\\sigma$", ylim=(0.0, 0.6), xlim=(0.0, halves.slab_length)
    )
    axis.set_ylabel("local $q_6$", color=style.COLOURS[1])
    other.set_ylim(0.85, 1.15)
    other.set_ylabel("density $\\rho\\sigma^3$", color=style.COLOURS[0])


FIGURES = {"freezing_spheres": Parts({}, measure, claims, draw)}
