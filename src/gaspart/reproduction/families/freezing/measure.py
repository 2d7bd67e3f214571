"""Freezing: pressure and order of both starts, plateau of discs, coexisting crystal and fluid."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
import xarray as xr

from gaspart import theory
from gaspart.analysis import bond_order as structure
from gaspart.analysis.estimate import Estimate
from gaspart.analysis.flow import Grid
from gaspart.analysis.pairs import radial_distribution
from gaspart.analysis.run import Run
from gaspart.analysis.series import plateau
from gaspart.analysis.statistics import average, correlated_mean, mean_of
from gaspart.reproduction.families.shared.runs import runs, series_of
from gaspart.reproduction.points.point import Point
from gaspart.reproduction.table import Row, Table, table

STARTS = {"lattice": "crystal", "compressed": "fluid"}
"""Start of a run by its arrangement: a perfect lattice is a crystal, a compressed gas is a fluid."""
CRYSTAL_ORDER = 0.3
"""Smallest global Q_6 of a crystal of spheres. Q_6 is 0.45 and more near melting, and 0.03 in the fluid."""
COMPARED = 870
"""Number of discs with published pressures. Such points are compared, and not drawn."""
LOCAL_CRYSTAL = 0.32
"""Smallest averaged local q_6 of a crystal, half-way between 0.48 (crystal) and 0.16 (fluid)."""


Order = Callable[[np.ndarray, Sequence[float]], float]
"""Function that computes an order parameter of a frame, from positions and the container's lengths."""


def freezing_discs(points: list[Point], settings: dict) -> xr.Dataset:
    """Measure P and psi_6 of discs against packing fraction from both starts, and structure.

    The settings are `shown`, packing fractions whose structure is stored; `furthest` and `bins` of g(r), in
    diameters; and `highest`, the largest wave number of S(k) times the diameter.

    Variables over `start` and `packing_fraction` are defined in `_states`; the order is |mean psi_6|. Further
    variables:

    compared_pressure : pressure of COMPARED discs, with _error, _drift and _drift_error
    plateau : plateau pressure with plateau_error, over `start` (see `plateau`)
    plateau_low, plateau_high : packing fractions at the ends of the plateau, over `start`
    g, S : g(distance) and S(wave_x, wave_y) of the last start, over `shown`
    x, y, angle : position in diameters, and argument of psi_6, in the last frame, over `shown` and `particle`

    The dimensions of `compared_pressure` are `start` and `compared_packing_fraction`. It is absent if there
    are no points of COMPARED discs.
    """
    compared = [point for point in points if point.scene.count == COMPARED]
    points = [point for point in points if point not in compared]
    dataset = _states(points, _disc)
    unlike = dataset["pressure"].max("start") - dataset["pressure"].min("start")
    sides = list(Table(dataset.assign(unlike=unlike), "start"))
    parts = [table("start", sides, _plateau), _pictures(_of_start(points, sides[-1].start), settings)]
    if compared:
        parts.append(_compare(compared))
    return xr.merge([dataset, *parts], join="outer", compat="no_conflicts")


def freezing_spheres(points: list[Point], settings: dict) -> xr.Dataset:
    """Measure Z and Q_6 of spheres against packing fraction from both starts, and coexistence.

    There are no settings. Variables over `start` and `packing_fraction` are defined in `_states`; the order
    is the global Q_6. Further variables:

    crystalline : 1 if the order stayed above CRYSTAL_ORDER
    Z, Z_error : compressibility factor of the infinite system (the first order in 1/N is subtracted)
    finite_size : subtracted correction
    reference : Z of the equation for the branch of the run; NaN beyond its range
    slab_pressure, slab_error, slab_drift, slab_drift_error : pressure of coexisting phases
    slab_order, slab_density : profiles of local order and number density, over `half` and `position`
    crystal_fraction : fraction of crystal, over `half`
    """
    slabs = [point for point in points if point.settings.get("arrangement") == "slab"]
    bulk = [point for point in points if point not in slabs]
    dataset = _states(bulk, _sphere)
    dataset["crystalline"] = (dataset["crystalline"] == 1).astype(int)  # 0 if there is no run
    return dataset.merge(_slab(slabs), join="outer", compat="no_conflicts", combine_attrs="no_conflicts")


def _of_start(points: list[Point], start: str) -> dict[float, Point]:
    """Return the points of one start by packing fraction, ascending."""
    by_fraction = {
        round(point.scene.packing_fraction, 9): point
        for point in points
        if STARTS[point.settings["arrangement"]] == start
    }
    return dict(sorted(by_fraction.items()))


