"""Freezing: pressure and order of both starts, the plateau of discs, and coexisting crystal and fluid."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
import xarray as xr

from gaspart import theory
from gaspart.analysis import order as structure
from gaspart.analysis.bins import Grid
from gaspart.analysis.coexistence import plateau
from gaspart.analysis.run import Run
from gaspart.analysis.statistics import correlated_mean, mean_of
from gaspart.reproduction.families.shared.pressure import series_of
from gaspart.reproduction.families.shared.runs import runs
from gaspart.reproduction.points.point import Point
from gaspart.trajectory.reading import open_trajectory

STARTS = {"lattice": "crystal", "compressed": "fluid"}
"""What a run starts from, by its arrangement: a perfect lattice, or a disordered fluid."""
CRYSTAL_ORDER = 0.3
"""Global Q_6 above which a run of spheres is taken for a crystal: 0.45 and more near melting, 0.03 in the
fluid."""
COMPARED = 870
"""Number of discs whose pressure is published: points of so many are compared with it, and not drawn."""
LOCAL_CRYSTAL = 0.32
"""Averaged local q_6 half-way between the crystal's 0.48 and the fluid's 0.16."""


@dataclass(frozen=True)
class Series:
    """One run: P sigma^d / kT of every interval, an order parameter at its end, and the reduced density."""

    pressure: np.ndarray
    order: np.ndarray
    density: float


def freezing_discs(points: list[Point], settings: dict) -> xr.Dataset:
    """P and psi_6 of discs against packing fraction from both starts; plateau pressures; structure.

    settings: `shown`, packing fractions whose structure is kept; `furthest` and `bins` of g(r), in diameters;
    `highest` wave number of S(k), times the diameter.

    Returns over `start` and `packing_fraction`: see `_states`, the order being |mean psi_6|. Over `start` and
    `compared_packing_fraction`: compared_pressure, its _error, _drift and _drift_error, of the points of
    COMPARED discs, if there are any. Over `start`: plateau, plateau_error, and plateau_low, plateau_high, the
    packing fractions at its ends (see `plateau`). Over `shown` (of the last start): g(distance), S(wave_x,
    wave_y), and of the last frame x, y and angle, the argument of psi_6, over `particle`; positions in units
    of the diameter.
    """
    compared = [point for point in points if point.scene.count == COMPARED]
    points = [point for point in points if point not in compared]
    dataset = _states(points, _hexatic)
    unlike = dataset["pressure"].max("start") - dataset["pressure"].min("start")
    sides = [_plateau(dataset.isel(start=k), unlike) for k in range(dataset.sizes["start"])]
    for k, name in enumerate(("plateau", "plateau_error", "plateau_low", "plateau_high")):
        dataset[name] = ("start", np.array([side[k] for side in sides]))
    chosen = {start: _of_start(points, start) for start in dataset["start"].values}
    last = chosen[dataset["start"].values[-1]]
    dataset = dataset.merge(_pictures(last, settings), combine_attrs="no_conflicts")
    return dataset.merge(_compared(compared)) if compared else dataset


def freezing_spheres(points: list[Point], settings: dict) -> xr.Dataset:
    """Z and Q_6 of spheres against packing fraction from both starts, and coexisting crystal and fluid.

    settings: none. Returns over `start` and `packing_fraction`: see `_states`, the order being the global
    Q_6; crystalline, 1 if it stayed above CRYSTAL_ORDER; Z and Z_error of the infinite system (first order
    in 1/N subtracted), finite_size, reference (of the run's branch; NaN beyond its range). Of
    the slab: slab_pressure, slab_error, slab_drift, slab_drift_error; over `half` and `position` its
    profiles of local order (slab_order) and number density (slab_density); over `half` crystal_fraction.
    """
    slabs = [point for point in points if point.settings.get("arrangement") == "slab"]
    bulk = [point for point in points if point not in slabs]
    dataset = _states(bulk, structure.global_steinhardt)
    dataset["crystalline"] = (dataset["order"] > CRYSTAL_ORDER).astype(int)
    dataset = dataset.assign(_branches(dataset))
    return dataset.merge(_slab(slabs), combine_attrs="no_conflicts")


def _of_start(points: list[Point], start: str) -> dict[float, Point]:
    """Points of one start by packing fraction, ascending."""
    found = {
        round(point.scene.packing_fraction, 9): point
        for point in points
        if STARTS[point.settings["arrangement"]] == start
    }
    return dict(sorted(found.items()))


def _read(run: Run, order: Callable[[np.ndarray, Sequence[float]], float]) -> Series:
    """That of a periodic container; `order(positions, lengths)` is one number of a frame."""
    scene, frames = run.scene, run.data["coordinates"].values[1:]
    density = scene.number_density * (2.0 * scene.largest_radius) ** scene.dimension
    measured = np.array([order(frame, scene.container.lengths) for frame in frames])
    return Series(density * series_of(run).z, measured, density)


def _hexatic(frame: np.ndarray, lengths: Sequence[float]) -> float:
    """|mean psi_6| of a frame."""
    return abs(structure.hexatic(frame, lengths).mean())


def _halves(series: np.ndarray) -> tuple[float, float, float, float]:
    """Mean, its error, second half minus first, and the error of that: a run in equilibrium has none."""
    mean, middle = correlated_mean(series).estimate, len(series) // 2
    return mean.value, mean.error, series[middle:].mean() - series[:middle].mean(), 2.0 * mean.error


def _states(points: list[Point], order: Callable[[np.ndarray, Sequence[float]], float]) -> xr.Dataset:
    """Pressure and order of all starts and packing fractions (NaN where there is no run), replicas averaged.

    Returns over `start` and `packing_fraction`: pressure (k_B T / sigma^d), order, their _error, _drift and
    _drift_error; over `packing_fraction`: count, density (1 / sigma^d) and disagreement: the largest of the
    deviations, in standard errors, between the two starts and between the halves of each run, of pressure and
    order. More than 3 shows that the runs are not in equilibrium.
    """
    by_start = {start: _of_start(points, start) for start in STARTS.values()}
    by_start = {start: chosen for start, chosen in by_start.items() if chosen}
    eta = sorted({x for chosen in by_start.values() for x in chosen})
    names = ("", "_error", "_drift", "_drift_error")
    shape = (len(by_start), len(eta))
    table = {f"{what}{name}": np.full(shape, np.nan) for what in ("pressure", "order") for name in names}
    count, density = np.zeros(len(eta), dtype=int), np.zeros(len(eta))
    for i, chosen in enumerate(by_start.values()):
        for x, point in chosen.items():
            j = eta.index(x)
            replicas = [_read(run, order) for run in runs(point)]
            count[j], density[j] = point.scene.count, replicas[0].density
            for what in ("pressure", "order"):
                parts = np.array([_halves(getattr(one, what)) for one in replicas])
                for k, name in enumerate(names):
                    column = parts[:, k]
                    error = "error" in name
                    value = np.sqrt(np.sum(column**2)) / len(replicas) if error else column.mean()
                    table[f"{what}{name}"][i, j] = value
    both = ("start", "packing_fraction")
    dataset = xr.Dataset(
        {name: (both, values) for name, values in table.items()},
        coords={"start": list(by_start), "packing_fraction": eta},
    )
    dataset["count"], dataset["density"] = ("packing_fraction", count), ("packing_fraction", density)
    dataset["pressure"].attrs["units"] = "k_B T / sigma^d"
    return dataset.assign(disagreement=_disagreement(dataset))


def _disagreement(dataset: xr.Dataset) -> xr.DataArray:
    worst = []
    for what in ("pressure", "order"):
        value, error = dataset[what], dataset[f"{what}_error"]
        worst.append((abs(dataset[f"{what}_drift"]) / dataset[f"{what}_drift_error"]).max("start"))
        if dataset.sizes["start"] == 2:
            worst.append(abs(value.diff("start")).isel(start=0) / np.sqrt((error**2).sum("start")))
    return xr.concat(worst, "what").max("what")


def _compared(points: list[Point]) -> xr.Dataset:
    """The pressures of points that are compared with published ones."""
    names = [f"pressure{name}" for name in ("", "_error", "_drift", "_drift_error")]
    new = {name: f"compared_{name}" for name in (*names, "packing_fraction")}
    return _states(points, _hexatic)[names].rename(new)


def _plateau(side: xr.Dataset, unlike: xr.DataArray) -> tuple[float, float, float, float]:
    """The plateau of one start. A point's uncertainty holds half of its drift and of how `unlike` the
    starts are: a run out of equilibrium is uncertain."""
    side = side.assign(unlike=unlike).dropna("packing_fraction", subset=["pressure"])
    parts = side["pressure_error"], 0.5 * side["pressure_drift"], 0.5 * side["unlike"]
    error = np.sqrt(sum(part.values**2 for part in parts))
    pressure, uncertainty, (large, small) = plateau(
        1.0 / side["density"].values, side["pressure"].values, error
    )
    area = np.pi / 4.0
    return pressure, uncertainty, area / large, area / small


def _pictures(chosen: dict[float, Point], settings: dict) -> xr.Dataset:
    """Structure at some packing fractions; lengths in diameters."""
    shown, rows = [x for x in chosen if any(abs(x - y) < 1e-6 for y in settings["shown"])], []
    for x in shown:
        point = chosen[x]
        scene = point.scene
        lengths = np.array(scene.container.lengths) / (2.0 * scene.largest_radius)
        with open_trajectory(point.replica_path(0)) as trajectory:
            first = point.schedule.equilibration_frames + 1
            frames = trajectory["coordinates"][first:].values / (2.0 * scene.largest_radius)
        angle = np.angle(structure.hexatic(frames[-1], lengths))
        g = structure.radial_distribution(frames, lengths, settings["bins"], settings["furthest"])
        rows.append((frames[-1], angle, g, structure.structure_factor(frames, lengths, settings["highest"])))
    # Wave vectors are those of each container, which shrinks with the packing fraction: kept by number.
    least = [min(row[3][axis].size for row in rows) // 2 for axis in (0, 1)]

    def inner(values: np.ndarray, *axes: int) -> np.ndarray:
        cut = [
            slice(values.shape[k] // 2 - least[a], values.shape[k] // 2 + least[a] + 1)
            for k, a in enumerate(axes)
        ]
        return values[tuple(cut)]

    return xr.Dataset(
        {
            "x": (("shown", "particle"), np.array([row[0][:, 0] for row in rows])),
            "y": (("shown", "particle"), np.array([row[0][:, 1] for row in rows])),
            "angle": (("shown", "particle"), np.array([row[1] for row in rows])),
            "g": (("shown", "distance"), np.array([row[2][1] for row in rows])),
            "wave_x": (("shown", "mode_x"), np.array([inner(row[3][0], 0) for row in rows])),
            "wave_y": (("shown", "mode_y"), np.array([inner(row[3][1], 1) for row in rows])),
            "structure_factor": (
                ("shown", "mode_x", "mode_y"),
                np.array([inner(row[3][2], 0, 1) for row in rows]),
            ),
        },
        coords={"shown": shown, "distance": rows[0][2][0]},
    )


def _branches(dataset: xr.Dataset) -> dict:
    """Z of the infinite system and the reference of its branch."""
    eta, count = dataset["packing_fraction"].values, dataset["count"].values
    fluid, crystal = np.full(eta.size, np.nan), np.full(eta.size, np.nan)
    inside = eta <= theory.HIGHEST_PACKING_FRACTION[3]
    fluid[inside] = theory.compressibility_factor(eta[inside], 3)
    above = eta >= theory.LOWEST_CRYSTAL[3]
    crystal[above] = theory.speedy_crystal(eta[above])
    shift = np.zeros(eta.size)
    for k in np.flatnonzero(inside):
        shift[k] = theory.finite_size_correction(eta[k], 3, int(count[k]), ensemble="canonical")
    solid = dataset["crystalline"] == 1
    both = dataset["pressure"].dims
    z = dataset["pressure"] / dataset["density"]
    finite = xr.where(solid, theory.crystal_finite_size_correction(z, dataset["count"]), shift + 0.0 * z)
    reference = xr.where(solid, crystal + 0.0 * z, fluid + 0.0 * z)
    return {
        "finite_size": finite.transpose(*both),
        "Z": (z - finite).transpose(*both),
        "Z_error": dataset["pressure_error"] / dataset["density"],
        "reference": reference.transpose(*both),
    }


def _slab(points: list[Point]) -> xr.Dataset:
    """Pressure and profiles of the containers with crystal and fluid side by side, replicas averaged."""
    (point,) = points
    scene = point.scene
    lengths, diameter = np.array(scene.container.lengths), 2.0 * scene.largest_radius
    axis = int(np.argmax(lengths))
    # A bin for each cell of the crystal, so that its layers fall into bins evenly.
    cell = (4.0 / theory.COEXISTENCE_DENSITY[3][1]) ** (1.0 / 3.0) * diameter
    bins = round(lengths[axis] / cell)
    grid = Grid.line(0.0, lengths[axis], bins)
    pressures, orders, densities, fractions = [], [], [], []
    for run in runs(point):
        pressures.append(series_of(run).z * scene.number_density * diameter**3)
        frames = run.data["coordinates"].values[1:]
        local = np.array([structure.local_steinhardt(frame, lengths) for frame in frames])
        place = grid.cells(frames[..., axis, None], inside=True)
        for half in np.array_split(np.arange(len(frames)), 2):
            found = grid.sums(place[half])
            orders.append(grid.sums(place[half], local[half]) / found)
            densities.append(found / len(half) * bins / scene.container.volume * diameter**3)
            fractions.append((local[half] > LOCAL_CRYSTAL).mean())
    parts = np.array([_halves(pressure) for pressure in pressures])
    replicas = len(parts)

    def halves(values: list) -> np.ndarray:
        return np.array(values).reshape(replicas, 2, -1).mean(axis=0)

    position = (np.arange(bins) + 0.5) * lengths[axis] / bins / diameter
    error, drift_error = (np.sqrt(np.sum(parts[:, k] ** 2)) / replicas for k in (1, 3))
    if replicas > 2:  # slow interfaces: the scatter of replicas shows what blocks of one run cannot
        error = max(error, mean_of(parts[:, 0]).error)
    return xr.Dataset(
        {
            "slab_pressure": parts[:, 0].mean(),
            "slab_error": error,
            "slab_drift": parts[:, 2].mean(),
            "slab_drift_error": drift_error,
            "slab_length": lengths[axis] / diameter,
            "slab_count": scene.count,
            "crystal_fraction": ("half", halves(fractions)[:, 0]),
            "slab_order": (("half", "position"), halves(orders)),
            "slab_density": (("half", "position"), halves(densities)),
        },
        coords={"position": position},
        attrs={"slab_packing_fraction": scene.packing_fraction},
    )
