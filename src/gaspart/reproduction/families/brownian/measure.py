"""A large particle among small ones: its paths, its mean-squared displacement, its friction.

The scene's first particle is the tracked one; its gas is the first species. Theory's time is the time of the
friction: 1 / `friction`, from the actual gas density, outside the large particle. A heavy particle is
expected to follow Langevin's equation, a particle that is not much heavier than a gas particle the linear
Boltzmann equation.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import xarray as xr

from gaspart import theory
from gaspart.analysis.estimate import Estimate
from gaspart.analysis.motion import Curves, correlate
from gaspart.analysis.statistics import bootstrap, means_of
from gaspart.errors import SceneError
from gaspart.reproduction.families.shared.runs import runs
from gaspart.reproduction.points.point import Point
from gaspart.reproduction.table import table
from gaspart.theory.boltzmann import relaxing_speeds, tagged_paths

# Theory of a large particle's motion, by Langevin's and by the linear Boltzmann equation.
#
# The latter is for a light particle.


HEAVY = 10.0
"""Mass divided by a gas particle's mass above which Langevin's equation is taken as exact.

It is exact for a sphere in the limit of a large ratio; the velocity autocorrelation of a particle of equal
mass decays 0.6 % more slowly up to half a friction time.
"""
GROUPS, MOST = 200, 300
"""Groups of paths of the linear Boltzmann equation, and the maximum number of paths in each.

Each group has as many paths as the point has replicas, up to MOST: the statistical error of theory is the
error of the measurement divided by sqrt(200), which is negligible, or the error of 60 000 paths.
"""
GAS = 100_000
"""Gas particles from whose speeds those that hit are drawn."""


@dataclass(frozen=True)
class BrownianMotion:
    """Theory's predictions for a point.

    `share` is the large particle's part of all mass where momentum is conserved (all axes periodic), else 0.
    """

    mass: float
    gas_mass: float
    radius: float
    temperature: float
    contact: float
    friction: float
    diffusion: float
    share: float
    mean_free_path: float

    @property
    def is_light(self) -> bool:
        """True if the particle is too light for Langevin's equation."""
        return self.mass <= HEAVY * self.gas_mass


def motion_of(point: Point) -> BrownianMotion:
    """Return the motion of a point's scene of one particle and one species.

    Raises SceneError for others.
    """
    scene, where = point.scene, f"experiments.{point.experiment}.scene"
    if len(scene.particles) != 1 or len(scene.species) != 1:
        raise SceneError(
            where, point.settings.get("scene"), "must have one entry of particles and one species"
        )
    particle, gas = scene.particles[0], scene.species[0]
    temperature = gas.initial_temperature(3)
    contact = particle.radius + gas.radius
    lower, upper = scene.reach(gas.radius)
    room = math.prod(b - a for a, b in zip(lower, upper, strict=True))
    density = gas.count / (room - theory.particle_volume(3, 2.0 * contact))
    friction = float(theory.friction_rate(density, contact, particle.mass, gas.mass, temperature))
    conserved = scene.is_periodic
    return BrownianMotion(
        mass=particle.mass,
        gas_mass=gas.mass,
        radius=particle.radius,
        temperature=temperature,
        contact=contact,
        friction=friction,
        diffusion=float(theory.tagged_diffusion(friction, particle.mass, gas.mass, temperature)),
        share=particle.mass / (particle.mass + gas.count * gas.mass) if conserved else 0.0,
        mean_free_path=1.0 / (math.sqrt(2.0) * math.pi * density * (2.0 * gas.radius) ** 2),
    )


def light_paths(point: Point, motion: BrownianMotion) -> Iterator[tuple[np.ndarray, np.ndarray, np.ndarray]]:
    """Yield paths of the linear Boltzmann equation from rest, in GROUPS.

    They are sampled as the point's runs: times (T,), displacements and velocities (T, N, 3). A gas of equal
    speeds relaxes by its own collisions meanwhile.
    """
    gas, times = point.scene.species[0], point.schedule
    frames = times.equilibration_frames + times.samples
    # n pi d^2, from the mean free path of Maxwell's gas, 1 / (sqrt(2) n pi d^2)
    own = 1.0 / (math.sqrt(2.0) * motion.mean_free_path)
    middle = times.sample_interval * (np.arange(frames) + 0.5)
    if gas.speed is not None:
        speeds = gas.speed * relaxing_speeds(GAS, gas.speed * middle, own)
    else:
        thermal = math.sqrt(motion.temperature / motion.gas_mass)
        even = (np.arange(GAS) + 0.5) / GAS
        speeds = [np.asarray(theory.maxwell_ppf(even, 3, thermal**2))] * frames
    hits = own * (motion.contact / (2.0 * gas.radius)) ** 2
    time = times.sample_interval * np.arange(frames + 1)
    size = min(point.replicas, MOST)
    ratio = motion.mass / motion.gas_mass
    paths = tagged_paths(speeds, times.sample_interval, hits, ratio, GROUPS * size)
    for group in np.split(np.arange(GROUPS * size), GROUPS):
        yield time, paths.displacements[:, group], paths.velocities[:, group]


