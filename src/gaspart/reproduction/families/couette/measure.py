"""Steady Couette flow of a gas between two sliding walls.

The walls are the two faces of the first axis. The flow is along the second axis. Positions are relative to
the middle. Particles have mass 1, and both walls have the same temperature.
"""

from __future__ import annotations

import math
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np
import xarray as xr

from gaspart import theory
from gaspart.analysis.estimate import Estimate
from gaspart.analysis.run import Run
from gaspart.analysis.series import Blocks, face_pressures
from gaspart.analysis.statistics import fit_linear, jackknife
from gaspart.reproduction.families.heat.gap import Gap
from gaspart.reproduction.families.shared.runs import runs
from gaspart.reproduction.figures.transport import coefficient
from gaspart.reproduction.points.point import Point
from gaspart.reproduction.table import table
from gaspart.scene.faces import thermal_face
from gaspart.scene.scene import Scene
from gaspart.theory.discretisation import cell_factor, step_factor

# Uniform shear flow of a gas without walls (`scene.faces.LeesEdwards`). The flow is along the first axis, its
# gradient along the second. Particles have mass 1. The gas heats up.


# components of the container's tensor, named as for walls across x: x is along the gradient
_AXES = {"y": 0, "x": 1, "z": 2}


def uniform(point: Point, blocks: int) -> dict[str, Any]:
    """Measure the numbers of a uniformly sheared gas.

    viscosity : response divided by the Enskog viscosity at the instantaneous temperature.
    reduced_rate : stress divided by pressure.
    normal_x, normal_y, normal_z : pressure along gradient, flow and vorticity over their mean, minus 1.

    Errors are jackknife errors over blocks of time. Each run has `blocks` of them.
    """
    scene = point.scene
    series = [
        np.concatenate(parts) for parts in zip(*(_blocks(run, blocks) for run in runs(point)), strict=True)
    ]
    estimates = Estimate(*jackknife(_numbers, *series), len(series[0]) - 1)
    names = ("viscosity", "reduced_rate", *(f"normal_{name}" for name in _AXES))
    return {"packing_fraction": scene.packing_fraction, **dict(zip(names, estimates, strict=True))}


def _blocks(run: Run, blocks: int) -> tuple[np.ndarray, np.ndarray]:
    """Compute the pressure tensor in blocks of a run, and the stress by Enskog theory.

    The shapes are (K, d, d) and (K,).
    """
    parts, scene = Blocks(run, blocks), run.scene
    pressures = parts.growth("stress_sum") / scene.container.volume
    root = np.sqrt(run.temperatures)
    unit = float(theory.enskog_viscosity(scene.packing_fraction, 3, 2.0 * scene.smallest_radius))
    assert scene.shear_rate is not None
    return pressures, scene.shear_rate * parts.means(unit * 0.5 * (root[1:] + root[:-1]))


def _numbers(pressures: np.ndarray, expected: float) -> np.ndarray:
    """Compute the numbers of `uniform` from block averages."""
    along = np.diag(pressures)
    mean, stress = along.mean(), -pressures[1, 0]
    return np.array([stress / expected, stress / mean, *(along[list(_AXES.values())] / mean - 1.0)])


NUMBERS = ("viscosity", "slip", "heating", "normal_x", "normal_y", "normal_z", "pressure", "reduced_rate")
"""Names of the numbers of a flow; see `couette`."""


def couette(points: list[Point], settings: dict) -> xr.Dataset:
    """Measure flows between sliding walls, and the viscosity from equilibrium.

    The settings are `parts`, the experiments of each part; `blocks` of each run; `bins` across the gap; and
    `clear`, the distance of the middle from the walls. The dimensions are point and bin. The suffix
    `_freedom` marks the degrees of freedom of an error `_error`.

    Variables of each flow:

    part, engine : part of the figure, and engine
    packing_fraction : packing fraction in the middle
    knudsen : mean free path divided by the gap
    speed : difference of the velocities of the walls
    stress : stress divided by the stress of free flight
    viscosity : stress over gradient in the middle, relative to Enskog theory there (with errors of DSMC)
    slip : gas velocity relative to the wall, extrapolated from the middle, over mean free path and gradient
    heating : -dT/du^2 in the middle
    normal_x, normal_y, normal_z : kinetic energy of each component in the middle over their mean, minus 1
    pressure : pressure on the walls divided by the pressure of the equation of state
    reduced_rate : stress divided by pressure
    place, flow, temperature : position, velocity and temperature, by bin

    The errors of DSMC are due to its cells and steps. Uniformly sheared gases have the variables of
    `uniform`. Equilibrium points have packing_fraction, and `viscosity` by Green and Kubo.
    """
    gases = [
        (part, point)
        for part, experiments in settings["parts"].items()
        for point in points
        if point.experiment in experiments
    ]
    units = {"place": "gap", "flow": "speed of the walls", "temperature": "temperature of the walls"}
    return table("point", gases, _row, settings, inner=("bin",), units=units)


