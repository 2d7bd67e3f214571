"""Particle speeds: relaxation from equal speeds, and distribution in equilibrium.

Speeds are u = v / sqrt(<v^2>): at fixed energy the unit of the sources, where all speeds are 1 at first and
the temperature is 1/d. Time is counted in collisions per particle, s = 2 N_collisions / N.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike

from gaspart import theory
from gaspart.analysis.flow import Grid
from gaspart.analysis.run import Run
from gaspart.analysis.statistics import histogram_chi_square, mean_of
from gaspart.errors import SceneError
from gaspart.keys import POSITIVE, count, list_of, positive
from gaspart.rendering import style
from gaspart.rendering.style import Axes, Figure
from gaspart.reproduction.claims import Claim, Estimate
from gaspart.reproduction.figure import Blocks, Parts, kurtosis, runs
from gaspart.reproduction.points.point import Point
from gaspart.reproduction.table import Row, Table, table
from gaspart.scene.facts import plain_gas
from gaspart.scene.scene import Scene
from gaspart.theory.speeds import (
    ENTROPY_UNCERTAINTY,
    RELAXATION_UNCERTAINTY,
    Energies,
    entropy_deficit,
    equal_speeds,
    initial_kurtosis_slope,
)

TITLE, CHAPTER = "Speed distributions", "Motion and its memory"
HISTOGRAM = {
    "bins": count("bins of the histogram"),
    "highest": positive("its largest speed, over the root-mean-square speed"),
}
TIMES = list_of(POSITIVE, "times of the histograms, each a sampled one")
CLASSES = count("classes of equal probability for chi-square", minimum=3)
ENGINE_TITLES = {"step": "time-stepped", "event": "event-driven"}
# sqrt(n) times the Kolmogorov distance exceeds 1.818 with probability 0.0027, the second limit with 5 %.
KOLMOGOROV_LIMIT, KOLMOGOROV_BAND, KOLMOGOROV_SCATTER = 1.818, 1.36, 0.26


class Velocities:
    """Time, collisions per particle and temperature (T,) of a run; velocities (T, N, d) as stored."""

    def __init__(self, run: Run) -> None:
        self.time, self.temperature = run.time, run.temperatures
        self.collisions = 2.0 * run.data["collisions"].values / run.count
        self.velocities = run.data["velocities"].values

    @property
    def speeds(self) -> np.ndarray:
        """Speeds (T, N) over the root-mean-square speed, in double precision."""
        square = np.einsum("tnd,tnd->tn", self.velocities, self.velocities, dtype=float)
        return np.sqrt(square / square.mean(axis=1, keepdims=True))


def never_hit(velocities: np.ndarray) -> np.ndarray:
    """Compute the fraction (T,) of particles that no particle has hit since the first frame. A wall only
    changes signs, so all |v_k| keep their bits; a collision changes all (with probability 1).
    """
    return (np.abs(velocities) == np.abs(velocities[0])).all(axis=-1).mean(axis=-1)


def shared_means(samples: list[np.ndarray]) -> list[tuple[np.ndarray, np.ndarray]]:
    """Return mean and error of each group of runs (R, ...), from the scatter of all groups about their means.
    A group of few runs has no good estimate of its own scatter; the physics is the same.
    """
    freedom = sum(len(group) for group in samples) - len(samples)
    if freedom < 1:
        raise ValueError(f"samples: {len(samples)} groups (at least one must have two runs)")
    squares = sum(((group - group.mean(axis=0)) ** 2).sum(axis=0) for group in samples)
    return [(group.mean(axis=0), np.sqrt(squares / freedom / len(group))) for group in samples]


def measure_relaxation(points: list[Point], settings: dict) -> xr.Dataset:
    """Measure kurtosis, fraction never hit, entropy and histograms during relaxation, for each engine."""
    groups = [[Velocities(run) for run in runs(point, 0)] for point in points]
    scene, time = points[0].scene, groups[0][0].time
    for point, group in zip(points, groups, strict=True):
        same = (run.time.shape == time.shape and np.allclose(run.time, time) for run in group)
        if point.scene != scene or not all(same):
            rule = "must be the others' scene and times"
            raise SceneError(f"experiments.{point.experiment}", point.name, rule)
    frames = np.array([_frame_at(time, chosen) for chosen in settings["times"]])
    grid = Grid.line(0.0, settings["highest"], settings["bins"])
    numbers = [[_relaxing(run, grid, frames) for run in group] for group in groups]
    means = {
        name: shared_means([np.stack([replica[name] for replica in group]) for group in numbers])
        for name in numbers[0][0]
    }

    def row(engine: int) -> dict[str, Any]:
        return {
            "replicas": len(groups[engine]),
            "entropy_deficit": _entropy_deficit(groups[engine], grid),
            **{name: mean[engine] for name, mean in means.items()},
        }

    names = "collisions", "kurtosis", "never_hit", "temperature_drift", "entropy_deficit"
    over_time = dict.fromkeys(names, ("frame",))
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


def _frame_at(time: np.ndarray, chosen: float) -> int:
    frame = int(np.argmin(np.abs(time - chosen)))
    if abs(time[frame] - chosen) > 1e-6 * max(1.0, abs(chosen)):
        raise SceneError("figures.speed_relaxation.times", chosen, "must be a sampled time")
    return frame


def _relaxing(run: Velocities, grid: Grid, frames: np.ndarray) -> dict[str, Any]:
    speeds = run.speeds
    fourth = kurtosis(speeds)
    early = (run.collisions > 0.0) & (run.collisions <= 1.5)
    cubic = run.collisions[early, None] ** np.arange(1, 4)  # through 1 at s = 0
    return {
        "collisions": run.collisions,
        "kurtosis": fourth,
        "never_hit": never_hit(run.velocities),
        "density": np.stack([_density(frame, grid) for frame in speeds[frames]]),
        "temperature_drift": np.abs(run.temperature / run.temperature[0] - 1.0),
        "initial_slope": float(np.linalg.lstsq(cubic, fourth[early] - 1.0, rcond=None)[0][0]),
    }


def _entropy_deficit(replicas: list[Velocities], grid: Grid) -> Estimate:
    """Measure the entropy below that of equilibrium (T,), of the pooled histograms of the replicas. The
    expected bias of K occupied classes and n speeds, (K - 1) / 2n, is subtracted (Miller 1955).
    """
    edges = grid.edges[0]
    dimension, count = replicas[0].velocities.shape[2], replicas[0].velocities.shape[1] * len(replicas)
    below = theory.maxwell_cdf(edges, dimension, 1.0 / dimension)
    expected = np.diff(np.append(below, 1.0))
    shares = [np.array([_density(frame, grid) * grid.volume for frame in run.speeds]) for run in replicas]

    def deficit(bins: np.ndarray) -> np.ndarray:
        classes = np.append(bins, np.maximum(1.0 - bins.sum(axis=1, keepdims=True), 0.0), axis=1)
        occupied = (classes > 0.5 / count).sum(axis=1)
        return entropy_deficit(classes, expected) - (occupied - 1) / (2.0 * count)

    return Blocks((share,) for share in shares)(deficit)


def _density(speeds: np.ndarray, grid: Grid) -> np.ndarray:
    """Compute the density of the speeds in each bin; speeds beyond the last edge are part of the norm."""
    return grid.sums(grid.cells(speeds[..., None])) / speeds.size / grid.volume


def _bins(grid: Grid) -> dict[str, Any]:
    edges, units = grid.edges[0], {"units": "root-mean-square speed"}
    return {"lower": ("bin", edges[:-1], units), "upper": ("bin", edges[1:], units)}


def _rate_between_walls(scene: Scene, temperature: float) -> float:
    """Compute the collision rate per particle of a dilute gas between walls. It is Enskog's times (N - 1) /
    N, and times the probability that the partner in a collision, at distance sigma in the direction n, is
    within the walls too: the mean of prod_k (1 - sigma |n_k| / L_k), to first order, with <|n_k|> = 1/2 in 3D
    and 2/pi in 2D. The density is uniform up to the walls.
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