LONGEST = 8.0
"""Friction times up to which curves are taken."""
FRICTION_TO, DIFFUSION_AT = 0.5, 5.0
"""Friction times up to which the velocity autocorrelation gives the friction, from all lags, and at which the
msd gives the diffusion."""
NAMES = {
    "equipartition": "equipartition",
    "friction": "measured_friction",
    "diffusion": "measured_diffusion",
}
"""Columns of the numbers that are derived from measured paths; `friction` and `diffusion` are theory's."""


def _read_paths(point: Point) -> Iterator[tuple[np.ndarray, np.ndarray, np.ndarray]]:
    """Yield times (T,) of each replica, displacements and velocities of its first particle (T, 1, 3)."""
    if not point.settings.get("displacements", False):
        raise SceneError(f"experiments.{point.experiment}.displacements", False, "must be true")
    for run in runs(point, first=0):
        velocities = run.data["velocities"].values[:, :1].astype(float)
        yield run.time, run.data["displacements"].values[:, :1], velocities


def brownian_paths(points: list[Point], settings: dict) -> xr.Dataset:
    """Measure the first `paths` paths of each point, and the final displacements of all replicas.

    Lengths are the scene's. `end_chi_square` is computed from the components of all ends, each divided by the
    variance that is expected from rest. The variance of the Langevin equation has the share of the gas, as in
    `brownian_msd`, with its drift of mean square (1 - share) share k_B T / M along each axis (its momentum is
    drawn with the velocities). Dimensions point, path, frame, axis.
    """
    return table("point", points, _ends, settings["paths"], inner=("path", "frame", "axis"))


def _ends(point: Point, paths: int) -> dict[str, Any]:
    motion, trajectories = motion_of(point), list(_read_paths(point))
    ends = np.array([moved[-1, 0] for _, moved, _ in trajectories])
    duration = float(trajectories[0][0][-1])
    variance = _end_variance(point, motion, duration)
    return _facts(point, motion) | {
        "duration": duration,
        "way": np.array([moved[:, 0] for _, moved, _ in trajectories[:paths]]),
        "end_variance": variance,
        "end_chi_square": float((ends**2).sum() / variance),
        "end_freedom": ends.size,
    }


def _end_variance(point: Point, motion: BrownianMotion, duration: float) -> float:
    """Compute the expected mean square of a component of the displacement at the end."""
    if motion.is_light:
        return float(np.mean([(moved[-1] ** 2).mean() for _, moved, _ in light_paths(point, motion)]))
    rest = 1.0 - motion.share
    variance = theory.langevin_msd_from_rest(
        duration, rest**2 * motion.diffusion, motion.friction / rest, dimension=1
    )
    return float(variance + rest * motion.share * motion.temperature / motion.mass * duration**2)


def brownian_msd(points: list[Point], settings: dict) -> xr.Dataset:
    """Measure the displacement and velocity autocorrelation of the large particle.

    Quantities derived from them are measured too.

    In a periodic container the gas as a whole drifts, and absorbs the momentum that the particle loses: with
    `share` s and friction g the correlation is (k_B T / M)(1 - s)(exp(-g' t) + s), g' = g / (1 - s). The
    constant part is subtracted from correlation and msd; what follows is brought to an infinite gas:
    `equipartition` is M <V^2> / (3 k_B T (1 - s)), `measured_friction` (1 - s) times the decay rate, the
    slope of ln C until FRICTION_TO, `measured_diffusion` D times the msd at DIFFUSION_AT divided by the msd
    of the Langevin equation. `equal_speeds` and `stepped` state properties of the gas at the start, and by
    the time-stepped engine. `expected_...` are the predictions of theory, with the statistical error of its
    direct simulation, if it is one.

    Dimensions point, lag: `time` in 1 / g', `vacf` in (1 - s) k_B T / M, `msd` in 6 (1 - s) k_B T / (M g'^2),
    `expected_vacf` and `expected_msd`. Errors: standard errors over replicas (bootstrap for the numbers).
    """
    return table("point", points, _statistics, inner=("lag",))


