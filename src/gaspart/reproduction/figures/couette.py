"""Couette flow of a gas between sliding walls, and shear without walls: viscosity, slip, heating.

The walls are the faces of the first axis, the flow is along the second, and positions are relative to the
middle. Without walls (`scene.faces.LeesEdwards`) the flow is along the first axis, its gradient along the
second. Particles have mass 1; both walls have the same temperature.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import asdict
from typing import Any

import numpy as np
import xarray as xr

from gaspart import theory
from gaspart.analysis.estimate import Estimate
from gaspart.analysis.run import Run
from gaspart.analysis.series import Blocks, face_pressures
from gaspart.analysis.statistics import combine_estimates, fit_linear, jackknife
from gaspart.keys import count, names, positive, record
from gaspart.rendering import style
from gaspart.rendering.style import Axes, Figure
from gaspart.reproduction.claims import Claim
from gaspart.reproduction.figure import Parts, runs
from gaspart.reproduction.figures._gap import Gap
from gaspart.reproduction.figures.transport import ACCURATE, ENSKOG, FEW_PER_CENT, coefficient
from gaspart.reproduction.points.point import Point
from gaspart.reproduction.table import Row, Table, table
from gaspart.scene.boundaries import thermal_face
from gaspart.theory.discretisation import cell_factor, step_factor
from gaspart.theory.shear import ELEMENTARY_SLIP, NORMAL_STRESSES, VELOCITY_SLIP, viscous_heating

TITLE, CHAPTER = "Shear between sliding walls", "Motion and its memory"
SETTINGS = {
    "parts": record(
        {
            "flows": names("gases between walls that slide"),
            "sheared": names("periodic gases that are sheared without walls"),
            "equilibrium": names("gases with correlations of the stress, as `viscosity`"),
        },
        "the experiments of each part",
    ),
    "blocks": count("stretches of each run"),
    "bins": count("bins across the gap"),
    "clear": positive("distance from the walls, in mean free paths or diameters, of what is measured"),
}
NUMBERS = ("viscosity", "slip", "heating", "normal_x", "normal_y", "normal_z", "pressure", "reduced_rate")
"""Viscosity over Enskog's, slip over mean free path and gradient, -dT/du^2, energy of each component over
their mean less 1, pressure over that of the equation of state, stress over pressure."""
UNIFORM = ("viscosity", "reduced_rate", "normal_y", "normal_x", "normal_z")
"""The same of a gas that is sheared without walls: x is along the gradient, y along the flow."""


def measure(points: list[Point], settings: dict) -> xr.Dataset:
    """Measure flows between sliding walls, uniformly sheared gases, and the viscosity from equilibrium."""
    gases = [
        (part, point)
        for part, experiments in settings["parts"].items()
        for point in points
        if point.experiment in experiments
    ]
    units = {"place": "gap", "flow": "speed of the walls", "temperature": "temperature of the walls"}
    return table("point", gases, _row, settings, inner=("bin",), units=units)


def _row(gas: tuple[str, Point], settings: dict) -> dict[str, Any]:
    part, point = gas
    row = {"part": part, "engine": point.engine.title}
    if part != "equilibrium":
        return row | (_measure_flow if part == "flows" else _uniform)(point, settings)
    of_infinite = coefficient(point, "viscosity")
    viscosity = of_infinite["value"] / of_infinite["finite"]
    return row | {"packing_fraction": of_infinite["packing_fraction"], "viscosity": viscosity}


def _uniform(point: Point, settings: dict) -> dict[str, Any]:
    """Measure `UNIFORM`; the gas heats up, so Enskog's viscosity is that at each instant."""
    scene, pressures, stresses = point.scene, [], []
    eta = scene.packing_fraction
    assert scene.shear_rate is not None
    for run in runs(point):
        parts, root = Blocks(run, settings["blocks"]), np.sqrt(run.temperatures)
        unit = float(theory.enskog_viscosity(eta, 3, 2.0 * scene.smallest_radius))
        pressures.append(parts.growth("stress_sum") / scene.container.volume)
        stresses.append(scene.shear_rate * parts.means(unit * 0.5 * (root[1:] + root[:-1])))

    def numbers(pressures: np.ndarray, expected: float) -> np.ndarray:
        along = np.diag(pressures)
        mean, stress = along.mean(), -pressures[1, 0]
        return np.array([stress / expected, stress / mean, *(along / mean - 1.0)])

    series = np.concatenate(pressures), np.concatenate(stresses)
    estimates = Estimate(*jackknife(numbers, *series), len(series[0]) - 1)
    return {"packing_fraction": eta, **dict(zip(UNIFORM, estimates, strict=True))}


