"""Particle speeds: relaxation from equal speeds, and distribution in equilibrium.

Speeds are given as u = v / sqrt(<v^2>), so that the root-mean-square speed is 1. At fixed energy this is the
unit of the sources (initially all speeds are 1, and the temperature is 1/d). The number of collisions per
particle, s = 2 N_collisions / N, is counted.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import xarray as xr

from gaspart import theory
from gaspart.analysis.flow import Grid
from gaspart.analysis.statistics import histogram_chi_square, mean_of
from gaspart.errors import SceneError
from gaspart.reproduction.families.shared.runs import runs
from gaspart.reproduction.points.point import Point
from gaspart.reproduction.table import table
from gaspart.scene.gas import plain_gas
from gaspart.scene.scene import Scene


@dataclass(frozen=True)
class Velocities:
    """Velocities in a run of T frames, N particles, d axes.

    time : (T,), times.
    collisions : (T,), collisions per particle since the start.
    velocities : (T, N, d), in single precision as stored.
    temperature : (T,), temperature. Between walls it is 2 E / (d N), from the energy in double precision.
    """

    time: np.ndarray
    collisions: np.ndarray
    velocities: np.ndarray
    temperature: np.ndarray

    @property
    def speeds(self) -> np.ndarray:
        """Speeds (T, N) divided by the root-mean-square speed, in double precision."""
        square = np.einsum("tnd,tnd->tn", self.velocities, self.velocities, dtype=float)
        return np.sqrt(square / square.mean(axis=1, keepdims=True))


def read(point: Point, first: int | None = None) -> list[Velocities]:
    """Return the velocities in all replicas of a point.

    The velocities are from frames after equilibration; if `first` is passed, from this frame on.
    """
    return [
        Velocities(
            time=run.time,
            collisions=2.0 * run.data["collisions"].values / run.count,
            velocities=run.data["velocities"].values,
            temperature=run.temperatures,
        )
        for run in runs(point, first)
    ]


def kurtosis(speeds: np.ndarray) -> np.ndarray:
    """Compute <u^4> / <u^2>^2 over the last axis (exact definition); 1 for equal speeds."""
    square = speeds**2
    return (square**2).mean(axis=-1) / square.mean(axis=-1) ** 2


def never_hit(velocities: np.ndarray) -> np.ndarray:
    """Compute the fraction (T,) of particles that no particle has hit since the first frame.

    A wall only changes the sign of a velocity component. If only walls hit a particle, all |v_k| keep their
    bits. A collision changes all components (with probability 1).
    """
    return (np.abs(velocities) == np.abs(velocities[0])).all(axis=-1).mean(axis=-1)


def shared_error(samples: list[np.ndarray]) -> list[np.ndarray]:
    """Compute standard errors of the means over axis 0 of groups of runs, (R_g, ...) each.

    All runs have the same physics. The groups are assumed to have equal scatter. It is estimated from all
    groups, about their own means, because a group of few runs has no good estimate. The number of runs must
    exceed the number of groups.
    """
    freedom = sum(len(group) for group in samples) - len(samples)
    if freedom < 1:
        raise ValueError(f"samples: {len(samples)} groups (at least one must have two runs)")
    squares = sum(((group - group.mean(axis=0)) ** 2).sum(axis=0) for group in samples)
    return [np.sqrt(squares / freedom / len(group)) for group in samples]


def shared_means(samples: list[np.ndarray]) -> list[tuple[np.ndarray, np.ndarray]]:
    """Compute the mean over axis 0 of each group of runs, and its error.

    See `shared_error`.
    """
    return [(group.mean(axis=0), error) for group, error in zip(samples, shared_error(samples), strict=True)]


def speed_relaxation(points: list[Point], settings: dict) -> xr.Dataset:
    """Measure kurtosis, fraction never hit and histogram during relaxation from equal speeds.

    The final distribution is Maxwell's. There is one point for each engine, with equal scene and sampling.
    The settings are `times` of the histograms (each must be a sampled time), and `bins` of the histograms up
    to the speed `highest` (in units of the root-mean-square speed).

    The dimensions are engine, frame, snapshot, bin. Errors are errors of the mean over replicas, from the
    scatter of all runs, with their degrees of freedom. Raises SceneError if the points differ, or a time is
    not sampled.
    """
    groups = [read(point, first=0) for point in points]
    scene, time = points[0].scene, groups[0][0].time
    _require_alike(points, groups)
    frames = np.array([_frame_at(time, chosen) for chosen in settings["times"]])
    grid = Grid.line(0.0, settings["highest"], settings["bins"])
    numbers = [[_relaxing(run, grid, frames) for run in group] for group in groups]
    means = {
        name: shared_means([np.stack([replica[name] for replica in group]) for group in numbers])
        for name in numbers[0][0]
    }

    def row(engine: int) -> dict[str, Any]:
        return {"replicas": len(groups[engine]), **{name: means[name][engine] for name in means}}

    over_time = dict.fromkeys(("collisions", "kurtosis", "never_hit", "temperature_drift"), ("frame",))
    inner = {**over_time, "density": ("snapshot", "bin")}
    dataset = table("engine", range(len(groups)), row, inner=inner, units={}, of=points)
    freedom = sum(len(group) - 1 for group in groups)
    return (
        dataset.assign({f"{name}_freedom": freedom for name in means})
        .assign_coords(
            engine=[point.settings.get("engine", "event") for point in points],
            time=("frame", time, {"units": "scene time"}),
            shown=("snapshot", frames, {"units": "1", "long_name": "frame of each histogram"}),
            **_bins(grid),
        )
        .assign_attrs(
            dimension=scene.dimension,
            count=scene.count,
            packing_fraction=scene.packing_fraction,
            collision_rate=_rate_between_walls(scene, groups[0][0].temperature[0]),
        )
    )


def _relaxing(run: Velocities, grid: Grid, frames: np.ndarray) -> dict[str, Any]:
    """Return the numbers of a run, named as in `speed_relaxation`."""
    speeds = run.speeds
    fourth = kurtosis(speeds)
    return {
        "collisions": run.collisions,
        "kurtosis": fourth,
        "never_hit": never_hit(run.velocities),
        "density": np.stack([_density(frame, grid) for frame in speeds[frames]]),
        "temperature_drift": np.abs(run.temperature / run.temperature[0] - 1.0),
        "initial_slope": _initial_slope(run.collisions, fourth),
    }


def _bins(grid: Grid) -> dict[str, Any]:
    """Return the coordinates of a histogram."""
    edges, units = grid.edges[0], {"units": "root-mean-square speed"}
    return {"lower": ("bin", edges[:-1], units), "upper": ("bin", edges[1:], units)}


def _require_alike(points: list[Point], groups: list[list]) -> None:
    """Raise SceneError unless all points have the scene and times of the first point.

    Each point has a group of runs.
    """
    scene, time = points[0].scene, groups[0][0].time
    for point, group in zip(points, groups, strict=True):
        if point.scene != scene or any(
            run.time.shape != time.shape or not np.allclose(run.time, time) for run in group
        ):
            raise SceneError(
                f"experiments.{point.experiment}", point.name, "must be the others' scene and times"
            )


def _rate_between_walls(scene: Scene, temperature: float) -> float:
    """Compute the collision rate per particle of a dilute gas in a container.

    The centres are confined to the container.

    The result is Enskog's rate times (N - 1) / N, because a particle has N - 1 partners, times a probability.
    This is the probability that the partner in a collision, at distance sigma in the direction n, also lies
    within the walls. It is the mean over n of prod_k (1 - sigma |n_k| / L_k), to first order in sigma / L,
    with <|n_k|> = 1/2 in 3D and 2/pi in 2D. To this order the result is exact for a dilute gas, whose density
    is uniform up to the walls.
    """
    diameter = 2.0 * scene.largest_radius
    accessible = [upper - lower for lower, upper in zip(*scene.reach(scene.largest_radius), strict=True)]
    fraction = float(scene.packing_fraction * np.prod(scene.container.lengths) / np.prod(accessible))
    mean_cosine = {2: 2.0 / np.pi, 3: 0.5}[scene.dimension]
    share = 1.0 - mean_cosine * sum(
        diameter / length
        for length, periodic in zip(accessible, scene.container.periodic, strict=True)
        if not periodic
    )
    share *= (scene.count - 1) / scene.count
    return float(theory.collision_rate(fraction, scene.dimension, diameter, temperature) * share)


def _frame_at(time: np.ndarray, chosen: float) -> int:
    frame = int(np.argmin(np.abs(time - chosen)))
    if abs(time[frame] - chosen) > 1e-6 * max(1.0, abs(chosen)):
        raise SceneError("figures.speed_relaxation.times", chosen, "must be a sampled time")
    return frame


def _density(speeds: np.ndarray, grid: Grid) -> np.ndarray:
    """Compute the fraction of the speeds in each bin, divided by the width.

    Speeds beyond the last edge are part of the norm.
    """
    return grid.sums(grid.cells(speeds[..., None])) / speeds.size / grid.volume


def _initial_slope(s: np.ndarray, values: np.ndarray) -> float:
    """Fit the initial slope dK/ds by a cubic through K(0) = 1.

    The fit is by least squares, to the frames up to s = 1.5.
    """
    early = (s > 0.0) & (s <= 1.5)
    design = s[early, None] ** np.arange(1, 4)
    return float(np.linalg.lstsq(design, values[early] - 1.0, rcond=None)[0][0])


def speed_distribution_spheres(points: list[Point], settings: dict) -> xr.Dataset:
    """Measure the distribution of speeds in equilibrium in 3D; see `distribution`."""
    return distribution(points, settings)


def speed_distribution_discs(points: list[Point], settings: dict) -> xr.Dataset:
    """Measure the distribution of speeds in equilibrium in 2D; see `distribution`."""
    return distribution(points, settings)


def distribution(points: list[Point], settings: dict) -> xr.Dataset:
    """Measure speeds in equilibrium, compared with Maxwell's distribution without a fit.

    All snapshots and replicas are used. Snapshots are the frames after equilibration. `collisions_between` is
    the number of collisions per particle between snapshots; they are independent samples from about 3 on. The
    settings are `bins` of the histogram up to the speed `highest` (in units of the root-mean-square speed),
    and `classes` of equal probability for chi-square.

    Fluctuations of the kurtosis decay like its mean, exp(-rate s). The error of the kurtosis includes the
    resulting correlation of successive snapshots.

    The dimensions are point, bin, and step (of the cumulative distribution). The temperature follows from the
    conserved energy. Therefore <u^2> = 1 exactly in every snapshot, which removes one degree of freedom from
    chi-square.
    """
    dimension = points[0].settings["dimension"]
    grid = Grid.line(0.0, settings["highest"], settings["bins"])
    steps = np.linspace(0.0, settings["highest"], 201)
    common = dimension, grid, steps, settings["classes"]
    inner = {**dict.fromkeys(("density", "expected", "residual"), ("bin",)), "difference": ("step",)}
    dataset = table("point", points, _distribution, *common, inner=inner, units={}).assign_coords(
        **_bins(grid), speed=("step", steps, {"units": "root-mean-square speed"})
    )
    return dataset.assign_attrs(dimension=dimension)


def _distribution(
    point: Point, dimension: int, grid: Grid, steps: np.ndarray, classes: int
) -> dict[str, Any]:
    """Return the numbers of one point.

    Speeds are divided by the root-mean-square speed; Maxwell's temperature is then 1/d.
    """
    temperature = 1.0 / dimension
    replicas = read(point)
    speeds = np.concatenate([run.speeds.ravel() for run in replicas])
    cumulative = lambda u: theory.maxwell_cdf(u, dimension, temperature)  # noqa: E731
    chance = np.diff(cumulative(grid.edges[0]))
    width = grid.volume
    share = _density(speeds, grid) * width
    deviation = np.sqrt(chance * (1.0 - chance) / speeds.size)
    test = histogram_chi_square(speeds, cumulative, classes)
    ordered = np.sort(speeds)
    fourth = mean_of(np.concatenate([kurtosis(run.speeds) for run in replicas]))
    between = min(float(np.diff(run.collisions).min()) for run in replicas)
    memory = np.exp(-theory.KURTOSIS_RELAXATION_RATE[dimension] * between)
    energy = np.concatenate([run.temperature for run in replicas])
    scene = point.scene
    return {
        "density": (share / width, deviation / width),
        "expected": chance / width,
        "residual": (share - chance) / deviation,
        "difference": np.searchsorted(ordered, steps, side="right") / speeds.size - cumulative(steps),
        "kolmogorov_distance": _kolmogorov_distance(cumulative(ordered)),
        "chi_square": test.chi_square,
        "degrees_of_freedom": test.degrees_of_freedom - 1,
        "kurtosis": (fourth.value, fourth.error * np.sqrt((1.0 + memory) / (1.0 - memory))),
        "samples": speeds.size,
        "snapshots": sum(len(run.time) for run in replicas),
        "replicas": len(replicas),
        "temperature": float(energy.mean()),
        "temperature_spread": float(np.ptp(energy)),
        "given_temperature": _given_temperature(point),
        "collisions_before": min(float(run.collisions[0]) for run in replicas),
        "collisions_between": between,
        "collisions_in_all": float(np.mean([run.collisions[-1] for run in replicas])),
        "engine": point.settings.get("engine", "event"),
        "count": scene.count,
        "packing_fraction": scene.packing_fraction,
    }


def _given_temperature(point: Point) -> float:
    """Return the temperature of a gas whose particles all have the same prescribed speed.

    This temperature has no statistical error.
    """
    if "speed" not in point.settings:
        rule = "is required: all particles start with it"
        raise SceneError(f"experiments.{point.experiment}.speed", None, rule)
    return plain_gas(point.scene).temperature


def _kolmogorov_distance(cumulative: np.ndarray) -> float:
    """Compute the largest |empirical - theoretical| cumulative probability.

    `cumulative` is the theoretical probability at the samples.
    """
    count = len(cumulative)
    above = np.arange(1, count + 1) / count - cumulative
    below = cumulative - np.arange(count) / count
    return float(max(above.max(), below.max()))