def _disc(point: Point) -> dict[str, Any]:
    """Return the columns of a point of discs."""
    return _state(point, lambda frame, lengths: abs(structure.hexatic(frame, lengths).mean()))


def _sphere(point: Point) -> dict[str, Any]:
    """Return the columns of a point of spheres.

    The columns include Z of the infinite system on the branch of the point, and the reference for Z.
    """
    row = _state(point, structure.global_steinhardt)
    eta, solid = row["packing_fraction"], row["order"][0] > CRYSTAL_ORDER
    z = Estimate(*row["pressure"]) / row["density"]
    if solid:
        finite = float(theory.crystal_finite_size_correction(z.value, row["count"]))
        reference = float(theory.etomica_crystal(eta)) if eta >= theory.LOWEST_CRYSTAL[3] else np.nan
    elif eta <= theory.HIGHEST_PACKING_FRACTION[3]:
        finite = float(theory.finite_size_correction(eta, 3, row["count"], ensemble="canonical"))
        reference = float(theory.compressibility_factor(eta, 3))
    else:
        finite, reference = 0.0, np.nan
    return row | {
        "crystalline": int(solid),
        "finite_size": finite,
        "Z": (z.value - finite, z.error),
        "reference": reference,
    }


def _state(point: Point, order: Order) -> dict[str, Any]:
    """Return pressure and order of a point, and the difference between its halves."""
    scene = point.scene
    density = scene.number_density * (2.0 * scene.largest_radius) ** scene.dimension
    pressures, orders = [], []
    for run in runs(point):
        frames = run.data["coordinates"].values[1:]
        pressures.append(density * series_of(run).z)
        orders.append(np.array([order(frame, scene.container.lengths) for frame in frames]))
    row: dict[str, Any] = {
        "start": STARTS[point.settings["arrangement"]],
        "packing_fraction": round(scene.packing_fraction, 9),
        "count": scene.count,
        "density": density,
    }
    for name, replicas in (("pressure", pressures), ("order", orders)):
        mean, drift = _mean_and_drift(replicas)
        row |= {name: (mean.value, mean.error), f"{name}_drift": (drift.value, drift.error)}
    return row


