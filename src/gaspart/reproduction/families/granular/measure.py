"""Measurements of rough, inelastic and driven gases.

The first part is on rough and inelastic gases: energy of rotation and translation, Haff's cooling, clusters.

Time is measured in collisions per particle, s = 2 N_coll / N. Temperatures are energies per degree of
freedom: T_tr = m <v^2> / d in the frame of the centre of mass (for N - 1 particles), and T_rot = I <w^2>.
Their unit is T_tr at the start of the run.

The second part is on the steady state of inelastic gases that random kicks heat.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import xarray as xr

from gaspart import theory
from gaspart.analysis.estimate import Estimate
from gaspart.analysis.flow import Grid
from gaspart.analysis.run import Run
from gaspart.analysis.statistics import average, bootstrap, correlated_mean, fit_polynomial, mean_of, means_of
from gaspart.errors import SceneError
from gaspart.reproduction.families.shared.runs import runs
from gaspart.reproduction.points.point import Point
from gaspart.reproduction.table import table
from gaspart.scene.restitution import Restitution
from gaspart.trajectory.reading import open_trajectory

# Runs of rough and inelastic gases: temperatures against collisions.


@dataclass(frozen=True)
class Temperatures:
    """Temperatures in T frames of a run: time, collisions per particle, T_tr, T_rot (T,); first T_tr."""

    time: np.ndarray
    collisions: np.ndarray
    translation: np.ndarray
    rotation: np.ndarray
    start: float


def temperatures(run: Run, first: int) -> Temperatures:
    """Return the temperatures in all frames of a run, for particles from number `first` on.

    These particles are identical.
    """
    count, dimension, mass = run.count, run.dimension, run.scene.species[0].mass
    translation, rotation = run.temperatures, np.zeros(len(run.time))
    if run.scene.rough:  # for smooth particles the file may contain only one frame of spins
        total = mass * (run.velocities**2).sum(axis=(1, 2))
        rotation = (2.0 * run.data["kinetic_energy"].values - total) / ({2: 1, 3: 3}[dimension] * count)
    return Temperatures(
        time=run.time[first:],
        collisions=2.0 * run.data["collisions"].values[first:] / count,
        translation=translation[first:] / translation[0],
        rotation=rotation[first:] / translation[0],
        start=float(translation[0]),
    )


def read(point: Point) -> list[Temperatures]:
    """Return the temperatures in all replicas of a point, after equilibration."""
    first = point.schedule.equilibration_frames
    return [temperatures(run, first) for run in runs(point, first=0)]


def law(point: Point) -> Restitution:
    """Return the collision law of a point's scene."""
    return point.scene.restitution or Restitution()


def inertia(point: Point) -> float:
    """Return q = I / (m R^2) of a point's only species.

    The default is the value of a uniform disc or sphere.
    """
    kind = point.scene.species[0]
    if kind.moment_of_inertia is None:
        return {2: 0.5, 3: 0.4}[point.scene.dimension]
    return kind.moment_of_inertia / (kind.mass * kind.radius**2)


RELAXED = 3.0
"""Collisions per particle after which an inelastic gas has its own velocity distribution, instead of
Maxwell's."""

MIXING, MIXED = 0.5, 1.6
"""Reduced times t sqrt(k_B T / m) / h between rough walls at a distance h. Up to MIXING, energy passes into
spins at a rate that depends on the moment of inertia. From MIXED on, the difference of temperatures is below
1 %."""


