"""Brownian motion of a large particle in a gas: paths, mean-squared displacement, friction.

The first particle of the scene is tracked. The gas is the first species. The unit of time in theory is the
friction time 1 / `friction`, computed from the actual gas density outside the large particle. A heavy
particle is compared with Langevin's equation. A particle not much heavier than a gas particle is compared
with the linear Boltzmann equation.
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

# Theory of a large particle's motion: Langevin's equation, and the linear Boltzmann equation for a light
# particle.


HEAVY = 10.0
"""Mass ratio (to a gas particle) above which Langevin's equation is taken as exact.

For a sphere, the equation is exact in the limit of a large mass ratio. At equal masses the velocity
autocorrelation decays 0.6 % more slowly, up to half a friction time.
"""
GROUPS, MOST = 200, 300
"""Number of groups of paths of the linear Boltzmann equation, and maximum number of paths per group.

Each group has as many paths as the point has replicas, up to MOST. The statistical error of theory is then
the error of the measurement divided by sqrt(200), which is negligible. If the point has more replicas than
MOST, the error is the error of 60 000 paths.
"""
GAS = 100_000
"""Number of gas particles from whose speeds the speeds of hitting particles are drawn."""


@dataclass(frozen=True)
class BrownianMotion:
    """Theory's predictions for a point.

    `share` is the large particle's mass divided by the total mass. It is 0 if momentum is not conserved, that
    is, unless all axes are periodic.
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
    """Return the Brownian motion in a point's scene of one particle and one species.

    Raises SceneError for other scenes.
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
    """Yield groups of paths of the linear Boltzmann equation that start at rest.

    The paths are sampled like the point's runs: times (T,), displacements and velocities (T, N, 3). A gas of
    equal speeds relaxes meanwhile, by its own collisions.
    """
    gas, times = point.scene.species[0], point.schedule
    frames = times.equilibration_frames + times.samples
    # n pi d^2, from the mean free path 1 / (sqrt(2) n pi d^2) of a gas with Maxwell's distribution
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
"""Length of the measured curves, in friction times."""
FRICTION_TO, DIFFUSION_AT = 0.5, 5.0
"""Friction times. The velocity autocorrelation up to FRICTION_TO gives the friction, from all lags. The
mean-squared displacement at DIFFUSION_AT gives the diffusion coefficient."""
NAMES = {
    "equipartition": "equipartition",
    "friction": "measured_friction",
    "diffusion": "measured_diffusion",
}
"""Columns of the numbers that are derived from measured paths. The columns `friction` and `diffusion` are
theory."""


def _read_paths(point: Point) -> Iterator[tuple[np.ndarray, np.ndarray, np.ndarray]]:
    """Yield times (T,), displacements and velocities (T, 1, 3) of the first particle, by replica."""
    if not point.settings.get("displacements", False):
        raise SceneError(f"experiments.{point.experiment}.displacements", False, "must be true")
    for run in runs(point, first=0):
        velocities = run.data["velocities"].values[:, :1].astype(float)
        yield run.time, run.data["displacements"].values[:, :1], velocities


def brownian_paths(points: list[Point], settings: dict) -> xr.Dataset:
    """Measure the first `paths` paths of each point, and the final displacements of all replicas.

    Lengths are in the scene's units. `end_chi_square` is computed from the components of all final
    displacements. Each component is divided by the variance that theory predicts for a particle that starts
    at rest. The variance of the Langevin equation is corrected for the share of the gas, as in
    `brownian_msd`. It includes the drift, with mean square (1 - share) share k_B T / M along each axis,
    because the momentum is drawn with the velocities. The dimensions are point, path, frame, axis.
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
    """Compute the expected mean square of a component of the final displacement."""
    if motion.is_light:
        return float(np.mean([(moved[-1] ** 2).mean() for _, moved, _ in light_paths(point, motion)]))
    rest = 1.0 - motion.share
    variance = theory.langevin_msd_from_rest(
        duration, rest**2 * motion.diffusion, motion.friction / rest, dimension=1
    )
    return float(variance + rest * motion.share * motion.temperature / motion.mass * duration**2)


def brownian_msd(points: list[Point], settings: dict) -> xr.Dataset:
    """Measure the displacement and velocity autocorrelation of the large particle.

    Numbers derived from these curves are measured too.

    In a periodic container the gas as a whole drifts, and absorbs the momentum that the particle loses. Let s
    be `share` and g the friction. Then the velocity autocorrelation is (k_B T / M)(1 - s)(exp(-g' t) + s),
    with g' = g / (1 - s). The constant part is subtracted from the autocorrelation and from the mean-squared
    displacement (msd). The results are converted to an infinite gas:

    equipartition : M <V^2> / (3 k_B T (1 - s))
    measured_friction : (1 - s) times the decay rate, which is the slope of ln C until FRICTION_TO
    measured_diffusion : D times the msd at DIFFUSION_AT, divided by the msd of the Langevin equation
    equal_speeds, stepped : properties of the gas at the start, and use of the time-stepped engine
    expected_... : predictions of theory, with a statistical error if they are computed by direct simulation

    Curves over point and lag are `time` in 1 / g', `vacf` in (1 - s) k_B T / M, `msd` in 6 (1 - s) k_B T / (M
    g'^2), `expected_vacf` and `expected_msd`. Errors are standard errors over replicas. Errors of derived
    numbers are computed by bootstrap.
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
    """Compute time correlations in reduced units, their errors, and derived numbers."""
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
        """Compute the slope of a line through -ln C / C(0).

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
    """Compute the time correlations of each path, after equilibration."""
    drop = point.schedule.equilibration_frames
    rate, curves = motion.friction / (1.0 - motion.share), []
    for time, moved, velocities in paths:
        interval = (time[-1] - time[0]) / (len(time) - 1)
        lags = min(math.ceil(LONGEST / (rate * interval)), (len(time) - drop) // 2) + 1
        curves.append(correlate(moved[drop:], velocities[drop:], interval, lags))
    return curves


def _facts(point: Point, motion: BrownianMotion) -> dict[str, Any]:
    """Return the columns that every row has."""
    return {
        "equal_speeds": point.scene.species[0].speed is not None,
        "stepped": point.settings.get("engine") == "step",
        "replicas": point.replicas,
        "is_light": motion.is_light,
        **vars(motion),
    }
