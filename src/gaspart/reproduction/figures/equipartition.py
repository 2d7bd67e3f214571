"""Rough gases: energy of rotation and translation, in equilibrium, in cooling gases, and between rough walls.

Time is in collisions per particle, s = 2 N_coll / N. Temperatures are energies per degree of freedom over the
initial T_tr; T_tr = m <v^2> / d for N - 1 particles in the frame of the centre of mass, T_rot = I <w^2>.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
import xarray as xr

from gaspart import theory
from gaspart.analysis.run import Run
from gaspart.analysis.statistics import average, bootstrap, correlated_mean, fit_polynomial, means_of
from gaspart.errors import SceneError
from gaspart.keys import positive
from gaspart.rendering import style
from gaspart.rendering.style import Axes, Figure
from gaspart.reproduction.claims import Claim, Estimate
from gaspart.reproduction.figure import PARTICLES, SOURCE_C, Parts, runs
from gaspart.reproduction.points.point import Point
from gaspart.reproduction.table import Row, Table, table
from gaspart.scene.restitution import Restitution
from gaspart.theory.granular import (
    ROUGH_START_UNCERTAINTY,
    rough_cooling,
    rough_start_excess,
    rough_wall_difference,
)

TITLE, CHAPTER = "Granular gases", "Granular matter"
SETTINGS = {
    "steady_from": positive(
        "collisions per particle after which the ratio of temperatures of a cooling gas is steady"
    )
}
# Reduced times t sqrt(k_B T / m) / h between rough walls at a distance h: until the first, energy passes into
# spins at a rate that depends on q = I / (m R^2); from the second on, temperatures differ by less than 1 %.
MIXING, MIXED = 0.5, 1.6
# Error of T_tr - T_rot over the error of T_rot: 2 T_tr + T_rot is conserved, so both fluctuate alike.
DIFFERENCE = 1.5


class Temperatures:
    """Time, collisions, T_tr and T_rot (T,) of a run from frame `first` on; `start`, T_tr of its frame 0."""

    def __init__(self, run: Run, first: int) -> None:
        count, mass = run.count, run.scene.species[0].mass
        translation, rotation = run.temperatures, np.zeros(len(run.time))
        if run.scene.rough:  # for smooth particles the file may contain only one frame of spins
            total = mass * (run.velocities**2).sum(axis=(1, 2))
            spins = {2: 1, 3: 3}[run.dimension]
            rotation = (2.0 * run.data["kinetic_energy"].values - total) / (spins * count)
        self.time, self.collisions = run.time[first:], 2.0 * run.data["collisions"].values[first:] / count
        self.translation, self.rotation = (
            translation[first:] / translation[0],
            rotation[first:] / translation[0],
        )
        self.start = float(translation[0])


def read(point: Point) -> list[Temperatures]:
    """Return the temperatures in all replicas of a point, after equilibration."""
    first = point.schedule.equilibration_frames
    return [Temperatures(run, first) for run in runs(point, first=0)]


def law(point: Point) -> Restitution:
    """Return the collision law of a point's scene."""
    return point.scene.restitution or Restitution()


def inertia(point: Point) -> float:
    """Return q = I / (m R^2) of a point's only species, by default a uniform disc's or sphere's."""
    kind = point.scene.species[0]
    if kind.moment_of_inertia is None:
        return {2: 0.5, 3: 0.4}[point.scene.dimension]
    return kind.moment_of_inertia / (kind.mass * kind.radius**2)