def equipartition(points: list[Point], settings: dict) -> xr.Dataset:
    """Measure equipartition of rough discs, and its violation by dissipation.

    In points whose container has walls, particles hit only these. The other points belong to three groups.
    Points with a tangential restitution below 1 are `cooling`. Of the rest, points with an equilibration are
    in `equilibrium`; points without it are a `start` without spins. The setting is `steady_from`; see
    `_cooling`.

    collisions, translation, rotation : collisions per particle; temperatures with errors (`start`, `frame`)
    inertia, rate : q = I / (m R^2); initial decay rate of T_tr - T_rot per collision, with error (`start`)
    equilibrium_inertia, equilibrium_ratio : q and T_rot / T_tr with error, over `equilibrium`
    cooling_collisions, cooling_ratio : collisions per particle; T_rot / T_tr (`cooling`, `step`)
    tangential, cooling_inertia, steady_ratio : restitution; q; steady ratio with error (`cooling`)
    wall_time, wall_translation, wall_rotation : time and temperatures with errors, over `walls` and `moment`
    wall_dimension, wall_inertia, exchange, wall_ratio : see `_walls`; the last two with errors, over `walls`
    """
    between = [point for point in points if not point.scene.is_periodic]
    points = [point for point in points if point not in between]
    rough = [point for point in points if law(point).tangential == 1.0]
    cooled = [point for point in points if point not in rough]
    still = [point for point in rough if point.schedule.equilibration_frames]
    start = [point for point in rough if point not in still]
    return xr.merge([
        table("start", start, _start, inner=("frame",), units={}),
        table("equilibrium", still, _equilibrium, units={}),
        table("cooling", cooled, _cooling, settings["steady_from"], inner=("step",), units={}),
        table("walls", between, _walls, inner=("moment",), units={}),
    ], join="outer", compat="no_conflicts")  # fmt: skip


def _start(point: Point) -> dict[str, Any]:
    replicas = read(point)
    samples = np.stack([[run.collisions, run.translation, run.rotation] for run in replicas])
    rate = bootstrap(lambda chosen: _initial_decay(*chosen.mean(axis=0)), samples, repeats=200)
    return {
        "collisions": samples[:, 0].mean(axis=0),
        "inertia": inertia(point),
        "translation": means_of(samples[:, 1]),
        "rotation": means_of(samples[:, 2]),
        "translation_freedom": len(replicas) - 1,
        "rotation_freedom": len(replicas) - 1,
        "rate": rate,
    }


def _initial_decay(collisions: np.ndarray, translation: np.ndarray, rotation: np.ndarray) -> float:
    """Fit the initial decay of ln (T_tr - T_rot) by a parabola in s.

    The fit ends when the difference is a fifth of its initial value. The noise of the difference is nearly
    the same at all s.
    """
    difference = translation - rotation
    used = (difference > 0.2) & (collisions > 0.0)
    logarithm = -np.log(difference[used])
    return float(fit_polynomial(collisions[used], logarithm, 1.0 / difference[used], powers=(1, 2)).values[0])


def _equilibrium(point: Point) -> dict[str, Any]:
    """Measure T_rot / T_tr from the mean energies in a run of conserved energy.

    Errors are computed from blocks, because frames may be correlated.
    """
    replicas = read(point)
    mean = average([correlated_mean(run.rotation).estimate for run in replicas])
    translation = float(np.mean([run.translation.mean() for run in replicas]))
    ratio = mean.value / translation
    # The energy 2 (N-1) T_tr + N T_rot is conserved: if one temperature is higher, the other is lower.
    error = mean.error / mean.value * ratio * (1.0 + 0.5 * ratio)
    return {
        "equilibrium_inertia": inertia(point),
        "equilibrium_ratio": Estimate(ratio, error, mean.freedom),
    }


def _cooling(point: Point, steady_from: float) -> dict[str, Any]:
    """Measure the ratio of the mean temperatures in each frame, and the average ratio.

    The temperatures are means over replicas. The average is over frames later than `steady_from` collisions
    per particle.
    """
    replicas = read(point)
    collisions = np.mean([run.collisions for run in replicas], axis=0)
    late = collisions > steady_from
    # Later frames are colder: each frame is normalised by its own temperature.
    weights = 1.0 / np.mean([run.translation for run in replicas], axis=0)[late]
    samples = np.stack([[run.rotation[late] * weights, run.translation[late] * weights] for run in replicas])
    steady = bootstrap(lambda chosen: np.divide(*chosen.mean(axis=(0, 2))), samples, repeats=200)
    rotation = np.mean([run.rotation for run in replicas], axis=0)
    return {
        "tangential": law(point).tangential,
        "cooling_inertia": inertia(point),
        "cooling_collisions": collisions,
        "cooling_ratio": rotation / np.mean([run.translation for run in replicas], axis=0),
        "steady_ratio": steady,
    }