def measure_distribution(points: list[Point], settings: dict) -> xr.Dataset:
    """Measure the speeds in equilibrium, beside Maxwell's distribution without a fit. The frames after
    equilibration are independent if some 3 collisions per particle lie between them. The energy is conserved:
    <u^2> = 1 in every frame, which takes a degree of freedom of chi-square.
    """
    grid = Grid.line(0.0, settings["highest"], settings["bins"])
    steps = np.linspace(0.0, settings["highest"], 201)
    inner = {**dict.fromkeys(("density", "expected", "residual"), ("bin",)), "difference": ("step",)}
    return (
        table("point", points, _distribution, grid, steps, settings["classes"], inner=inner, units={})
        .assign_coords(**_bins(grid), speed=("step", steps, {"units": "root-mean-square speed"}))
        .assign_attrs(dimension=points[0].settings["dimension"])
    )


def _distribution(point: Point, grid: Grid, steps: np.ndarray, classes: int) -> dict[str, Any]:
    if "speed" not in point.settings:
        rule = "is required: all particles start with it"
        raise SceneError(f"experiments.{point.experiment}.speed", None, rule)
    scene, dimension = point.scene, point.settings["dimension"]
    replicas = [Velocities(run) for run in runs(point)]
    speeds = np.concatenate([run.speeds.ravel() for run in replicas])
    cumulative = lambda u: theory.maxwell_cdf(u, dimension, 1.0 / dimension)  # noqa: E731
    chance, width = np.diff(cumulative(grid.edges[0])), grid.volume
    share, deviation = _density(speeds, grid) * width, np.sqrt(chance * (1.0 - chance) / speeds.size)
    test, ordered = histogram_chi_square(speeds, cumulative, classes), np.sort(speeds)
    fourth = mean_of(np.concatenate([kurtosis(run.speeds) for run in replicas]))
    between = min(float(np.diff(run.collisions).min()) for run in replicas)
    # Fluctuations of the kurtosis decay like its mean; successive frames are correlated accordingly.
    memory = np.exp(-theory.KURTOSIS_RELAXATION_RATE[dimension] * between)
    energy = np.concatenate([run.temperature for run in replicas])
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
        "given_temperature": plain_gas(scene).temperature,  # of equal speeds, without statistical error
        "collisions_before": min(float(run.collisions[0]) for run in replicas),
        "collisions_between": between,
        "collisions_in_all": float(np.mean([run.collisions[-1] for run in replicas])),
        "engine": point.settings.get("engine", "event"),
        "count": scene.count,
        "packing_fraction": scene.packing_fraction,
    }