def _mean_and_drift(replicas: list[np.ndarray]) -> tuple[Estimate, Estimate]:
    """Return the mean of each series, and second half minus first half.

    In equilibrium this difference is zero on average.
    """
    means = [correlated_mean(series).estimate for series in replicas]
    drifts = []
    for series, mean in zip(replicas, means, strict=True):
        first, second = series[: len(series) // 2], series[len(series) // 2 :]
        drifts.append(Estimate(second.mean() - first.mean(), 2.0 * mean.error))
    return average(means), average(drifts)


def _states(points: list[Point], row: Callable[[Point], dict[str, Any]]) -> xr.Dataset:
    """Return the columns of all starts and packing fractions, averaged over replicas.

    Entries without a run are NaN.

    pressure, order : pressure in k_B T / sigma^d and order, with _error, _drift and _drift_error
    count : number of particles, over `packing_fraction`
    density : number density in 1 / sigma^d, over `packing_fraction`
    disagreement : largest deviation between the starts or between halves of a run, in standard errors

    Pressure and order are over `start` and `packing_fraction`. The deviations are in pressure and in order. A
    disagreement above 3 shows that the runs are not in equilibrium.
    """
    chosen = [point for start in STARTS.values() for point in _of_start(points, start).values()]
    dataset = table("point", chosen, row).set_index(point=["start", "packing_fraction"]).unstack("point")
    dataset["count"], dataset["density"] = (
        dataset["count"].max("start").astype(int),
        dataset["density"].max("start"),
    )
    dataset["pressure"].attrs["units"] = "k_B T / sigma^d"
    return dataset.assign(disagreement=_disagreement(dataset))


def _disagreement(dataset: xr.Dataset) -> xr.DataArray:
    worst = []
    for quantity in ("pressure", "order"):
        value, error = dataset[quantity], dataset[f"{quantity}_error"]
        worst.append((abs(dataset[f"{quantity}_drift"]) / dataset[f"{quantity}_drift_error"]).max("start"))
        if dataset.sizes["start"] == 2:
            worst.append(abs(value.diff("start")).isel(start=0) / np.sqrt((error**2).sum("start")))
    return xr.concat(worst, "what", join="outer", compat="equals").max("what")


def _compare(points: list[Point]) -> xr.Dataset:
    """Return the pressures of the points that are compared with published values."""
    names = [f"pressure{name}" for name in ("", "_error", "_drift", "_drift_error")]
    new = {name: f"compared_{name}" for name in (*names, "packing_fraction")}
    return _states(points, _disc)[names].rename(new)


def _plateau(side: Row) -> dict[str, Any]:
    """Compute the plateau of one start.

    The uncertainty of a point includes half of its drift, and half of the difference between the starts,
    `unlike`. A run out of equilibrium is therefore uncertain.
    """
    states = Table(side.dataset, "packing_fraction")
    states = states[np.isfinite(states.pressure.value)]
    parts = states.pressure.error, 0.5 * states.pressure_drift.value, 0.5 * states.unlike
    error = np.sqrt(sum(part**2 for part in parts))
    pressure, uncertainty, (large, small) = plateau(1.0 / states.density, states.pressure.value, error)
    area = np.pi / 4.0
    return {
        "plateau": (pressure, uncertainty),
        "plateau_low": area / large,
        "plateau_high": area / small,
    }


def _pictures(chosen: dict[float, Point], settings: dict) -> xr.Dataset:
    """Return the structure at some packing fractions; lengths are in diameters."""
    fractions = [x for x in chosen if any(abs(x - y) < 1e-6 for y in settings["shown"])]
    rows = [_picture(chosen[x], settings) for x in fractions]
    # The wave vectors depend on the container, which shrinks with the packing fraction. They are stored by
    # index.
    most_x, most_y = (min(row[name].size for row in rows) // 2 for name in ("wave_x", "wave_y"))
    for row in rows:
        row["wave_x"], row["wave_y"] = _middle(row["wave_x"], most_x), _middle(row["wave_y"], most_y)
        row["structure_factor"] = _middle(row["structure_factor"], most_x, most_y)
    inner = {
        **dict.fromkeys(("x", "y", "angle"), ("particle",)),
        "g": ("distance",),
        "wave_x": ("mode_x",),
        "wave_y": ("mode_y",),
        "structure_factor": ("mode_x", "mode_y"),
    }
    distances = [row.pop("distance") for row in rows]
    return table("shown", rows, dict, inner=inner).assign_coords(shown=fractions, distance=distances[0])


def _picture(point: Point, settings: dict) -> dict[str, Any]:
    """Return the last frame, g(r) and S(k) of the first replica."""
    replicas = runs(point)  # the file is open during this block
    run = next(replicas)
    diameter = 2.0 * run.scene.largest_radius
    lengths = np.array(run.scene.container.lengths) / diameter
    frames = run.data["coordinates"].values[1:] / diameter
    distance, g = radial_distribution(frames, lengths, settings["bins"], settings["furthest"])
    wave_x, wave_y, factor = structure.structure_factor(frames, lengths, settings["highest"])
    return {
        "x": frames[-1][:, 0],
        "y": frames[-1][:, 1],
        "angle": np.angle(structure.hexatic(frames[-1], lengths)),
        "distance": distance,
        "g": g,
        "wave_x": wave_x,
        "wave_y": wave_y,
        "structure_factor": factor,
    }


def _middle(values: np.ndarray, *most: int) -> np.ndarray:
    """Return the middle elements along each axis, equally many on both sides."""
    sizes = zip(values.shape, most, strict=True)
    return values[tuple(slice(size // 2 - n, size // 2 + n + 1) for size, n in sizes)]


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
    mean, drift = _mean_and_drift(pressures)
    error = mean.error
    if len(pressures) > 2:  # interfaces move slowly: replicas show a scatter that blocks of one run do not
        error = max(error, mean_of([correlated_mean(series).estimate.value for series in pressures]).error)
    both = "half", "position"
    return xr.Dataset(
        {
            "slab_pressure": mean.value,
            "slab_error": error,
            "slab_drift": drift.value,
            "slab_drift_error": drift.error,
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
    """Compute local order and reduced density (2, bins) of both halves of a run.

    The profiles are along an axis. The fraction of crystalline spheres (2,) is returned too.
    """
    scene, frames = run.scene, run.data["coordinates"].values[1:]
    local = np.array([structure.local_steinhardt(frame, scene.container.lengths) for frame in frames])
    half = np.arange(2).repeat([(len(frames) + 1) // 2, len(frames) // 2])
    cells = grid.cells(frames[..., axis, None], inside=True)
    numbers = grid.sums(cells, blocks=half)
    volume = scene.container.volume / grid.size / (2.0 * scene.largest_radius) ** 3
    return (
        grid.sums(cells, local, half) / numbers,
        numbers / np.bincount(half)[:, None] / volume,
        np.array([(local[half == k] > LOCAL_CRYSTAL).mean() for k in (0, 1)]),
    )