def _walls(point: Point) -> dict[str, Any]:
    """Measure temperatures between two rough walls, relative to T_par at the start.

    T_par = m <v^2> for each direction along the walls. T_rot = I <w^2> for each spin component that a hit
    changes. There are as many such components as directions. `exchange` is the ratio of T_rot to theory, from
    a least-squares fit until MIXING. `wall_ratio` is T_rot / T_par after MIXED, divided by theory.
    `wall_time` is t sqrt(k_B T / m) / h.
    """
    scene = point.scene
    kind, along = scene.species[0], np.array(scene.container.periodic)
    if kind.temperature is None:
        raise SceneError(
            f"experiments.{point.experiment}.scene", None, "must state the particles' temperature"
        )
    (gap,) = np.array(scene.container.lengths)[~along] - 2.0 * kind.radius
    samples = []
    for run in runs(point):
        squares = (run.velocities**2).sum(axis=1)
        rotation = 2.0 * run.data["kinetic_energy"].values - kind.mass * squares.sum(axis=1)
        time = run.time * np.sqrt(kind.temperature / kind.mass) / gap
        translation = kind.mass * squares[:, along].sum(axis=1)
        samples.append(np.stack([translation, rotation]) / translation[0])
    expected = 0.5 * (1.0 - theory.rough_wall_difference(time, inertia(point)))
    early, late = time <= MIXING, time >= MIXED
    weights = expected[early] / (expected[early] @ expected[early])
    ratio = expected[late].sum() / (1.0 - expected[late]).sum()
    mean, error = means_of(samples)
    return {
        "wall_dimension": scene.dimension,
        "wall_inertia": inertia(point),
        "wall_time": time,
        "wall_translation": (mean[0], error[0]),
        "wall_rotation": (mean[1], error[1]),
        "exchange": bootstrap(lambda chosen: weights @ chosen.mean(axis=0)[1, early], samples),
        "wall_ratio": bootstrap(
            lambda chosen: np.divide(*chosen[:, ::-1, late].mean(axis=(0, 2))) / ratio, samples
        ),
    }


def cooling(points: list[Point], settings: dict) -> xr.Dataset:
    """Measure Haff's law in dilute inelastic gases, and its violation in a dense large gas.

    The settings are `clustering`, the experiments of the dense gas, and `cells_per_side`, the number of cells
    along each side of its container.

    collisions, time, temperature : per particle; in Haff's t_H; with error (`gas`, `frame`)
    dimension, restitution : properties of a gas, over `gas`
    rate : -d ln T / ds per replica, between `RELAXED` and the end, with error, over `gas`
    exponent : exponent of T against 1 + t / t_H, with error, over `gas`
    cluster_collisions : collisions per particle, over `clusters` and `step`
    cluster_excess : T divided by exp(-rate s) of theory, with error, over `clusters` and `step`
    variance : variance of the particle number in a cell over its mean, with error (`clusters`, `step`)
    cluster_restitution : restitution, over `clusters`
    x, y : positions at the end of one run with the smallest restitution, over `particle`

    The attributes of the dataset are side and radius.
    """
    apart = [point for point in points if point.experiment in settings["clustering"]]
    dilute = [point for point in points if point not in apart]
    gases = table("gas", dilute, _gas, inner=("frame",), units={})
    clusters = table("clusters", apart, _clusters, settings["cells_per_side"], inner=("step",), units={})
    most_inelastic = min(apart, key=lambda point: law(point).normal)
    return xr.merge(
        [gases, clusters, _picture(most_inelastic)],
        join="outer",
        compat="no_conflicts",
        combine_attrs="drop_conflicts",
    )


def _gas(point: Point) -> dict[str, Any]:
    scene, replicas = point.scene, read(point)
    restitution, dimension, kind = law(point).normal, scene.dimension, scene.species[0]
    rates, exponents, times = [], [], []
    for run in replicas:
        frequency = theory.collision_rate(
            scene.packing_fraction, dimension, 2.0 * kind.radius, run.start, kind.mass
        )
        times.append(run.time / theory.haff_time(restitution, dimension, float(frequency)))
        late = np.flatnonzero(run.collisions >= RELAXED)
        first, logarithm = late[0], np.log(run.translation)
        rates.append((logarithm[first] - logarithm[-1]) / (run.collisions[-1] - run.collisions[first]))
        exponents.append(np.polyfit(np.log1p(times[-1][late]), logarithm[late], 1)[0])
    return {
        "dimension": dimension,
        "count": scene.count,
        "restitution": restitution,
        "collisions": np.mean([run.collisions for run in replicas], axis=0),
        "time": np.mean(times, axis=0),
        "temperature": means_of([run.translation for run in replicas]),
        "rate": mean_of(rates),
        "exponent": mean_of(exponents),
    }


