"""Gases behind a piston, along an adiabat and at constant pressure, and free expansion without one.

Particles have mass 1, and walls are on the first axis. A point without a piston is an expansion; one with
equilibration is a state at constant pressure, one without it a path.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator

import numpy as np
import xarray as xr

from gaspart import theory
from gaspart.analysis.estimate import Estimate
from gaspart.analysis.run import Run
from gaspart.analysis.statistics import mean_of, means_of
from gaspart.rendering import style
from gaspart.rendering.style import Axes, Figure
from gaspart.reproduction.claims import Claim
from gaspart.reproduction.figure import PARTICLES, Parts, runs
from gaspart.reproduction.points.point import Point
from gaspart.reproduction.table import Row, Table, merge_with_prefixes, table
from gaspart.theory.enskog import enskog_longitudinal_viscosity
from gaspart.theory.speeds import mean_speed
from gaspart.theory.state import adiabatic_temperature, constant_enthalpy_factor

TITLE, CHAPTER = "Pressure on walls and pistons", "Equation of state and structure"


def measure(points: list[Point], settings: dict) -> xr.Dataset:
    """Measure each replica of paths (in each frame), of states, and of expansions. Volume and temperature of
    a path are over their first values.
    """
    kinds: dict[str, tuple] = {
        "path": (_path, "packing_fraction"),
        "state": (_state, "count"),
        "expansion": (_expansion,),
    }
    tables = {}
    for kind, (read, *facts) in kinds.items():
        chosen = [point for point in points if _kind(point) == kind]
        inner = f"{kind}_replica", "frame"
        tables[kind] = table(kind, chosen, _row, read, ("dimension", *facts), inner=inner, units={})
    return merge_with_prefixes(**tables)


def _kind(point: Point) -> str:
    if not point.scene.pistons:
        return "expansion"
    return "state" if point.schedule.equilibration_frames else "path"


def _row(point: Point, read: Callable[[Run], dict], facts: tuple[str, ...]) -> dict:
    replicas = [read(run) for run in runs(point)]
    row = {name: np.stack([replica[name] for replica in replicas]) for name in replicas[0]}
    return row | {name: getattr(point.scene, name) for name in facts}


def _path(run: Run) -> dict[str, np.ndarray]:
    length, energy = _length(run), run.data["kinetic_energy"].values
    heating = _heating(run, length, energy)
    return {"volume": length / length[0], "temperature": energy / energy[0], "heating": heating}


def _length(run: Run) -> np.ndarray:
    """Return the distance of the piston from the opposite wall, shape (frame,)."""
    ((number, _),) = run.scene.pistons
    position = run.data["piston_position"].values
    return position if number % 2 else run.scene.container.lengths[number // 2] - position


def _heating(run: Run, length: np.ndarray, energy: np.ndarray) -> np.ndarray:
    """Compute the increase (frame,) of ln T by viscous heating. The gas between wall and piston flows with a
    velocity proportional to the distance from the wall. The heat is the longitudinal viscosity (Enskog) times
    the square of the rate of strain. Along an adiabat the ratio of two temperatures is constant, so that the
    increments add up.
    """
    from scipy.integrate import cumulative_trapezoid

    scene, rate = run.scene, run.data["piston_velocity"].values / length
    dimension, diameter = scene.dimension, 2.0 * scene.largest_radius
    share = length / scene.container.lengths[0]
    viscosity = enskog_longitudinal_viscosity(scene.packing_fraction / share, dimension, diameter)
    viscosity *= np.sqrt(2.0 * energy / (dimension * scene.count))
    power = viscosity * rate**2 * scene.container.volume * share
    return cumulative_trapezoid(power / energy, run.time, initial=0)


def _state(run: Run) -> dict[str, np.ndarray]:
    """Measure the density of the middle half, and P / (n k T), fluctuation and energy of the piston by it.
    The fluctuation is N times the variance of the volume over the square of the volume at this density; the
    energy is twice the piston's over k T.
    """
    scene, length = run.scene, _length(run)
    ((_, face),) = scene.pistons
    area = scene.container.volume / scene.container.lengths[0]
    positions = run.data["coordinates"].values[:, :, 0] / length[:, None]
    temperature = 2.0 * run.data["kinetic_energy"].values.mean() / (scene.dimension * scene.count)
    middle = ((positions > 0.25) & (positions < 0.75)).sum() / (0.5 * area * length.sum())
    # length without the layer that walls deplete; this layer does not change
    bulk = scene.count / (middle * area)
    return {
        "density": middle * scene.packing_fraction * scene.container.volume / scene.count,
        "factor": face.pressure / (middle * temperature),
        "fluctuation": scene.count * length.var(ddof=1) / bulk**2,
        "energy": face.mass * np.mean(run.data["piston_velocity"].values ** 2) / temperature,
    }


def _expansion(run: Run) -> dict[str, np.ndarray]:
    """Measure energy, speed and share in the half that was empty, in the second half of the frames. The
    energy is over the first one, the mean speed over that of equilibrium at the first temperature.
    """
    scene, energy = run.scene, run.data["kinetic_energy"].values
    half = len(energy) // 2
    speeds = np.linalg.norm(run.velocities[half:], axis=2)
    beyond = run.data["coordinates"].values[half:, :, 0] > 0.5 * scene.container.lengths[0]
    first = 2.0 * energy[0] / (scene.dimension * scene.count)
    return {
        "heat": energy[half:].mean() / energy[0],
        "speed": speeds.mean() / mean_speed(scene.dimension, first, count=scene.count),
        "share": beyond.mean(),
    }


ENSEMBLE = "the ensemble of constant pressure and enthalpy ([Andersen 1980])"


def _kinds(dataset: xr.Dataset) -> Iterator[Table]:
    return (Table.from_prefixed(dataset, kind) for kind in ("path", "state", "expansion"))


def claims(dataset: xr.Dataset) -> Iterator[Claim]:
    """Yield claims on adiabatic exponents, on states at constant pressure, and on free expansions."""
    paths, states, gases = _kinds(dataset)
    for path in paths:
        yield from _of_path(path)
    for state in states:
        eta, dimension = state.density.mean(), state.dimension
        yield Claim(
            f"compressibility factor at constant pressure over the reference, {_name(state)}", _factor(state),
            float(constant_enthalpy_factor(eta, dimension, state.count)), 0.005,
            f"the equation of state of the infinite fluid, with the volume's fluctuations in {ENSEMBLE}, "
            "to first order in 1/N",
            "a load that is not the pressure of the gas, or a density disturbed by the walls",
        )  # fmt: skip
    for state in states:
        eta, dimension = state.density.mean(), state.dimension
        expected = float(theory.speed_of_sound(eta, dimension)) ** -2
        yield Claim(
            f"variance of the volume over that of theory, {_name(state)}",
            mean_of(state.fluctuation) / expected, 1.0, 0.15,
            f"k_B T times the adiabatic compressibility, that is 1 / (m c^2), in {ENSEMBLE}",
            "volumes that are not those of this ensemble, such as those of constant temperature",
            alternative=float(isothermal_variance(eta, dimension)) / expected,
        )  # fmt: skip
    if states:
        yield Claim.joint(
            "kinetic energy of the piston over k_B T / 2 at each state",
            [(mean_of(state.energy) - 1.0).deviation for state in states], "equipartition",
            "contacts with the piston that are not elastic, or energy that its load loses",
        )  # fmt: skip
    for gas in gases:
        yield from _of_expansion(gas)


def _of_path(path: Row) -> Iterator[Claim]:
    estimates, least = exponents(path), path.volume.mean(axis=0).argmin()
    for how, frame in (("compressed to the least volume", least), ("expanded again, last frame", -1)):
        yield Claim(
            f"adiabatic exponent of {PARTICLES[path.dimension]}, {how}",
            mean_of(estimates[:, frame]), 1.0 + 2.0 / path.dimension, 0.01,
            "d/2 N k_B dT = -P dV, P that of the equation of state (exact for slow changes), and the "
            "heat of Enskog's longitudinal viscosity in the flow that follows the piston",
            "a piston that gives the gas another work than it loses, or flow that heats it more",
        )  # fmt: skip


def exponents(path: Row) -> np.ndarray:
    """Compute 1 + 2/d times the ratio of ln T to theory, without viscous heating, shape (replica, frame)."""
    dimension, first = path.dimension, path.packing_fraction
    eta = np.minimum(first / path.volume, theory.HIGHEST_PACKING_FRACTION[dimension])
    expected = adiabatic_temperature(eta, first, dimension)
    with np.errstate(divide="ignore", invalid="ignore"):
        ratio = (np.log(path.temperature) - path.heating) / np.log(expected)
    return np.asarray(1.0 + 2.0 / dimension * ratio)


def _name(state: Row) -> str:
    return f"{PARTICLES[state.dimension]}, packing fraction {state.density.mean():.2f}"


def _factor(state: Row) -> Estimate:
    return mean_of(state.factor / theory.compressibility_factor(state.density, state.dimension))


def isothermal_variance(packing_fraction: float | np.ndarray, dimension: int) -> np.ndarray:
    """Compute N times the relative variance of the volume at constant temperature. This variance follows from
    the speed of sound without the adiabatic term.
    """
    adiabatic = theory.speed_of_sound(packing_fraction, dimension) ** 2
    heating = 2.0 / dimension * theory.compressibility_factor(packing_fraction, dimension) ** 2
    return np.asarray(1.0 / (adiabatic - heating))


def _of_expansion(gas: Row) -> Iterator[Claim]:
    which = f"free expansion of {PARTICLES[gas.dimension]}"
    yield Claim(
        f"kinetic energy after over before, {which}", Estimate(gas.heat.mean(), 1e-12), 1.0, 1e-9,
        "no wall does work", "contacts that are not elastic", kind="identity",
    )  # fmt: skip
    yield Claim(
        f"mean speed after over that of equilibrium at the first temperature, {which}",
        mean_of(gas.speed), 1.0, 0.005,
        "the energy of hard particles does not depend on the volume: the temperature stays; "
        "velocities uniform on the sphere of this energy",
        "a gas whose flow has not become heat, or that has cooled",
    )  # fmt: skip
    yield Claim(
        f"share of the particles in the half that was empty, {which}", mean_of(gas.share), 0.5, 0.01,
        "equilibrium", "a gas that has not filled its container",
    )  # fmt: skip


DOUBLED = 2.0  # volume after free expansion over the initial volume
EXPONENTS = {2: "2", 3: "5/3"}


def draw(dataset: xr.Dataset) -> Figure:
    """Draw temperature along adiabats, factors at constant pressure, and volume variances."""
    figure, (upper, middle, lower) = style.new((2.6,), (1.9, 1.9))
    paths, states, gases = _kinds(dataset)
    for path in paths:
        _draw_path(upper, path)
    for gas in gases[:1]:
        style.points(upper, DOUBLED, mean_of(gas.speed**2), kind=4, label="free expansion")
    labels = r"volume $V/V_0$", r"temperature $T/T_0$"
    style.label_axes(upper, *labels, legend="best", xscale="log", yscale="log")
    style.level(lower, 1.0)
    for dimension, part in states.by("dimension"):
        _draw_states(middle, lower, part, dimension)
    style.label_axes(middle, y=r"$P/nk_{\mathrm{B}}T$ / reference", legend="best")
    labels = r"packing fraction $\eta$", r"variance of $V$ / theory"
    style.label_axes(lower, *labels, legend="best", xlim=(0.0, None))
    style.letters(upper, middle, lower)
    return figure


def _draw_path(axis: Axes, path: Row) -> None:
    dimension, first, kind = path.dimension, path.packing_fraction, path.dimension - 2
    volume, temperature = path.volume.mean(axis=0), Estimate(*means_of(path.temperature))
    style.points(axis, volume, temperature, kind=kind, label=PARTICLES[dimension])
    fine = np.geomspace(volume.min(), DOUBLED, 60)
    expected = adiabatic_temperature(first / fine, first, dimension)
    label = rf"adiabat, $\gamma={EXPONENTS[dimension]}$"
    axis.plot(fine, expected, color=style.COLOURS[kind], zorder=1, label=label)


def _draw_states(middle: Axes, lower: Axes, states: Table, dimension: int) -> None:
    eta, name = np.array([state.density.mean() for state in states]), PARTICLES[dimension]
    factor = Estimate.stack([_factor(state) for state in states])
    variance = Estimate.stack([mean_of(state.fluctuation) for state in states])
    variance = variance * theory.speed_of_sound(eta, dimension) ** 2
    for axis, ratio in ((middle, factor), (lower, variance)):
        style.points(axis, eta, ratio, kind=dimension - 2, label=name)
    fine, colour = np.linspace(0.0, eta.max(), 60), style.COLOURS[dimension - 2]
    finite = constant_enthalpy_factor(fine, dimension, states.count[0])
    middle.plot(fine, finite, color=colour, zorder=1, label=f"{name}, finite $N$")
    isothermal = isothermal_variance(fine, dimension) * theory.speed_of_sound(fine, dimension) ** 2
    lower.plot(fine, isothermal, color=colour, linestyle="--", label=f"{name}, constant $T$")


FIGURES = {"piston": Parts({}, measure, claims, draw)}