def _statistics(point: Point) -> dict[str, Any]:
    motion = motion_of(point)
    curves, estimates = _reduce_curves(point, motion, _read_paths(point))
    time, row = curves["time"], _facts(point, motion) | curves
    row |= {NAMES[name]: estimate for name, estimate in estimates.items()}
    if motion.is_light:
        infinite = replace(motion, share=0.0)
        predicted, expected = _reduce_curves(point, infinite, light_paths(point, motion))
        row |= {f"expected_{name}": predicted[name][0][: len(time)] for name in ("vacf", "msd")}
    else:
        row |= {"expected_vacf": np.exp(-time), "expected_msd": theory.langevin_msd(time, 1.0 / 6.0, 1.0)}
        exact = {"equipartition": 1.0, "friction": motion.friction, "diffusion": motion.diffusion}
        expected = {name: Estimate(value) for name, value in exact.items()}
    return row | {f"expected_{name}": estimate for name, estimate in expected.items()}


def _reduce_curves(
    point: Point, motion: BrownianMotion, paths: Iterable[tuple[np.ndarray, np.ndarray, np.ndarray]]
) -> tuple[dict[str, Any], dict[str, Estimate]]:
    """Compute the correlations of paths in reduced units, their errors, and derived quantities."""
    rest = 1.0 - motion.share
    rate, curves = motion.friction / rest, _curves(point, motion, paths)
    time = rate * curves[0].time
    if time[-1] < DIFFUSION_AT:
        longer = math.ceil(2.0 * DIFFUSION_AT / rate)
        where = f"experiments.{point.experiment}[{point.name}].duration"
        raise SceneError(where, point.settings.get("duration"), f"must be {longer} or more")
    equilibrium = motion.temperature / motion.mass
    drift = rest * motion.share * equilibrium
    vacf = np.array([curve.correlation for curve in curves]) - drift
    msd = np.array([curve.msd for curve in curves]) - 3.0 * drift * curves[0].time ** 2
    late = int(np.argmin(np.abs(time - DIFFUSION_AT)))
    early = time[1 : max(2, np.searchsorted(time, FRICTION_TO) + 1)]
    langevin = float(theory.langevin_msd(time[late], motion.diffusion, 1.0)) * rest**2 / rate
    both = np.concatenate([vacf[:, : early.size + 1], msd[:, [late]]], axis=1)

    def decay(x: np.ndarray) -> float:
        """Compute the slope of the line through -ln C / C(0).

        The line is 0 at the first lag.
        """
        logarithm = np.log(x[:, 1:-1].mean(axis=0) / x[:, 0].mean())
        return -float(early @ logarithm / (early @ early))

    derived = {
        "equipartition": lambda x: x[:, 0].mean() / (rest * equilibrium),
        "friction": lambda x: rest * rate * decay(x),
        "diffusion": lambda x: x[:, -1].mean() / langevin * motion.diffusion,
    }
    reduced = {
        "time": time,
        "msd": means_of(msd * rate**2 / (6.0 * rest * equilibrium)),
        "vacf": means_of(vacf / (rest * equilibrium)),
    }
    return reduced, {name: bootstrap(function, both) for name, function in derived.items()}


def _curves(
    point: Point, motion: BrownianMotion, paths: Iterable[tuple[np.ndarray, np.ndarray, np.ndarray]]
) -> list[Curves]:
    """Time correlations of each of the paths, after equilibration."""
    drop = point.schedule.equilibration_frames
    rate, curves = motion.friction / (1.0 - motion.share), []
    for time, moved, velocities in paths:
        interval = (time[-1] - time[0]) / (len(time) - 1)
        lags = min(math.ceil(LONGEST / (rate * interval)), (len(time) - drop) // 2) + 1
        curves.append(correlate(moved[drop:], velocities[drop:], interval, lags))
    return curves


def _facts(point: Point, motion: BrownianMotion) -> dict[str, Any]:
    """Return the columns of every row."""
    return {
        "equal_speeds": point.scene.species[0].speed is not None,
        "stepped": point.settings.get("engine") == "step",
        "replicas": point.replicas,
        "is_light": motion.is_light,
        **vars(motion),
    }
