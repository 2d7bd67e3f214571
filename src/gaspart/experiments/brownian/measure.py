"""A large particle among small ones: its paths, its mean-squared displacement, its friction.

The scene's first particle is the tracked one; its gas is the first species. Theory's time is that of the
friction: 1 / `friction`, from the actual gas density, outside the large particle.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
import xarray as xr

from gaspart import theory
from gaspart.analysis.correlations import correlate
from gaspart.analysis.statistics import bootstrap, means_of
from gaspart.errors import SceneError
from gaspart.experiments.shared.rows import from_rows
from gaspart.planning import grid
from gaspart.trajectory.run import open_trajectory

LONGEST = 8.0
"""Friction times up to which curves are taken."""
FRICTION_TO, DIFFUSION_AT = 0.5, 5.0
"""Friction times up to which the velocity autocorrelation gives the friction, from all lags, and at which the
msd gives the diffusion."""


@dataclass(frozen=True)
class Setting:
    """Theory's predictions for a point. share: the large particle's part of all mass where momentum is
    conserved (all axes periodic), else 0."""

    mass: float
    gas_mass: float
    radius: float
    temperature: float
    contact: float
    friction: float
    diffusion: float
    share: float
    mean_free_path: float


def setting_of(point: grid.Point) -> Setting:
    """The setting of a point's scene; SceneError for one that has not one particle and one species."""
    scene, where = grid.scene(point), f"experiments.{point.experiment}.scene"
    if len(scene.bodies) != 1 or len(scene.species) != 1:
        raise SceneError(where, point.settings.get("scene"), "must have one entry of bodies and one species")
    body, gas = scene.bodies[0], scene.species[0]
    temperature = gas.temperature
    if temperature is None:
        temperature = gas.mass * (gas.speed or 0.0) ** 2 / 3.0
    contact = body.radius + gas.radius
    lower, upper = scene.reach(gas.radius)
    room = math.prod(b - a for a, b in zip(lower, upper, strict=True))
    density = gas.count / (room - theory.body_volume(3, 2.0 * contact))
    friction = float(theory.friction_rate(density, contact, body.mass, gas.mass, temperature))
    conserved = all(scene.container.periodic)
    return Setting(
        mass=body.mass,
        gas_mass=gas.mass,
        radius=body.radius,
        temperature=temperature,
        contact=contact,
        friction=friction,
        diffusion=float(theory.tagged_diffusion(friction, body.mass, gas.mass, temperature)),
        share=body.mass / (body.mass + gas.count * gas.mass) if conserved else 0.0,
        mean_free_path=1.0 / (math.sqrt(2.0) * math.pi * density * (2.0 * gas.radius) ** 2),
    )


def _followed(point: grid.Point) -> Iterator[tuple[np.ndarray, np.ndarray, np.ndarray]]:
    """Of each replica: times (T,), displacements and velocities of the first particle (T, 1, 3)."""
    if not point.settings.get("displacements", False):
        raise SceneError(f"experiments.{point.experiment}.displacements", False, "must be true")
    for path in point.replica_paths:
        with open_trajectory(path) as dataset:
            yield (
                dataset["time"].values.astype(float),
                dataset["displacements"].values[:, :1, :3],
                dataset["velocities"].values[:, :1, :3].astype(float),
            )


def brownian_paths(points: list[grid.Point], settings: dict) -> xr.Dataset:
    """The first `paths` ways of each point, and how far all of its replicas have come in the end.

    Lengths are the scene's. `end_chi_square`: of the components of all ends, each over the variance of the
    Langevin equation from rest, in which the share of the gas counts, as in `brownian_msd`, with its drift of
    mean square (1 - share) share k_B T / M along each axis (its momentum is drawn with the velocities).
    Dimensions point, path, frame, axis.
    """
    rows = []
    for point in points:
        setting = setting_of(point)
        found = list(_followed(point))
        ends = np.array([moved[-1, 0] for _, moved, _ in found])
        duration = float(found[0][0][-1])
        rest = 1.0 - setting.share
        variance = theory.langevin_msd_from_rest(
            duration, rest**2 * setting.diffusion, setting.friction / rest, dimension=1
        )
        variance += rest * setting.share * setting.temperature / setting.mass * duration**2
        shown = np.array([moved[:, 0] for _, moved, _ in found[: settings["paths"]]])
        rows.append(
            {
                **_facts(point, setting),
                "duration": duration,
                "way": shown,
                "end_variance": float(variance),
                "end_chi_square": float((ends**2).sum() / variance),
                "end_freedom": ends.size,
            }
        )
    return from_rows("point", rows, ("path", "frame", "axis"))