def _clusters(point: Point, cells: int) -> dict[str, Any]:
    scene, replicas = point.scene, read(point)
    collisions = np.mean([run.collisions for run in replicas], axis=0)
    restitution = law(point).normal
    rate = theory.cooling_rate(restitution, scene.dimension)
    # Logarithms are averaged: after so many collisions, replicas differ by large factors.
    excess, relative = means_of([np.log(run.translation) + rate * run.collisions for run in replicas])
    return {
        "cluster_restitution": restitution,
        "cluster_collisions": collisions,
        "cluster_excess": (np.exp(excess), np.exp(excess) * relative),
        "variance": means_of([_number_variance(run, cells) for run in runs(point)]),
    }


def _number_variance(run: Run, cells: int) -> np.ndarray:
    """Compute the variance (T,) of the particle number in a cell, divided by its mean.

    The ratio is 1 for independent particles.
    """
    lengths = run.scene.container.lengths
    grid = Grid((0.0,) * len(lengths), lengths, (cells,) * len(lengths))
    # In single precision, a particle close to the upper boundary may lie on the boundary itself.
    where = grid.cells(run.positions, inside=True)
    counts = grid.sums(where, blocks=np.arange(len(where))).reshape(len(where), grid.size)
    return counts.var(axis=1) / counts.mean(axis=1)


def _picture(point: Point) -> xr.Dataset:
    with open_trajectory(point.replica_path(0)) as trajectory:
        positions = trajectory["coordinates"][-1].values
    units = {"units": "scene length"}
    return xr.Dataset(
        {"x": ("particle", positions[:, 0], units), "y": ("particle", positions[:, 1], units)},
        attrs={"side": point.scene.container.lengths[0], "radius": point.scene.largest_radius},
    )


def means(run: Run) -> dict[str, float]:
    """Compute averages of a run.

    temperature : m <v^2> / d in the frame of the centre of mass, averaged over the frames.
    cumulant : d <v^4> / ((d + 2) <v^2>^2) - 1 of all velocities in these frames.
    given, lost : power per particle that kicks supply, and that collisions dissipate.
    """
    squares, dimension = (run.peculiar**2).sum(axis=2), run.dimension
    # computed in each frame, so that fluctuations of the temperature do not contribute
    second = squares.mean(axis=1)
    fourth = (squares**2).mean(axis=1)
    return {
        "temperature": run.temperature,
        "cumulant": float(dimension * fourth.mean() / ((dimension + 2) * (second**2).mean()) - 1.0),
        "given": float(run.growth("thermostat_energy")) / run.count,
        "lost": float(run.growth("dissipated_energy")) / run.count,
    }


def driven_gas(points: list[Point], settings: dict) -> xr.Dataset:
    """Measure the steady temperature and the fourth cumulant of driven gases.

    Variables over `gas` are dimension, restitution, packing_fraction, count and power. The variables
    temperature, cumulant, given and lost (see `means`) have errors from replicas.
    """
    units = {"temperature": "energy", **dict.fromkeys(("power", "given", "lost"), "energy / time")}
    return table("gas", points, _steady_state, units=units)


def _steady_state(point: Point) -> dict[str, Any]:
    scene = point.scene
    assert scene.restitution is not None and scene.thermostat is not None, "a driven granular gas"
    replicas = [means(run) for run in runs(point)]
    row = {
        "dimension": scene.dimension,
        "restitution": scene.restitution.normal,
        "packing_fraction": scene.packing_fraction,
        "count": scene.count,
        "power": scene.thermostat.power,
    }
    return row | {name: mean_of([replica[name] for replica in replicas]) for name in replicas[0]}