def _kolmogorov_distance(cumulative: np.ndarray) -> float:
    """Compute the largest |empirical - theoretical| probability, from the latter at the ordered samples."""
    number = len(cumulative)
    above = np.arange(1, number + 1) / number - cumulative
    return float(max(above.max(), (cumulative - np.arange(number) / number).max()))


BOLTZMANN = "homogeneous Boltzmann equation from equal speeds (gaspart.theory.boltzmann)"
SOLVED = "homogeneous Boltzmann equation from equal speeds, on a grid (gaspart.theory.speeds)"
GRID = "width of the cells of energy"
MONTE_CARLO = "statistical error of the Monte Carlo solution"
MAXWELL = "Maxwell's distribution (exact)"


def claim_relaxation(dataset: xr.Dataset) -> Iterator[Claim]:
    """Yield the claims on kurtosis, fraction never hit and entropy at source A's times, for each engine. The
    scatter of the runs includes the scatter of the number of collisions.
    """
    for gas in Table(dataset, "engine"):
        by, relaxation = f"({ENGINE_TITLES[gas.engine]} engine)", theory.relaxation(gas.dimension)
        frames = Table(gas.dataset, "frame")
        solution, deficit = _expected_deficit(gas)
        for frame in frames[gas.shown]:
            s, when = frame.collisions.value, f"at t = {frame.time:g} {by}"
            yield Claim(
                f"kurtosis of the speeds {when}",
                frame.kurtosis, Estimate(relaxation.kurtosis(s), RELAXATION_UNCERTAINTY), 0.01, BOLTZMANN,
                "collisions that do not scatter isotropically, or a wrong count of them",
                allowance_source=MONTE_CARLO,
            )  # fmt: skip
            yield Claim(
                f"fraction of particles never hit {when}",
                frame.never_hit, Estimate(relaxation.never_hit(s), RELAXATION_UNCERTAINTY), 0.005, BOLTZMANN,
                "collisions that prefer some particles, or a wall that changes a speed",
                allowance_source=MONTE_CARLO,
            )  # fmt: skip
            yield Claim(
                f"entropy per particle below that of equilibrium {when}",
                frame.entropy_deficit,
                Estimate(np.interp(s, solution.collisions, deficit), ENTROPY_UNCERTAINTY), 0.01, SOLVED,
                "speeds that do not gain entropy as molecular chaos requires",
                allowance_source=GRID,
            )  # fmt: skip
        last = frames[-1]
        expected = relaxation.collisions(last.collision_rate * last.time)
        yield Claim(
            f"collisions per particle until t = {last.time:g} {by}",
            last.collisions, Estimate(expected, 3.0 * RELAXATION_UNCERTAINTY), 0.03,
            "Enskog's rate during relaxation, between walls (exact at low density)",
            "contacts missed or counted twice; 1.2 % of them would be missed if the walls' effect were "
            "ignored",
            allowance_source=MONTE_CARLO,
        )  # fmt: skip
        yield Claim(
            f"initial slope of the kurtosis per collision and particle {by}",
            gas.initial_slope, initial_kurtosis_slope(gas.dimension), 0.015,
            "Boltzmann's collision integral (exact)",
            "the first collisions do not scatter as hard spheres do",
        )  # fmt: skip
        yield Claim.at_most(
            f"relative drift of the energy {by}",
            Estimate(gas.temperature_drift.value.max()), 1e-12, 1e-12,
            "elastic collisions (exact)", "an impulse that is not elastic to rounding", kind="identity",
        )  # fmt: skip