def _row(gas: tuple[str, Point], settings: dict) -> dict[str, Any]:
    """Return the numbers of a point of this part of the figure."""
    part, point = gas
    row = {"part": part, "engine": point.engine.title}
    if part == "flows":
        return row | _flow(point, settings)
    return row | (uniform(point, settings["blocks"]) if part == "sheared" else _equilibrium(point))


def _equilibrium(point: Point) -> dict[str, Any]:
    """Measure the viscosity of an infinite gas in equilibrium, divided by Enskog theory."""
    row = coefficient(point, "viscosity")
    return {"packing_fraction": row["packing_fraction"], "viscosity": row["value"] / row["finite"]}


@dataclass(frozen=True)
class FlowBetweenPlates:
    """Flow between plates, and its bins.

    gap : distance between the plates that is accessible to centres.
    speed : difference of the velocities of the walls.
    diameter : diameter of the spheres.
    dilute : True if the spheres occupy no volume, as in DSMC.
    coarse : viscosity with the engine's cells and steps, divided by the exact viscosity.
    position : (B,), positions of the bins.
    middle : (B,), True for bins away from the walls.
    """

    gap: Gap
    speed: float
    diameter: float
    dilute: bool
    coarse: float
    position: np.ndarray
    middle: np.ndarray

    @classmethod
    def of(cls, point: Point, settings: dict) -> FlowBetweenPlates:
        """Return the flow of a point."""
        scene = point.scene
        gap, diameter, dilute = Gap.of(scene), 2.0 * scene.smallest_radius, point.engine.equation != "exact"
        path = _path(scene.count / (gap.length * gap.area), diameter, dilute)
        position = gap.grid(settings["bins"]).middles[0] - 0.5 * gap.length
        clear = min(settings["clear"] * max(path, 0.0 if dilute else diameter), gap.length / 3.0)
        coarse = _coarseness(point, gap, path) if dilute else 1.0
        middle = np.abs(position) < 0.5 * gap.length - clear
        return cls(gap, _speed(scene), diameter, dilute, coarse, position, middle)

    def packing_fraction(self, density: float) -> float:
        """Return the packing fraction for theory at a number density."""
        return 0.0 if self.dilute else float(theory.packing_fraction(density, 3, self.diameter))


def _speed(scene: Scene) -> float:
    """Return the difference of the velocities of the walls along the second axis."""
    low, high = (thermal_face(scene, name).velocity or (0.0, 0.0) for name in ("x_low", "x_high"))
    return high[1] - low[1]


def _path(density: float, diameter: float, dilute: bool) -> float:
    """Compute the mean free path; if `dilute` is True, the spheres occupy no volume."""
    eta = float(theory.packing_fraction(density, 3, diameter))
    return float(theory.mean_free_path(eta, 3, diameter, contact=1.0 if dilute else None))


def _coarseness(point: Point, gap: Gap, path: float) -> float:
    """Compute the viscosity with cells and steps, divided by the exact viscosity.

    Only the width of the cells across the gap matters.
    """
    engine = asdict(point.engine.for_scene(point.scene, point.schedule.sample_interval))
    width = gap.length / engine["cells_per_side"][0] / path
    step = engine["time_step"] * math.sqrt(2.0) / path
    return float(cell_factor("viscosity", width) * step_factor("viscosity", step))


@dataclass(frozen=True)
class Averages:
    """Averages over K blocks of time.

    stress, pressure : (K,), on the walls.
    density : (K, B), particles in bins, per volume.
    flow : (K, B), momentum along the flow, per volume.
    squares : (K, B, d), sums of squared velocities, per volume.
    changes : (K, 2), change of the total momentum, and of the first moment of the momentum.
    """

    stress: np.ndarray
    pressure: np.ndarray
    density: np.ndarray
    flow: np.ndarray
    squares: np.ndarray
    changes: np.ndarray

    @property
    def steady(self) -> np.ndarray:
        """Steady stress (K,), without stored momentum; see `statistics.steady_mean`."""
        scale = np.abs(self.changes).max(axis=0)
        design = np.column_stack([np.ones(len(self.stress)), self.changes / scale])
        return self.stress - design[:, 1:] @ fit_linear(design, self.stress).values[1:]


def _gap_blocks(point: Point, gap: Gap, blocks: int, bins: int) -> Averages:
    """Return averages over the measured part of all replicas. Each replica is divided into `blocks`."""
    replicas = [_blocks_of(run, gap, blocks, bins) for run in runs(point)]
    return Averages(
        *(np.concatenate([getattr(replica, key) for replica in replicas]) for key in vars(replicas[0]))
    )


