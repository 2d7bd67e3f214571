"""Drift of runs: changes during the measured part that a steady state does not have.

A cubic polynomial is fitted to each series of n values. Its coefficients of the orthonormal Legendre
polynomials of degree 1 to 3 are compared with their standard errors in a steady state. Two properties
determine an error:

- The series: S / n is the variance of a coefficient if correlations are short. S is the spectrum at frequency
  0 of the series minus the polynomial, so the drift does not contribute to it.
- Theory: modes slower than the run look like a drift, and the series cannot show that they are fluctuations.
  So the variance is at least the variance of the slowest mode in the scene. Let s^2 be its variance in
  equilibrium, and T the length of the run. A mode that relaxes with the time tau contributes at most s^2
  min(r, 2 tau / T). An oscillation of the angular frequency omega contributes at most s^2 min(o, q) to degree
  j, with q = 4 (2 j + 1) / (omega T)^2. Here r and o are the maxima over tau and omega. In equilibrium s^2 is
  the total variance, so a coefficient has at most the variance o s^2.

The coefficients of replicas are averaged.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from gaspart.analysis.estimate import Estimate, concise
from gaspart.analysis.fluxes import particle_numbers
from gaspart.analysis.run import Run, Source, open_run
from gaspart.analysis.statistics import correlated_mean
from gaspart.scene.scene import Scene

LEAST_FRAMES = 32
"""Minimum number of frames for a test of drift."""
SIGNIFICANT = 3.0
"""Coefficient, in standard errors, above which a quantity drifts. By chance one of 370 coefficients exceeds
it, if its error is known; most errors are upper bounds.
"""
_EXCESS = 2.0
"""Standard deviation of the slow modes of grains and driven flows, in units of its value in equilibrium."""
_BLOCKS = 16
"""Number of blocks of a series with local fluctuations."""
_MOST_FRAMES = 400
"""Maximum number of frames that a test reads."""
_DEGREES = np.array([1, 2, 3])
_RELAXING = np.array([0.205, 0.121, 0.086])
"""Largest variance of a coefficient for exponential correlations of variance 1, at T / tau = 3, 6 and 9."""
_OSCILLATING = np.array([0.571, 0.471, 0.404])
"""Largest variance of a coefficient for an oscillation of variance 1, and for any correlations."""
_CONSTANT = 1e-6
"""Relative scatter below which a series counts as constant."""


@dataclass(frozen=True)
class Series:
    """Values of a run with the properties of their slowest fluctuations in a steady state.

    values : (T,), at equal time intervals.
    scatter : upper bound of the standard deviation of the slow modes; 0 without slow modes.
    relaxations : length of the run divided by the longest relaxation time.
    radians : phase through which the slowest oscillation passes in the run.
    thermal : True if `scatter` is an upper bound for all fluctuations.
    local : True if all other fluctuations are faster than a block. Differences of consecutive blocks show
        them. A sudden change, as of a crystal that melts, adds little to these differences.
    """

    values: np.ndarray
    scatter: float = 0.0
    relaxations: float = math.inf
    radians: float = math.inf
    thermal: bool = False
    local: bool = False

    @property
    def slow_variances(self) -> np.ndarray:
        """Variances of the coefficients due to the slowest modes."""
        relaxing = np.minimum(_RELAXING, 2.0 / self.relaxations)
        oscillating = np.minimum(_OSCILLATING, 4.0 * (2.0 * _DEGREES + 1.0) / self.radians**2)
        return np.asarray(self.scatter**2 * np.maximum(relaxing, oscillating))


@dataclass(frozen=True)
class Trend:
    """Coefficients of a series by degree, from 1 to 3, and the means of both halves."""

    coefficients: Estimate
    halves: tuple[float, float]


def drift_of(*sources: Source, start: float | None = None) -> str:
    """Describe the quantities that drift in the measured part of a run or of replicas. The text is "" if none
    drifts.
    """
    return describe([trends(source, start) for source in sources])


def describe(runs: Sequence[dict[str, Trend]]) -> str:
    """Describe the quantities that drift on average over the `trends` of replicas; "" if none drifts."""
    names = [name for name in runs[0] if all(name in run for run in runs)]
    return "; ".join(filter(None, (_describe(name, [run[name] for run in runs]) for name in names)))


def _describe(name: str, replicas: list[Trend]) -> str:
    coefficients = [trend.coefficients for trend in replicas]
    mean = sum(coefficients[1:], coefficients[0]) / len(replicas)
    beyond = np.abs(mean.deviation)
    if not (beyond > SIGNIFICANT).any():
        return ""
    if beyond[0] <= SIGNIFICANT:
        return f"{name} sways more than in equilibrium"
    error = math.sqrt(2.0) * float(mean.error[0])  # the error of a half of uncorrelated values
    first, second = (concise(float(half), error) for half in np.mean([t.halves for t in replicas], axis=0))
    return f"{name} drifts from {first} in the first half to {second} in the second"


def trends(source: Source, start: float | None = None) -> dict[str, Trend]:
    """Return the trend of each tested quantity in the measured part of a run. The quantities are the number
    of particles, if faces are open; the kinetic energy of a particle, and of a particle of each species; the
    mean position along each axis with walls; and the collision rate at constant temperature.
    """
    with open_run(source, start, sheared=True, varying=True) as run:
        if len(run.time) < LEAST_FRAMES:
            return {}
        stride = -(-len(run.time) // _MOST_FRAMES)
        run = Run(run.scene, run.time[::stride], run.data.isel(frame=slice(None, None, stride)))
        excess = 1.0 if is_thermal(run.scene) else _EXCESS
        tested = {
            name: trend_of(replace(series, scatter=excess * series.scatter))
            for name, series in _series(run).items()
        }
    return {name: trend for name, trend in tested.items() if trend is not None}


def trend_of(series: Series) -> Trend | None:
    """Return the trend of a series, or None for a constant series."""
    values = series.values
    if not np.isfinite(values).all() or np.ptp(values) <= _CONSTANT * np.abs(values).max():
        return None
    fit = np.polynomial.Legendre.fit(np.arange(len(values)), values, int(_DEGREES[-1]))
    rest = correlated_mean(values - fit(np.arange(len(values))), fitted=len(fit.coef)).estimate
    seen, freedom, slow = rest.error**2, np.full(3, rest.freedom), series.slow_variances
    if series.local:
        steps = np.diff([block.mean() for block in np.array_split(values, _BLOCKS)])
        seen, freedom = 0.5 * float((steps**2).mean()) / _BLOCKS, np.full(3, 2.0 / 3.0 * len(steps))
    freedom[slow >= seen] = math.inf
    variances = np.maximum(seen, slow)
    if series.thermal:
        most = series.scatter**2 * _OSCILLATING
        freedom[variances >= most] = math.inf
        variances = np.minimum(variances, most)
    first, second = (float(half.mean()) for half in np.array_split(values, 2))
    coefficients = fit.coef[1:] / np.sqrt(2.0 * _DEGREES + 1.0)
    return Trend(Estimate(coefficients, np.sqrt(variances), freedom), (first, second))


def _series(run: Run) -> dict[str, Series]:
    """Return the tested series by name."""
    scene, duration = run.scene, float(run.time[-1] - run.time[0])
    count = np.full(len(run.time), max(1, scene.moving_count), dtype=float)
    if scene.is_open:
        count = np.maximum(particle_numbers(scene, run.data), 1.0)
    energy = run.data["kinetic_energy"].values / count
    slow = {axis: duration / np.array(times) for axis, times in _slowest(run, count, energy).items()}
    relaxations, radians = np.min(list(slow.values()), axis=0) if slow else (math.inf, math.inf)
    number, thermal = float(count.mean()), is_thermal(scene)
    series: dict[str, Series] = {}
    if scene.is_open:
        series["the number of particles"] = Series(count, math.sqrt(number), relaxations, thermal=thermal)
    scatter = exchange_scatter(scene, number) * float(energy.mean())
    swaying = radians if any(scene.gravity or ()) or scene.moving_axes else math.inf
    # energy that contacts take and nothing returns only falls
    known = thermal if scatter > 0.0 else scene.dissipates
    kinetic = Series(energy, scatter, relaxations, swaying, known)
    series["the kinetic energy of a particle"] = kinetic
    if run.has_states:
        series |= _of_particles(run, slow, number, thermal)
    if not scene.is_open and energy.min() > 0.0:
        per_time = run.increments("collisions") / np.diff(run.time) / number
        rate = per_time / np.sqrt(0.5 * (energy[1:] + energy[:-1]))
        relative = 4.0 / number if scene.mixture is not None else 1.0 / math.sqrt(number)
        title = "the collision rate divided by the thermal speed"
        scatter, local = relative * float(rate.mean()), scene.mixture is not None
        series[title] = Series(rate, scatter, relaxations, radians, local=local)
    return series


def is_thermal(scene: Scene) -> bool:
    """Return True if the steady state fluctuates about as much as equilibrium."""
    moved = scene.thermostat is not None or scene.shear_rate is not None or bool(scene.driven_axes)
    return not (moved or scene.dissipates or any(face.moves for face in scene.faces.values()))


def exchange_scatter(scene: Scene, number: float) -> float:
    """Return an upper bound of the relative standard deviation of the energy in equilibrium."""
    walls = any(wall.temperature is not None for wall in scene.walls)
    varies = scene.faces or walls or scene.has_piston or scene.vibrates or scene.thermostat is not None
    varies = varies or any(scene.gravity or ())
    return math.sqrt(2.0 / (scene.dimension * number)) if varies else 0.0


def _of_particles(run: Run, slow: dict[int, np.ndarray], count: float, thermal: bool) -> dict[str, Series]:
    """Return the energies of species and the mean positions along axes with walls."""
    scene, axes = run.scene, run.scene.walled_axes
    moving = np.ones(run.count, dtype=bool) if scene.is_open else run.moving
    numbers, masses = run.species[moving], run.masses[moving]
    groups = [numbers == number for number in np.unique(numbers)] if not scene.is_open else []
    groups = groups if len(groups) > 1 else []
    if not axes and not groups:
        return {}
    rows = []
    for _, part in run.parts():
        positions, squares = part.positions[:, moving], (part.velocities[:, moving] ** 2).sum(axis=2)
        present = np.isfinite(positions)
        number = np.maximum(present[..., 0].sum(axis=1), 1)
        means = [np.where(present, positions**power, 0.0).sum(axis=1) / number[:, None] for power in (1, 2)]
        energies = [0.5 * (squares * masses)[:, group].mean(axis=1) for group in groups]
        rows.append(np.array([mean[:, axis] for mean in means for axis in axes] + energies))
    values, k = np.concatenate(rows, axis=1), len(axes)
    series: dict[str, Series] = {}
    for n, axis in enumerate(axes):
        if axis not in slow:
            continue
        spread = math.sqrt(max(0.0, float((values[k + n] - values[n] ** 2).mean())))
        if axis in scene.moving_axes:  # the whole gas expands
            spread = 2.0 * scene.container.lengths[axis] / math.sqrt(12.0)
        scatter = spread / math.sqrt(count)
        series[f"the mean position along {'xyz'[axis]}"] = Series(
            values[n], scatter, slow[axis][0], slow[axis][1], thermal
        )
    met = 2.0 * float(run.growth("collisions")) / count * float(run.time[-1] - run.time[0])
    isolated = exchange_scatter(scene, count) == 0.0
    axial = math.inf if isolated else min((axis[0] for axis in slow.values()), default=math.inf)
    for group, energy in zip(groups, values[2 * k :], strict=True):
        ratio, size = float(masses[group].mean() / masses[~group].mean()), int(group.sum())
        exchanged = met * 4.0 * ratio / (1.0 + ratio) ** 2
        share = 1.0 - size / count if isolated else 1.0
        scatter = float(energy.mean()) * math.sqrt(2.0 * share / (scene.dimension * size))
        name = f"the kinetic energy of a particle of species {run.species[moving][group][0]}"
        series[name] = Series(energy, scatter, min(axial, exchanged), thermal=thermal)
    return series


def _slowest(run: Run, count: np.ndarray, energy: np.ndarray) -> dict[int, tuple[float, float]]:
    """Return the longest relaxation time and inverse angular frequency along each axis. These are the axes
    with walls or, without walls, all axes. The slowest mode is half a wave between walls, or a wave, with the
    wavenumber k. It relaxes like diffusion with the coefficient k_B T / (m nu), where nu is the collision
    rate, and oscillates at least with k sqrt(k_B T / m). A piston makes the oscillation slower. A face of
    accommodation a exchanges energy in one of 1 / a hits.
    """
    scene = run.scene
    kinds = scene.moving_kinds
    number = sum(kind.count for kind in kinds)
    mass = sum(kind.count * kind.mass for kind in kinds) / max(1, number)
    speed = math.sqrt(2.0 * float(energy.mean()) / (scene.dimension * (mass or 1.0)))
    if speed == 0.0:
        return {}
    rate = 2.0 * float(run.growth("collisions")) / float(count.mean())
    load = max([face.mass or 0.0 for _, face in scene.pistons], default=0.0)
    if scene.moving_wall:
        load = scene.moving_wall.mass
    hits = 1.0 / min((face.accommodation or 1.0 for _, face in scene.partial_faces), default=1.0)
    slowest = {}
    for axis in scene.walled_axes or range(scene.dimension):
        walled = axis in scene.walled_axes
        crossing = scene.container.lengths[axis] / ((math.pi if walled else 2.0 * math.pi) * speed)
        relaxing = crossing * (math.pi * hits if hits > 1.0 else 1.0) + crossing**2 * rate
        slowest[axis] = relaxing, crossing * math.sqrt(1.0 + math.pi**2 * load / max(number * mass, 1e-300))
    return slowest