def claim_distribution(dataset: xr.Dataset) -> Iterator[Claim]:
    """Yield the claims on chi-square, Kolmogorov distance, kurtosis and temperature, by point."""
    for gas in Table(dataset, "point"):
        at = f"at packing fraction {gas.packing_fraction:.3g}"
        fourth, temperature = theory.kurtosis(gas.dimension, gas.count), gas.given_temperature
        yield Claim.chi_square(
            claim=f"chi-square of {gas.samples} speeds against Maxwell's distribution, {at}",
            chi_square=gas.chi_square, degrees_of_freedom=gas.degrees_of_freedom, source=MAXWELL,
            fails_if="speeds that are not Maxwell's, or snapshots that are not independent",
        )  # fmt: skip
        yield Claim.at_most(
            f"Kolmogorov distance times sqrt(samples), {at}",
            Estimate(gas.kolmogorov_distance * gas.samples**0.5, KOLMOGOROV_SCATTER),
            KOLMOGOROV_LIMIT, KOLMOGOROV_SCATTER, MAXWELL,
            "a cumulative distribution that deviates from Maxwell's anywhere",
        )  # fmt: skip
        yield Claim(
            f"kurtosis of the speeds, {at}", gas.kurtosis, fourth, 0.01 * fourth,
            f"Maxwell's, at fixed energy and {gas.count} particles (exact)",
            "a tail too heavy or too light: not yet in equilibrium",
        )  # fmt: skip
        yield Claim(
            f"temperature <v^2>/{gas.dimension}, {at}",
            Estimate(gas.temperature, 1e-12 * temperature), temperature, 1e-9 * temperature,
            "conservation of energy (exact)", "energy is not conserved to rounding", kind="identity",
        )  # fmt: skip
        yield Claim.at_least(
            f"collisions per particle between snapshots, {at}", Estimate(gas.collisions_between), 3.0, 1.0,
            "independent samples are 3 or more collisions per particle apart",
            "snapshots taken too close for a chi-square test", kind="identity",
        )  # fmt: skip