def brownian_msd(points: list[grid.Point], settings: dict) -> xr.Dataset:
    """Mean-squared displacement and velocity autocorrelation of the large particle, and the quantities
    derived from them.

    In a periodic container the gas as a whole drifts, and absorbs the momentum that the particle loses:
    with `share` s and friction g the correlation is (k_B T / M)(1 - s)(exp(-g' t) + s), g' = g / (1 - s).
    The constant part is subtracted from correlation and msd; what follows is brought to an infinite gas:
    `equipartition` is M <V^2> / (3 k_B T (1 - s)), `measured_friction` (1 - s) times the decay rate, the
    slope of ln C until FRICTION_TO, `measured_diffusion` D times the msd at DIFFUSION_AT over that of the
    Langevin equation. `equal_speeds` and `stepped`: of the gas at the start, and by the time-stepped engine.

    Dimensions point, lag: `time` in 1 / g', `vacf` in (1 - s) k_B T / M, `msd` in 6 (1 - s) k_B T / (M g'^2).
    Errors: standard errors over replicas (bootstrap for the numbers).
    """
    return from_rows("point", [_statistics(point) for point in points], ("lag",))


def _statistics(point: grid.Point) -> dict:
    setting = setting_of(point)
    rest = 1.0 - setting.share
    rate, drop = setting.friction / rest, grid.schedule(point).equilibration_frames
    curves = []
    for time, moved, velocities in _followed(point):
        interval = (time[-1] - time[0]) / (len(time) - 1)
        lags = min(math.ceil(LONGEST / (rate * interval)), (len(time) - drop) // 2) + 1
        curves.append(correlate(moved[drop:], velocities[drop:], interval, lags))
    time = rate * curves[0].time
    if time[-1] < DIFFUSION_AT:
        longer = math.ceil(2.0 * DIFFUSION_AT / rate)
        where = f"experiments.{point.experiment}[{point.name}].duration"
        raise SceneError(where, point.settings.get("duration"), f"must be {longer} or more")
    equilibrium = setting.temperature / setting.mass
    drift = rest * setting.share * equilibrium
    vacf = np.array([one.correlation for one in curves]) - drift
    msd = np.array([one.msd for one in curves]) - 3.0 * drift * curves[0].time ** 2
    late = int(np.argmin(np.abs(time - DIFFUSION_AT)))
    early = time[1 : max(2, np.searchsorted(time, FRICTION_TO) + 1)]
    langevin = float(theory.langevin_msd(time[late], setting.diffusion, 1.0)) * rest**2 / rate
    both = np.concatenate([vacf[:, : early.size + 1], msd[:, [late]]], axis=1)

    def decay(x: np.ndarray) -> float:
        """Slope of the line through -ln C / C(0), which is 0 at the first lag."""
        logarithm = np.log(x[:, 1:-1].mean(axis=0) / x[:, 0].mean())
        return -float(early @ logarithm / (early @ early))

    derived = {
        "equipartition": lambda x: x[:, 0].mean() / (rest * equilibrium),
        "measured_friction": lambda x: rest * rate * decay(x),
        "measured_diffusion": lambda x: x[:, -1].mean() / langevin * setting.diffusion,
    }
    estimates = {name: bootstrap(function, both) for name, function in derived.items()}
    vacf, vacf_error = means_of(vacf / (rest * equilibrium))
    msd, msd_error = means_of(msd * rate**2 / (6.0 * rest * equilibrium))
    return {
        **_facts(point, setting),
        "time": time,
        "msd": msd,
        "msd_error": msd_error,
        "vacf": vacf,
        "vacf_error": vacf_error,
        **{name: one.value for name, one in estimates.items()},
        **{f"{name}_error": one.error for name, one in estimates.items()},
        **{f"{name}_freedom": one.freedom for name, one in estimates.items()},
    }


def _facts(point: grid.Point, setting: Setting) -> dict:
    """The columns of every row."""
    return {
        "equal_speeds": grid.scene(point).species[0].speed is not None,
        "stepped": point.settings.get("engine") == "step",
        "replicas": point.replicas,
        **vars(setting),
    }