class Flow:
    """Gas between plates: spheres that occupy no volume if `dilute`, as in DSMC; `middle` are inner bins.
    `coarse` is the viscosity with the engine's cells and steps, divided by the exact viscosity.
    """

    def __init__(self, point: Point, settings: dict) -> None:
        scene, engine = point.scene, point.engine
        gap = self.gap = Gap.of(scene)
        low, high = (thermal_face(scene, name).velocity or (0.0, 0.0) for name in ("x_low", "x_high"))
        self.speed, self.diameter, self.coarse = high[1] - low[1], 2.0 * scene.smallest_radius, 1.0
        self.density, self.dilute = scene.count / (gap.length * gap.area), engine.equation != "exact"
        path = self.path(self.density)
        self.position = gap.grid(settings["bins"]).middles[0] - 0.5 * gap.length
        clear = settings["clear"] * max(path, 0.0 if self.dilute else self.diameter)
        self.middle = np.abs(self.position) < 0.5 * gap.length - min(clear, gap.length / 3.0)
        if self.dilute:  # only the width of the cells across the gap matters
            keys = asdict(engine.for_scene(scene, point.schedule.sample_interval))
            width = gap.length / keys["cells_per_side"][0] / path
            step = keys["time_step"] * math.sqrt(2.0) / path
            self.coarse = float(cell_factor("viscosity", width) * step_factor("viscosity", step))

    def path(self, density: float) -> float:
        """Return the mean free path."""
        eta = float(theory.packing_fraction(density, 3, self.diameter))
        return float(theory.mean_free_path(eta, 3, self.diameter, contact=1.0 if self.dilute else None))

    def packing_fraction(self, density: float) -> float:
        """Return the packing fraction for theory at a number density."""
        return 0.0 if self.dilute else float(theory.packing_fraction(density, 3, self.diameter))

    def numbers(self, stress: float, pressure: float, *averages: np.ndarray) -> np.ndarray:
        """Compute the stress and `NUMBERS`, from averages over a run. Across the gap T + b u^2 is constant
        (`shear.viscous_heating`). The viscosity grows like sqrt(T). Therefore u = g x (1 + c x^2) with c = b
        g^2 / 6 T, to first order in c; g is the gradient in the middle.
        """
        density, middle = averages[0], self.middle
        velocity, temperature, energies = _profile(*averages)
        weight, x = density[middle], self.position[middle]
        weight = weight / weight.sum()
        u, warmth, mean = velocity[middle], temperature[middle], float(density[middle].mean())
        within, gradient = float(weight @ temperature[middle]), _slope(x, u, weight)
        eta = self.packing_fraction(mean)
        enskog = float(theory.enskog_viscosity(eta, 3, self.diameter, temperature=within)) * self.coarse
        half, width = 0.5 * self.gap.length, float(np.abs(x).max()) + 0.5 * (x[1] - x[0])
        heated = float(viscous_heating(eta, 3)) * gradient**2
        bend = heated / (6.0 * within)
        centre = gradient * (1.0 - 0.6 * bend * width**2)  # the slope of x^3 by least squares is 3/5 width^2
        edge, at_edge = centre * half * (1.0 + bend * half**2), centre * (1.0 + 3.0 * bend * half**2)
        cooler = within - heated * (half**2 - width**2 / 3.0)
        path = self.path(mean * within / cooler)
        return np.array([
            stress,
            stress / gradient / enskog,
            (0.5 * self.speed - edge) / (at_edge * path),
            -_slope(u**2, warmth, weight),
            *(weight @ energies[middle] / within - 1.0),
            pressure / (mean * within * float(theory.compressibility_factor(eta, 3))),
            stress / pressure,
        ])  # fmt: skip