def _expected_deficit(gas: Row | Table) -> tuple[Energies, np.ndarray]:
    """Solve the Boltzmann equation over the measured collisions; return its entropy deficit in these bins."""
    solution = equal_speeds(float(np.ceil(gas.collisions.value.max())))
    return solution, solution.deficit(np.append(gas.lower, gas.upper[-1]))


SPEED, SIGMA = r"speed $v/\sqrt{\langle v^2\rangle}$", r"residual ($\sigma$)"


def draw_relaxation(dataset: xr.Dataset) -> Figure:
    """Draw histograms at the source's times; kurtosis, fraction never hit and entropy against collisions."""
    figure, axes = style.new((2.8,), (1.9, 1.0), (1.9, 1.0), (1.9, 1.0))
    histograms, kurtoses, kurtosis_residual, unhit, unhit_residual, entropies, entropy_residual = axes
    engines = Table(dataset, "engine")
    _histograms(histograms, engines)
    relaxation = theory.relaxation(engines.dimension)
    longest = 1.04 * engines.collisions.value.max()
    s = np.linspace(0.0, longest, 300)
    kurtoses.plot(s, relaxation.kurtosis(s), color=style.DATA, label="kinetic theory", zorder=2)
    early = s[s < 1.6]
    initial = 1.0 + initial_kurtosis_slope(engines.dimension) * early
    kurtoses.plot(early, initial, color=style.GREY, ls=":", label="initial slope 8/35")
    style.level(kurtoses, theory.kurtosis(engines.dimension), ls="--", label="Maxwell: 5/3")
    unhit.semilogy(s, relaxation.never_hit(s), color=style.DATA, zorder=2)
    _compare(kurtoses, kurtosis_residual, engines, "kurtosis", relaxation.kurtosis)
    _compare(unhit, unhit_residual, engines, "never_hit", relaxation.never_hit)
    solution, deficit = _expected_deficit(engines)
    shown = solution.collisions <= longest
    entropies.semilogy(solution.collisions[shown], deficit[shown], color=style.DATA, zorder=2)
    curve = lambda s: np.interp(s, solution.collisions, deficit)  # noqa: E731
    _compare(entropies, entropy_residual, engines, "entropy_deficit", curve)
    for axis in axes[1:]:
        axis.set_xlim(0.0, longest)
    y = r"kurtosis $\langle v^4\rangle/\langle v^2\rangle^2$"
    style.label_axes(kurtoses, y=y, legend="lower right", ylim=(0.97, 1.76))
    style.label_axes(unhit, y="fraction never hit", legend="lower left")
    style.label_axes(entropies, y=r"entropy $(S_\mathrm{eq}-S)/Nk$")
    style.letters(histograms, kurtoses, unhit, entropies)
    return figure


def _histograms(axis: Axes, engines: Table) -> None:
    """Draw densities: lines for the time-stepped engine, points for the event-driven one."""
    edges = np.append(engines.lower, engines.upper[-1])
    middle = 0.5 * (edges[1:] + edges[:-1])
    for kind, frame in enumerate(engines.shown):
        s = engines.collisions.value[:, frame].mean()
        label = f"$t={engines.time[frame]:g}$, $s={s:.1f}$"
        for gas in engines:
            density = gas.density[kind]
            seen = density.value > 0.0
            if gas.engine == "step":
                outline = np.where(seen, density.value, np.nan)
                axis.stairs(outline, edges, color=style.COLOURS[kind], lw=0.8, label=label)
            else:
                style.points(axis, middle[seen], density[seen], kind=kind, markersize=2)
    u, d = np.linspace(1e-3, edges[-1], 300), engines.dimension
    axis.plot(u, theory.maxwell_pdf(u, d, 1.0 / d), color=style.DATA, label="Maxwell", zorder=4)
    peak = engines.density.value.max()
    axis.annotate("never hit", (0.97, 0.8 * peak), (0.05, 9.0), arrowprops={"arrowstyle": "-", "lw": 0.6})
    axis.set(yscale="log", ylim=(2e-3, 20.0), xlim=(0.0, edges[-1]))
    style.label_axes(axis, SPEED, "probability density", legend="upper right")