def _blocks_of(run: Run, gap: Gap, blocks: int, bins: int) -> Averages:
    parts, grid, walls = Blocks(run, blocks), gap.grid(bins), slice(0, 2)
    volume, radius = parts.length * gap.area * grid.volume, run.scene.smallest_radius
    positions, velocities = run.positions[:, :, 0] - radius, run.velocities
    along = velocities[parts.ends, :, 1]
    moment = (along * (positions[parts.ends] - 0.5 * gap.length)).sum(axis=1)
    cells = grid.cells(positions[..., None], inside=True)
    shear = parts.growth("wall_shear")[:, walls, 1]

    def total(weights: np.ndarray | None) -> np.ndarray:
        return parts.sums(grid, cells, weights) / volume

    return Averages(
        stress=0.5 * (shear[:, 0] - shear[:, 1]) / gap.area,
        pressure=parts.means(face_pressures(run)[:, walls].mean(axis=1)),
        density=total(None),
        flow=total(velocities[:, :, 1]),
        squares=np.stack([total(velocities[:, :, k] ** 2) for k in range(gap.dimension)], axis=2),
        changes=np.diff(np.column_stack([along.sum(axis=1), moment]), axis=0),
    )


def _flow(point: Point, settings: dict) -> dict[str, Any]:
    """Return the numbers of one flow."""
    setting = FlowBetweenPlates.of(point, settings)
    gap, speed = setting.gap, setting.speed
    blocks = _gap_blocks(point, gap, settings["blocks"], settings["bins"])
    profiles = blocks.density, blocks.flow, blocks.squares

    def numbers(*means: Any) -> np.ndarray:
        return _gap_numbers(setting, *means)

    estimates = Estimate(
        *jackknife(numbers, blocks.steady, blocks.pressure, *profiles), len(blocks.stress) - 1
    )
    (flow, temperature), (flow_error, temperature_error) = jackknife(
        lambda *means: np.stack(_profile(*means)[:2]), *profiles
    )
    density = point.scene.count / (gap.length * gap.area)
    return {
        "packing_fraction": setting.packing_fraction(blocks.density[:, setting.middle].mean()),
        "knudsen": _path(density, setting.diameter, setting.dilute) / gap.length,
        "speed": speed,
        "stress": estimates[0] / float(theory.free_molecular_stress(density, speed, gap.hot)),
        **dict(zip(NUMBERS, estimates[1:], strict=True)),
        "place": setting.position / gap.length,
        "flow": (flow / speed, flow_error / speed),
        "temperature": (temperature / gap.hot, temperature_error / gap.hot),
    }


def _profile(
    density: np.ndarray, flow: np.ndarray, squares: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Compute velocity (B,), temperature (B,) and temperature of each component (B, d)."""
    velocity = flow / density
    energies = squares / density[:, None]
    energies[:, 1] -= velocity**2
    return velocity, energies.mean(axis=1), energies


def _gap_numbers(
    setting: FlowBetweenPlates, stress: float, pressure: float, *averages: np.ndarray
) -> np.ndarray:
    """Compute the stress and `NUMBERS`, from averages over a run.

    Across the gap T + b u^2 is constant (`theory.viscous_heating`). The viscosity grows like sqrt(T).
    Therefore u = g x (1 + c x^2) with c = b g^2 / 6 T, to first order in c; g is the gradient in the middle.
    """
    density, middle = averages[0], setting.middle
    velocity, temperature, energies = _profile(*averages)
    weight, x = density[middle], setting.position[middle]
    weight = weight / weight.sum()
    u, warmth, mean = velocity[middle], temperature[middle], float(density[middle].mean())
    within, gradient = float(weight @ temperature[middle]), _slope(x, u, weight)
    eta = setting.packing_fraction(mean)
    shape = 3, setting.diameter
    enskog = float(theory.enskog_viscosity(eta, *shape, temperature=within)) * setting.coarse
    half, width = 0.5 * setting.gap.length, float(np.abs(x).max()) + 0.5 * (x[1] - x[0])
    heated = float(theory.viscous_heating(eta, 3)) * gradient**2
    bend = heated / (6.0 * within)
    centre = gradient * (1.0 - 0.6 * bend * width**2)  # the slope of x^3 by least squares is 3/5 width^2
    edge, at_edge = centre * half * (1.0 + bend * half**2), centre * (1.0 + 3.0 * bend * half**2)
    cooler = within - heated * (half**2 - width**2 / 3.0)
    path = _path(mean * within / cooler, setting.diameter, setting.dilute)
    parts = weight @ energies[middle] / within - 1.0
    state = mean * within * float(theory.compressibility_factor(eta, 3))
    return np.array([
        stress,
        stress / gradient / enskog,
        (0.5 * setting.speed - edge) / (at_edge * path),
        -_slope(u**2, warmth, weight),
        *parts,
        pressure / state,
        stress / pressure,
    ])  # fmt: skip


def _slope(x: np.ndarray, y: np.ndarray, weight: np.ndarray) -> float:
    """Compute the slope of y against x by weighted least squares.

    The weights have the sum 1.
    """
    apart = x - weight @ x
    return float(weight @ (apart * y) / (weight @ apart**2))