def _profile(
    density: np.ndarray, flow: np.ndarray, squares: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Compute velocity (B,), temperature (B,) and temperature of each component (B, d)."""
    velocity = flow / density
    energies = squares / density[:, None]
    energies[:, 1] -= velocity**2
    return velocity, energies.mean(axis=1), energies


def _slope(x: np.ndarray, y: np.ndarray, weight: np.ndarray) -> float:
    """Compute the slope of y against x by least squares; the weights have the sum 1."""
    apart = x - weight @ x
    return float(weight @ (apart * y) / (weight @ apart**2))


def _measure_flow(point: Point, settings: dict) -> dict[str, Any]:
    flow = Flow(point, settings)
    gap, speed = flow.gap, flow.speed
    of_runs = (_averages(run, gap, settings["blocks"], settings["bins"]) for run in runs(point))
    stress, pressure, *profiles, changes = map(np.concatenate, zip(*of_runs, strict=True))
    # without the momentum that a block stores; see `statistics.steady_mean`
    design = np.column_stack([np.ones(len(stress)), changes / np.abs(changes).max(axis=0)])
    steady = stress - design[:, 1:] @ fit_linear(design, stress).values[1:]
    estimates = Estimate(*jackknife(flow.numbers, steady, pressure, *profiles), len(stress) - 1)
    (velocity, temperature), (velocity_error, temperature_error) = jackknife(
        lambda *means: np.stack(_profile(*means)[:2]), *profiles
    )
    return {
        "packing_fraction": flow.packing_fraction(profiles[0][:, flow.middle].mean()),
        "knudsen": flow.path(flow.density) / gap.length,
        "speed": speed,
        "stress": estimates[0] / float(theory.free_molecular_stress(flow.density, speed, gap.hot)),
        **dict(zip(NUMBERS, estimates[1:], strict=True)),
        "place": flow.position / gap.length,
        "flow": (velocity / speed, velocity_error / speed),
        "temperature": (temperature / gap.hot, temperature_error / gap.hot),
    }


def _averages(run: Run, gap: Gap, blocks: int, bins: int) -> tuple[np.ndarray, ...]:
    """Average over K blocks of a run: stress and pressure on the walls, then per volume in each of B bins.
    These are particles (K, B), momentum along the flow (K, B), and squared velocities (K, B, d). The last
    item (K, 2) is the change of the total momentum, and of the first moment of the momentum.
    """
    parts, grid, walls = Blocks(run, blocks), gap.grid(bins), slice(0, 2)
    volume, radius = parts.length * gap.area * grid.volume, run.scene.smallest_radius
    positions, velocities = run.positions[:, :, 0] - radius, run.velocities
    along = velocities[parts.ends, :, 1]
    moment = (along * (positions[parts.ends] - 0.5 * gap.length)).sum(axis=1)
    cells = grid.cells(positions[..., None], inside=True)
    shear = parts.growth("wall_shear")[:, walls, 1]

    def total(weights: np.ndarray | None) -> np.ndarray:
        return parts.sums(grid, cells, weights) / volume

    return (
        0.5 * (shear[:, 0] - shear[:, 1]) / gap.area,
        parts.means(face_pressures(run)[:, walls].mean(axis=1)),
        total(None),
        total(velocities[:, :, 1]),
        np.stack([total(velocities[:, :, k] ** 2) for k in range(gap.dimension)], axis=2),
        np.diff(np.column_stack([along.sum(axis=1), moment]), axis=0),
    )


DILUTE_SLIP = 0.03
"""Largest packing fraction of a gas that counts as dilute. The finite volume of its particles changes the
slip by less than this."""
SLIP_FLOW, FREE = 0.08, 20.0
"""Knudsen numbers. Below SLIP_FLOW the middle of a gas is not affected by the walls. Above FREE its particles
fly freely."""
FAST = 2.2
"""Difference of the walls' speeds above which a flow tests effects of second order."""
NEAR = 0.005
"""Largest difference of packing fractions that are compared. The viscosity relative to Enskog theory then
differs by less than 1 %."""
SECOND = 4.0
"""Bound of terms of second order, relative to the square of stress over pressure: 2.5 `NORMAL_STRESSES`."""
ALLOWED = "terms of second order in stress over pressure a: 4 a^2 as 3 sigma"
RESPONSE = "Green and Kubo: the response is linear, its coefficient an integral of fluctuations"
MOMENTS = (
    "moments of the Boltzmann equation (gaspart.theory.shear), exact for Maxwell molecules to second order "
    "[Santos 2009]"
)


def claims(dataset: xr.Dataset) -> Iterator[Claim]:
    """Yield claims on viscosity (the response to shear), slip, free flight, heating and normal stresses."""
    gases = Table(dataset, "point")
    flows, sheared, still = (gases[gases.part == name] for name in ("flows", "sheared", "equilibrium"))
    wide = flows[flows.knudsen < SLIP_FLOW]
    slow, fast = wide[wide.speed < FAST], wide[wide.speed > FAST]
    dense = slow[slow.packing_fraction > DILUTE_SLIP]
    yield from _dilute(slow[slow.packing_fraction < DILUTE_SLIP])
    for flow in dense[dense.packing_fraction < ACCURATE + NEAR]:
        yield Claim.within(
            f"stress over gradient, over Enskog's viscosity, {_gas(flow)}",
            flow.viscosity, 1.0, FEW_PER_CENT,
            f"{ENSKOG}; correlated collisions change it by a few per cent [Alder 1970b]",
            "momentum that does not pass at contacts as the theory states",
        )  # fmt: skip
    yield from _equilibria(dense, sheared, still)
    for flow in slow:
        normal = NORMAL_STRESSES[0] * flow.reduced_rate.value**2
        yield Claim(
            f"pressure on the walls over that of the middle's state, {_gas(flow)}",
            flow.pressure, _second(flow) + (normal if flow.packing_fraction < DILUTE_SLIP else 0.0), 0.005,
            "no force acts across the gap: the equation of state of the middle, and of dilute gases the "
            "normal stress",
            "a wrong momentum on the walls, or a gas that is not in local equilibrium",
            allowance_source=ALLOWED,
        )  # fmt: skip
    for flow in flows[flows.knudsen > FREE]:
        # the first correction is approximately minus the gap divided by the mean free path
        yield Claim.within(
            f"shear stress over that of free flight, {_gas(flow)}",
            flow.stress, 1.0 - 0.5 / flow.knudsen, 1.0 / flow.knudsen,
            "two streams, each with the velocity of the wall that it comes from (exact), less than twice "
            "the gap over the mean free path for collisions",
            "walls that do not give the whole of their velocity",
        )  # fmt: skip
    for flow in fast:
        yield from _of_second_order(flow)


def _gas(gas: Row) -> str:
    """Return the name of a gas: its engine and gap, or its density."""
    if gas.packing_fraction < DILUTE_SLIP:
        return f"dilute spheres, mean free path {gas.knudsen:.2g} of the gap, {gas.engine} engine"
    return f"spheres at packing fraction {gas.packing_fraction:.2f}"


def _second(flow: Row) -> Estimate:
    """Return 1; its 3-sigma uncertainty bounds terms of second order in the stress."""
    return Estimate(1.0, SECOND * flow.reduced_rate.value**2 / 3.0)


def _dilute(dilute: Table) -> Iterator[Claim]:
    for flow in dilute:
        yield Claim(
            f"stress over gradient, over Enskog's viscosity, {_gas(flow)}",
            flow.viscosity, _second(flow), 0.015, ENSKOG,
            "a wrong stress on the walls, or a gradient that includes the slip",
            allowance_source=ALLOWED, alternative=1.0 / (1.0 + 2.0 * VELOCITY_SLIP * flow.knudsen),
        )  # fmt: skip
    yield Claim(
        "velocity slip of dilute spheres over mean free path and gradient",
        combine_estimates(dilute.slip), VELOCITY_SLIP, 0.05,
        "the linearised Boltzmann equation of spheres [Ohwada 1989], derived again by moments",
        "particles that leave a wall with the distribution of another velocity", alternative=ELEMENTARY_SLIP,
    )  # fmt: skip


def _equilibria(dense: Table, sheared: Table, still: Table) -> Iterator[Claim]:
    """Yield claims on viscosities over that from the fluctuations of the stress, at the same density."""

    def ratios(responses: Table) -> dict[str, Estimate]:
        result = {}
        for gas in responses:
            apart = np.abs(still.packing_fraction - gas.packing_fraction)
            if np.any(apart < NEAR):
                result[_gas(gas)] = gas.viscosity / still[int(apart.argmin())].viscosity
        return result

    between = ratios(dense)
    stated = {name: (ratio, 0.03) for name, ratio in between.items()}
    stated["spheres at all densities"] = combine_estimates(list(between.values())), 0.015
    for name, (ratio, required) in stated.items():
        yield Claim(
            f"viscosity from the response over that from equilibrium, {name}", ratio, 1.0, required, RESPONSE,
            "a stress tensor, or momentum on the walls, that is not that of the particles",
            follows=name not in between,
        )  # fmt: skip
    for name, ratio in ratios(sheared).items():
        yield Claim(
            f"viscosity from uniform shear over that from equilibrium, {name}", ratio, 1.0, 0.03, RESPONSE,
            "images that slide at another speed, or a stress that contains the flow",
        )  # fmt: skip


def _of_second_order(flow: Row) -> Iterator[Claim]:
    """Yield claims on the parabola of temperature, and on normal stresses at the walls and in the middle."""
    yield Claim(
        f"-dT/du^2 over half of viscosity over conductivity, walls of speed {flow.speed:g}",
        flow.heating / float(viscous_heating(flow.packing_fraction, 3)), 1.0, 0.05,
        f"heat made by the stress flows to the walls; {ENSKOG}",
        "work of the walls that is not conserved as heat", alternative=1.5,
    )  # fmt: skip
    square = flow.reduced_rate.value**2
    across, along, _ = NORMAL_STRESSES
    newtonian = "a gas that is Newtonian, in which this is 0"
    yield Claim.within(
        "stress on the walls less pressure, over pressure and squared rate of shear",
        (flow.pressure - 1.0) / square, across, 0.1 * abs(across),
        f"{MOMENTS}; a tenth for spheres and higher orders", newtonian,
    )  # fmt: skip
    yield Claim.at_least(
        "stress along flow less that along gradient, over pressure and squared rate of shear",
        (flow.normal_y - flow.normal_x) / square, 0.5 * (along - across), 0.25,
        f"{MOMENTS}; half of it, since the sign and the size are claimed", newtonian,
    )  # fmt: skip


DSMC, EVENT = "DSMC", "event-driven"


def draw(dataset: xr.Dataset) -> Figure:
    """Draw profiles of velocity and temperature, stress, viscosity, slip and normal stresses."""
    figure, axes = style.new(*[(2.4,)] * 6)
    gases = Table(dataset, "point")
    flows = gases[gases.part == "flows"]
    dilute, slow = flows[flows.packing_fraction < DILUTE_SLIP], flows[flows.speed < FAST]
    wide = flows[flows.knudsen < SLIP_FLOW]
    _draw_velocity(axes[0], slow)
    _draw_temperature(axes[1], wide[wide.engine == DSMC])
    _draw_stress(axes[2], dilute[dilute.speed < FAST])
    _draw_viscosity(axes[3], wide[wide.speed < FAST], gases)
    _draw_slip(axes[4], wide[wide.speed < FAST])
    _draw_normal(axes[5], flows[(flows.knudsen < FREE) & (flows.engine == DSMC)])
    style.letters(*axes)
    return figure


def _draw_velocity(axis: Axes, slow: Table) -> None:
    names, eta = ("free flight", "dilute", "dense"), slow.packing_fraction
    thin = (slow.knudsen < SLIP_FLOW) & (eta < DILUTE_SLIP)
    line = np.array([-0.5, 0.5])
    axis.plot(line, line, color=style.GREY, lw=0.8, label="no slip")
    for kind, chosen in enumerate((slow.knudsen > FREE, thin, eta > DILUTE_SLIP)):
        if flows := slow[chosen]:
            last = flows[-1]
            style.points(axis, last.place, last.flow, kind=kind, label=names[kind])
            if chosen is thin:
                slope = 1.0 / (1.0 + 2.0 * VELOCITY_SLIP * last.knudsen)
                axis.plot(line, slope * line, color=style.COLOURS[kind], lw=0.8)
    style.label_axes(axis, "position in the gap $x/L$", "velocity of the gas $u/U$", "upper left")


def _draw_temperature(axis: Axes, wide: Table) -> None:
    kinds = {"fast walls": wide[wide.speed > FAST], "slow walls": wide[wide.speed < FAST]}
    for kind, (name, flows) in enumerate(kinds.items()):
        if flows:
            first = flows[0]
            square = (first.speed * first.flow.value) ** 2
            style.points(axis, square, first.temperature, kind=kind, label=name)
            slope, reach = float(viscous_heating(0.0, 3)), np.array([0.0, square.max()])
            top = first.temperature.value[square.argmin()]
            axis.plot(reach, top - slope * reach, color=style.COLOURS[kind], lw=0.8)
    labels = r"squared velocity of the gas $u^2$", "temperature / wall temperature"
    style.label_axes(axis, *labels, legend="upper right")


def _draw_engines(axis: Axes, flows: Table, x: str, y: str, label: str = "", hollow: bool = False) -> None:
    for kind, engine in enumerate((DSMC, EVENT)):
        own = flows[flows.engine == engine]
        look: dict[str, Any] = {"kind": kind, "hollow": hollow and kind == 1, "label": label + engine}
        style.points(axis, getattr(own, x), getattr(own, y), **look)


def _draw_stress(axis: Axes, dilute: Table) -> None:
    _draw_engines(axis, dilute, "knudsen", "stress", hollow=True)
    knudsen = np.geomspace(0.02, 0.5, 50)
    density = 1.0 / (np.sqrt(2.0) * np.pi)  # number density of spheres of diameter 1 with mean free path 1
    slip = theory.slip_flow_stress(1.0 / knudsen, density, 1.0) / theory.free_molecular_stress(density, 1.0)
    axis.plot(knudsen, slip, color=style.GREY, lw=0.8, label="viscous, with slip")
    axis.axhline(1.0, color=style.GREY, lw=0.8, ls=":", label="free flight")
    axis.set(xscale="log", yscale="log")
    style.label_axes(axis, r"Knudsen number $\lambda/L$", "stress / free-flight stress", "lower right")


def _draw_viscosity(axis: Axes, slow: Table, gases: Table) -> None:
    _draw_engines(axis, slow, "packing_fraction", "viscosity", "response, ")
    sheared, still = gases[gases.part == "sheared"], gases[gases.part == "equilibrium"]
    apart = 0.005  # so that points do not cover each other
    eta = sheared.packing_fraction - apart
    style.points(axis, eta, sheared.viscosity, kind=3, label="response, without walls")
    eta = still.packing_fraction + apart
    style.points(axis, eta, still.viscosity, kind=2, hollow=True, label="Green-Kubo")
    axis.axhline(1.0, color=style.GREY, lw=0.8, label="Enskog")
    style.label_axes(axis, r"packing fraction $\phi$", r"$\eta/\eta_\mathrm{Enskog}$", "upper left")


def _draw_slip(axis: Axes, slow: Table) -> None:
    _draw_engines(axis, slow, "packing_fraction", "slip")
    axis.axhline(VELOCITY_SLIP, color=style.GREY, lw=0.8, label="Boltzmann equation")
    axis.axhline(ELEMENTARY_SLIP, color=style.GREY, lw=0.8, ls=":", label="Maxwell's estimate")
    labels = r"packing fraction $\phi$", r"slip / $(\lambda\,\mathrm{d}u/\mathrm{d}x)$"
    style.label_axes(axis, *labels, legend="upper left")


def _draw_normal(axis: Axes, dilute: Table) -> None:
    square = dilute.reduced_rate.value**2
    fine = np.linspace(0.0, 1.1 * square[dilute.knudsen < SLIP_FLOW].max(), 2)
    names = {"gradient": dilute.normal_x, "flow": dilute.normal_y, "vorticity": dilute.normal_z}
    for kind, ((name, stress), slope) in enumerate(zip(names.items(), NORMAL_STRESSES, strict=True)):
        style.points(axis, square, stress, kind=kind, label=f"along the {name}")
        axis.plot(fine, slope * fine, color=style.COLOURS[kind], lw=0.8)
    axis.set(xlim=(0.0, fine[-1]), ylim=[1.6 * fine[-1] * slope for slope in (-1.2, 2.0)])
    axis.locator_params(axis="x", nbins=5)
    style.label_axes(axis, "(stress / pressure)$^2$, $a^2$", "normal stress / mean $-$ 1", "upper left")


FIGURES = {"couette": Parts(SETTINGS, measure, claims, draw, key=3)}