def _compare(
    top: Axes, bottom: Axes, engines: Table, name: str, curve: Callable[[np.ndarray], ArrayLike]
) -> None:
    style.band(bottom, -3.0, 3.0)
    style.level(bottom, 0.0)
    for kind, gas in enumerate(engines):
        s, values = gas.collisions.value[1:], gas[name][1:]
        label = ENGINE_TITLES[gas.engine] if name == "never_hit" else None
        style.points(top, s, values, kind=kind, hollow=kind > 0, label=label)
        style.points(bottom, s, (values.value - curve(s)) / values.error, kind=kind, hollow=kind > 0)
    x = r"collisions per particle $s = 2N_\mathrm{coll}/N$"
    style.label_axes(bottom, x, SIGMA, ylim=(-4.5, 4.5), yticks=[-3, 0, 3])


def draw_distribution(dataset: xr.Dataset) -> Figure:
    """Draw density, residual, tails and the difference of the cumulative distribution."""
    figure, (density, residual, tail, difference) = style.new((2.3, 1.1), (2.3, 1.1))
    gases = Table(dataset, "point")
    end, dimension = gases.upper[-1], gases.dimension
    u = np.linspace(0.0, end, 401)[1:]
    for axis, label in ((density, "Maxwell"), (tail, None)):
        curve = theory.maxwell_pdf(u, dimension, 1.0 / dimension)
        axis.plot(u, curve, color=style.DATA, label=label, zorder=4)
    style.band(residual, -3.0, 3.0)
    style.level(residual, 0.0)
    style.band(difference, -KOLMOGOROV_BAND, KOLMOGOROV_BAND)
    style.level(difference, 0.0)
    middle, width = 0.5 * (gases.lower + gases.upper), gases.upper[0] - gases.lower[0]
    for kind, gas in enumerate(gases):
        label = f"$\\eta={_in_words(gas.packing_fraction)}$, {ENGINE_TITLES[gas.engine]}"
        style.points(density, middle, gas.density, kind=kind, hollow=True, label=label)
        # Points of different packing fractions are drawn side by side in their bin.
        beside = middle + width * 0.25 * (kind - 0.5 * (len(gases) - 1))
        seen = gas.density.value > 0.0
        style.points(tail, beside[seen], gas.density[seen], kind=kind, hollow=True)
        style.points(residual, beside, gas.residual, kind=kind, markersize=2.5)
        difference.plot(gas.speed, gas.samples**0.5 * gas.difference, color=style.COLOURS[kind])
    for axis in (residual, difference):
        axis.set(xlim=(0.0, end))
    values = gases.density.value
    top, decades = (0.0, 1.5 * values.max()), (0.2 * values[values > 0.0].min(), 3.0 * values.max())
    style.label_axes(density, y="probability density", legend="upper right", ylim=top)
    style.label_axes(residual, SPEED, SIGMA, ylim=(-4.5, 4.5), yticks=[-3, 0, 3])
    style.label_axes(tail, y="probability density", yscale="log", ylim=decades)
    style.label_axes(difference, SPEED, r"$\sqrt{n}\times$ difference", ylim=(-2.0, 2.0), yticks=[-1, 0, 1])
    style.letters(density, tail, difference)
    return figure


def _in_words(value: float) -> str:
    """Return a number with two digits for a formula, 10^{-5} instead of 1e-05."""
    digits, _, power = f"{value:.2g}".partition("e")
    factor = "" if digits == "1" else rf"{digits}\cdot "
    return rf"{factor}10^{{{int(power)}}}" if power else digits


_RELAXATION = {"times": TIMES, **HISTOGRAM}
_EQUILIBRIUM = {**HISTOGRAM, "classes": CLASSES}
_DISTRIBUTION = Parts(_EQUILIBRIUM, measure_distribution, claim_distribution, draw_distribution)
FIGURES = {
    "speed_relaxation": Parts(_RELAXATION, measure_relaxation, claim_relaxation, draw_relaxation),
    "speed_distribution_spheres": _DISTRIBUTION,
    "speed_distribution_discs": _DISTRIBUTION,
}