def measure(points: list[Point], settings: dict) -> xr.Dataset:
    """Measure four groups of points. Particles of `walls` hit only rough walls. Points with a tangential
    restitution below 1 are `cooling`. Of the others, points with an equilibration are in `equilibrium`;
    points without it `start` without spins.
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
    return {
        "collisions": samples[:, 0].mean(axis=0),
        "inertia": inertia(point),
        "translation": means_of(samples[:, 1]),
        "rotation": means_of(samples[:, 2]),
        "translation_freedom": len(replicas) - 1,
        "rotation_freedom": len(replicas) - 1,
        "rate": bootstrap(lambda chosen: _initial_decay(*chosen.mean(axis=0)), samples, repeats=200),
    }


def _initial_decay(collisions: np.ndarray, translation: np.ndarray, rotation: np.ndarray) -> float:
    """Fit the initial decay of ln (T_tr - T_rot) by a parabola in s, until a fifth of the difference is left.
    The noise of the difference is nearly the same at all s.
    """
    difference = translation - rotation
    used = (difference > 0.2) & (collisions > 0.0)
    logarithm = -np.log(difference[used])
    return float(fit_polynomial(collisions[used], logarithm, 1.0 / difference[used], powers=(1, 2)).values[0])


def _equilibrium(point: Point) -> dict[str, Any]:
    replicas = read(point)
    mean = average([correlated_mean(run.rotation).estimate for run in replicas])
    ratio = mean.value / float(np.mean([run.translation.mean() for run in replicas]))
    # The energy 2 (N-1) T_tr + N T_rot is conserved: if one temperature is higher, the other is lower.
    error = mean.error / mean.value * ratio * (1.0 + 0.5 * ratio)
    return {
        "equilibrium_inertia": inertia(point),
        "equilibrium_ratio": Estimate(ratio, error, mean.freedom),
    }


def _cooling(point: Point, steady_from: float) -> dict[str, Any]:
    replicas = read(point)
    collisions = np.mean([run.collisions for run in replicas], axis=0)
    translation = np.mean([run.translation for run in replicas], axis=0)
    late = collisions > steady_from
    weights = 1.0 / translation[late]  # later frames are colder
    samples = np.stack([[run.rotation[late] * weights, run.translation[late] * weights] for run in replicas])
    return {
        "tangential": law(point).tangential,
        "cooling_inertia": inertia(point),
        "cooling_collisions": collisions,
        "cooling_ratio": np.mean([run.rotation for run in replicas], axis=0) / translation,
        "steady_ratio": bootstrap(
            lambda chosen: np.divide(*chosen.mean(axis=(0, 2))), samples, repeats=200
        ),
    }  # fmt: skip


def _walls(point: Point) -> dict[str, Any]:
    """Measure temperatures between two rough walls, over T_par at the start. T_par = m <v^2> for each
    direction along the walls, T_rot = I <w^2> for each of as many components of spin that a hit changes.
    `exchange` is T_rot over theory, by least squares until MIXING; `wall_ratio`, T_rot / T_par over theory
    after MIXED.
    """
    scene = point.scene
    kind, along = scene.species[0], np.array(scene.container.periodic)
    if kind.temperature is None:
        rule = "must state the particles' temperature"
        raise SceneError(f"experiments.{point.experiment}.scene", None, rule)
    (gap,) = np.array(scene.container.lengths)[~along] - 2.0 * kind.radius
    samples = []
    for run in runs(point):
        squares = (run.velocities**2).sum(axis=1)
        rotation = 2.0 * run.data["kinetic_energy"].values - kind.mass * squares.sum(axis=1)
        time = run.time * np.sqrt(kind.temperature / kind.mass) / gap
        translation = kind.mass * squares[:, along].sum(axis=1)
        samples.append(np.stack([translation, rotation]) / translation[0])
    expected = 0.5 * (1.0 - rough_wall_difference(time, inertia(point)))
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


BOLTZMANN = "homogeneous Boltzmann equation, direct simulation (tests/theory/homogeneous.py); "
STATISTICAL = "statistical, of the direct simulation"


def claims(dataset: xr.Dataset) -> Iterator[Claim]:
    """Yield the claims on equipartition at the known rate, and on the steady ratio of cooling gases."""
    for still in Table(dataset, "equilibrium"):
        yield Claim(
            f"T_rot / T_tr of rough discs in equilibrium, q = {still.equilibrium_inertia:g}",
            still.equilibrium_ratio, 1.0, 0.005,
            "equipartition (exact)", "contacts are not reversible, or exchange the wrong share of energy",
        )  # fmt: skip
    for gas in Table(dataset, "start"):
        yield from _decay(gas)
    for gas in Table(dataset, "cooling"):
        yield _steady(gas)
    for gas in Table(dataset, "walls"):
        which = f"{PARTICLES[gas.wall_dimension]} between rough walls, q = {gas.wall_inertia:g}"
        yield Claim(
            f"energy that the first hits turn into spin over theory's, {which}", gas.exchange, 1.0, 0.01,
            f"{SOURCE_C}, Eq. 40, without collisions: 4q/(1+q)^2 of the tangential energy at a "
            "particle's first hit (exact, gaspart.theory.rough_wall_difference)",
            "a wrong impulse or torque at walls",
        )  # fmt: skip
        yield Claim(
            f"T_rot / T_tr along the walls in the end over theory's, {which}", gas.wall_ratio, 1.0, 0.01,
            "the same: 1 within 0.003, equipartition without collisions, as hits at different times "
            "lose each other's phase",
            "hits that are not reversible, or turn velocity and spin by angles that repeat",
        )  # fmt: skip


def _decay(gas: Row) -> Iterator[Claim]:
    """Yield the claims on the initial decay without spins, and on the difference where theory's is largest.
    There the assumption of Maxwellian velocities is least accurate.
    """
    q = gas.inertia
    expected = 3.0 * q / (1.0 + q) ** 2
    frames = Table(gas.dataset, "frame")
    frames = frames[np.isfinite(frames.collisions)]  # without variables that only other points have
    beyond = np.asarray(rough_start_excess(q, frames.collisions))
    most = np.abs(np.nan_to_num(beyond)).argmax()
    at, is_computed = frames[most], np.isfinite(beyond[most])
    s, rotation = at.collisions, at.rotation
    excess = at.translation.value - rotation.value - np.exp(-expected * s)
    yield Claim(
        f"initial decay of T_tr - T_rot per collision of a particle over 3q/(1+q)^2, q = {q:g}",
        gas.rate / expected, 1.0, 0.01,
        "[Huthmann 1997]: averages over Maxwellian velocities and spins, computed in "
        "tests/theory/test_granular.py; exact at the start, where velocities are Maxwellian and all spins 0",
        "a wrong tangential impulse or torque",
    )  # fmt: skip
    yield Claim(
        f"T_tr - T_rot minus exp(-3q s/(1+q)^2) after {s:.2g} collisions of a particle, q = {q:g}",
        Estimate(excess, DIFFERENCE * rotation.error, rotation.freedom),
        Estimate(beyond[most], ROUGH_START_UNCERTAINTY) if is_computed else 0.0, 0.005,
        f"{BOLTZMANN}Maxwellian velocities and spins ([Huthmann 1997]) would give 0",
        "a gas that is not dilute, or energies that tend to other shares",
        allowance_source=STATISTICAL,
        no_verdict="" if is_computed else "the reference was not computed for this inertia",
    )  # fmt: skip


def _steady(gas: Row) -> Claim:
    q, tangential = gas.cooling_inertia, gas.tangential
    matches = [line for line in rough_cooling() if np.allclose(line[:3], (q, tangential, 1.0))]
    ratio, error = matches[0][3:] if matches else (theory.rough_ratio(q, tangential), 0.0)
    maxwell = theory.rough_ratio(q, tangential) / ratio
    return Claim(
        f"T_rot / T_tr of cooling discs over theory's, tangential {tangential:g}, q = {q:g}",
        gas.steady_ratio / ratio, Estimate(1.0, error / ratio), 0.03,
        f"{BOLTZMANN}Maxwellian velocities and spins ([Huthmann 1997]) would give {maxwell:.3f}",
        "a ratio that is not steady, or dissipation in the wrong place",
        allowance_source=STATISTICAL if matches else "",
        no_verdict="" if matches else "the reference was not computed for these coefficients",
    )  # fmt: skip


def draw(dataset: xr.Dataset) -> Figure:
    """Draw temperatures against collisions, differences from theory, steady ratios, and rough walls."""
    figure, (upper, middle, lower, walls) = style.new((2.3, 1.2), (2.0,), (2.0,))
    _temperatures(upper, middle, Table(dataset, "start"))
    _ratios(lower, Table(dataset, "cooling"), Table(dataset, "equilibrium"))
    _at_walls(walls, Table(dataset, "walls"))
    style.letters(upper, middle, lower, walls)
    return figure


def _temperatures(axis: Axes, below: Axes, gases: Table) -> None:
    """Draw temperatures, and below T_tr - T_rot - exp(-3 q s / (1 + q)^2) in per cent of the initial T_tr."""
    fine = np.linspace(0.0, 1.02 * np.nanmax(gases.collisions), 200)
    style.level(below, 0.0)
    for kind, gas in enumerate(gases):
        q, s = gas.inertia, gas.collisions
        for curve in theory.rough_temperatures(fine, q, 1.0):
            axis.plot(fine, curve, color=style.COLOURS[kind], zorder=1)
        style.points(axis, s, gas.translation, kind=kind, label=f"$q={q:g}$")
        style.points(axis, s, gas.rotation, kind=kind, hollow=True)
        expected = np.exp(-3.0 * q / (1.0 + q) ** 2 * s)
        excess = gas.translation.value - gas.rotation.value - expected
        style.points(below, s, 100.0 * excess, 100.0 * DIFFERENCE * gas.rotation.error, kind=kind)
    both = r"$T_\mathrm{tr}$ (filled), $T_\mathrm{rot}$ (hollow)"
    style.label_axes(axis, y=both, legend="lower right", xlim=(0.0, fine[-1]), ylim=(0.0, 1.05))
    style.label_axes(below, "collisions per particle $s$", "difference (%)")


def _ratios(axis: Axes, cooling: Table, equilibrium: Table) -> None:
    """Draw T_rot / T_tr against tangential restitution: theory, cooling discs, elastic discs."""
    curve = np.linspace(-0.99, 1.0, 200)
    for kind, (q, still) in enumerate(equilibrium.by("equilibrium_inertia")):
        theoretical = [theory.rough_ratio(q, tangential) for tangential in curve]
        axis.plot(curve, theoretical, color=style.COLOURS[kind], label=f"$q={q:g}$", zorder=1)
        cooled = cooling[np.isclose(cooling.cooling_inertia, q)]
        style.points(axis, cooled.tangential, cooled.steady_ratio, kind=kind)
        elastic = np.ones(len(still))
        style.points(axis, elastic, still.equilibrium_ratio, kind=kind, hollow=True, clip_on=False)
    computed = rough_cooling()
    computed = computed[np.isin(computed[:, 0], cooling.cooling_inertia)]
    axis.plot(computed[:, 1], computed[:, 3], "x", color=style.DATA, zorder=5, label="Boltzmann equation")
    axis.set(xlim=(-1.0, 1.0), xticks=np.linspace(-1.0, 1.0, 5), ylim=(0.0, 1.08))
    x, y = r"tangential restitution $\epsilon_\mathrm{t}$", r"steady $T_\mathrm{rot}/T_\mathrm{tr}$"
    style.label_axes(axis, x, y, legend="upper left")


def _at_walls(axis: Axes, gases: Table) -> None:
    fine = np.linspace(0.0, np.nanmax(gases.wall_time), 200)
    for kind, gas in enumerate(gases):
        label = rf"{PARTICLES[gas.wall_dimension]}, $q={gas.wall_inertia:g}$"
        difference = rough_wall_difference(fine, gas.wall_inertia)
        axis.plot(fine, 0.5 * (1.0 + difference), color=style.COLOURS[kind], zorder=1)
        style.points(axis, gas.wall_time, gas.wall_translation, kind=kind, label=label)
        axis.plot(fine, 0.5 * (1.0 - difference), color=style.COLOURS[kind], zorder=1)
        style.points(axis, gas.wall_time, gas.wall_rotation, kind=kind, hollow=True)
    x = r"time $t\,\sqrt{k_\mathrm{B}T/m}/h$ between rough walls"
    y = r"$T_\parallel$ (filled), $T_\mathrm{rot}$ (hollow)"
    style.label_axes(axis, x, y, legend="upper right", xlim=(0.0, fine[-1]), ylim=(0.0, 1.05))


FIGURES = {"equipartition": Parts(SETTINGS, measure, claims, draw)}
