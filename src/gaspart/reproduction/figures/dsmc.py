"""Errors of cells, steps and models of DSMC, relative to theory and the event-driven engine.

The literature states discretisation errors in the same units: widths of cells in mean free paths l of the
dilute gas, 1 / (sqrt 2 pi n sigma^2), and steps in l / c with c = sqrt(2 k_B T / m). Transport coefficients
are divided by the Chapman-Enskog values. The effect of the finite number of particles is removed.
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
from gaspart.analysis.expected.equilibrium import collision_rate, compressibility_factor
from gaspart.analysis.motion import average_correlations
from gaspart.analysis.run import Run
from gaspart.analysis.statistics import combine_estimates, fit_linear, mean_of
from gaspart.analysis.transport import green_kubo
from gaspart.keys import count, names, record
from gaspart.rendering import style
from gaspart.rendering.style import Axes, Figure
from gaspart.reproduction.claims import Claim
from gaspart.reproduction.figure import Parts, series_of
from gaspart.reproduction.figures._gap import Gap, averages
from gaspart.reproduction.figures.msd_spheres import spheres
from gaspart.reproduction.points.point import Point
from gaspart.reproduction.table import Table, entries, table
from gaspart.scene.facts import plain_gas
from gaspart.theory import bulk
from gaspart.theory.discretisation import CELL_COEFFICIENTS, STEP_COEFFICIENTS, cell_factor, step_factor
from gaspart.theory.heat import free_molecular_flux
from gaspart.trajectory.reading import open_trajectory

TITLE, CHAPTER = "Direct simulation Monte Carlo", "Speed and accuracy"
SETTINGS = {
    "blocks": count("stretches of each run between plates"),
    "parts": record(
        {
            "fluxes": names("dilute gases with correlations of the stress"),
            "paths": names("dilute gases with displacements"),
            "dense": names("the Enskog model"),
            "plates": names("gases between a hot and a cold plate"),
            "event_paths": names("gases of the event-driven engine, as `msd_spheres`"),
            "event_plates": names("gases of the event-driven engine between such plates"),
        },
        "the experiments of each part",
    ),
}
DILUTE = 1e-12  # packing fraction of a gas so dilute that the Boltzmann equation is exact


def measure(points: list[Point], settings: dict) -> xr.Dataset:
    """Measure transport coefficients with cells and steps, the dense gas, and fluxes between plates."""
    parts = [
        (part, point)
        for part, experiments in settings["parts"].items()
        for point in points
        if point.experiment in experiments
    ]
    units = {"width": "mean free path", "step": "mean free path / sqrt(2 k_B T / m)"}
    dataset = table("point", parts, _measure, settings["blocks"], units=units)
    return dataset.assign(entries(_fit_transfer(Table(dataset, "point"))))


def _measure(of: tuple[str, Point], blocks: int) -> dict[str, Any]:
    part, point = of
    row = {"part": part, "engine": point.engine.title}
    match part:
        case "fluxes":
            return row | _resolution(point) | _fluxes(point)
        case "paths":
            return row | _resolution(point) | {"diffusion": mean_of(_running_diffusion(point))}
        case "dense":
            return row | _dense(point)
        case "event_paths":
            return row | _event_paths(point)
    return row | _plates(point, blocks)


def _resolution(point: Point) -> dict[str, float]:
    """Compute the width of the cells and the length of a step."""
    gas = plain_gas(point.scene)
    path = float(theory.mean_free_path(gas.packing_fraction, 3, gas.diameter, contact=1.0))
    engine = asdict(point.engine.for_scene(point.scene, point.schedule.sample_interval))
    sides = np.array(point.scene.container.lengths) / np.array(engine["cells_per_side"])
    speed = math.sqrt(2.0) * gas.thermal_speed
    return {"width": float(sides.max()) / path, "step": engine["time_step"] * speed / path}


def _runs(point: Point) -> Iterator[Run]:
    """Yield each replica from its start, which is in equilibrium; some have few frames."""
    for path in point.replica_paths:
        with open_trajectory(path) as trajectory:
            yield Run(point.scene, trajectory["time"].values, trajectory)


def _fluxes(point: Point) -> dict[str, Any]:
    """Measure viscosity and conductivity of an infinite gas by Green and Kubo, up to the longest lag. The
    transfer at collisions is the part of the viscosity that cells add.
    """
    gas = plain_gas(point.scene)
    shear, heat = (
        theory.transport_finite_size_factor(gas.count, 3, name) for name in ("viscosity", "conductivity")
    )
    share, viscosity = 1.0 - 1.0 / gas.count, theory.enskog_viscosity(DILUTE, 3, **gas.particle)
    exact = {
        "viscosity": (("shear", "rotational"), shear * viscosity),
        "transfer": (("collisional", "rotational"), share * viscosity),
        "conductivity": (("heat",), heat * theory.enskog_conductivity(DILUTE, 3, **gas.particle)),
    }
    ratios: dict[str, list[float]] = {name: [] for name in exact}
    for run in _runs(point):
        for name, (fluxes, value) in exact.items():
            ratios[name] += list(np.sum([green_kubo(run, flux)[:, -1] for flux in fluxes], axis=0) / value)
    return {name: mean_of(values) for name, values in ratios.items()}


def _running_diffusion(point: Point) -> np.ndarray:
    """Compute D of each replica (R,) at the longest lag, divided by the value of a dilute gas. A particle has
    only N - 1 partners, and therefore keeps its velocity longer. In the frame of the centre of mass, the mean
    square velocity is lower by the same factor. At a given density this D is therefore independent of N.
    """
    dilute = theory.enskog_diffusion(**plain_gas(point.scene).parameters, contact=1.0)
    return np.array([average_correlations(run.data).running[-1] for run in _runs(point)]) / float(dilute)


def _dense(point: Point) -> dict[str, Any]:
    """Measure Z, collision rate and D of the dense-gas model, divided by theory for N particles. Model and
    theory use the contact value of Carnahan and Starling.
    """
    gas = plain_gas(point.scene)
    excess, rate = [], []
    for run in _runs(point):
        series, theories = series_of(run), (compressibility_factor(run), collision_rate(run))
        z, own = (expected.value for expected in theories if expected)
        excess.append((series.z.mean() - 1.0) / (z - 1.0))
        rate.append(series.rate.mean() / own)
    diffusion = mean_of(_running_diffusion(point) * bulk.contact_value(gas, bulk.ENSKOG))
    row = {"packing_fraction": gas.packing_fraction, "excess": mean_of(excess), "rate": mean_of(rate)}
    return row | {"diffusion": diffusion}


def _event_paths(point: Point) -> dict[str, Any]:
    """Return D of the event-driven engine in an infinite container, divided by Enskog theory."""
    row = spheres(point)
    infinite = row["diffusion"] + Estimate(row["correction"], row["correction_uncertainty"])
    eta = row["packing_fraction"]
    return {"packing_fraction": eta, "diffusion": infinite / float(theory.enskog_diffusion(eta, 3))}


def _plates(point: Point, blocks: int) -> dict[str, Any]:
    """Measure the flux between plates, divided by that of free flight, at l over the gap of centres."""
    scene = point.scene
    gap, diameter = Gap.of(scene), 2.0 * scene.kinds[0].radius
    density = scene.count / (gap.length * gap.area)
    path = theory.mean_free_path(theory.packing_fraction(density, 3, diameter), 3, diameter, contact=1.0)
    free = float(free_molecular_flux(density, gap.hot, gap.cold, 3))
    return {
        "knudsen": float(path) / gap.length,
        "packing_fraction": scene.packing_fraction,
        "flux": averages(point, gap, blocks, 1).flux() / free,
    }


SHORT, NARROW = 1.0, 0.6  # largest step and width of cells at which the transfer at collisions is fitted


def _fit_transfer(gases: Table) -> dict[str, Estimate]:
    """Fit the transfer at collisions, divided by width^2, linearly in width and step. In a wider cell, a
    particle is often still near its last collision at the next one, and returns the momentum that it
    received. The same happens if there are several collisions in a step. Therefore the transfer is less than
    its limit, by terms linear in width and step.
    """
    names = ("coefficient", "width_slope", "step_slope")
    fluxes = gases[gases.part == "fluxes"]
    fine = fluxes[(fluxes.step < SHORT) & (fluxes.width < NARROW)] if fluxes else fluxes
    if len(fine) < len(names):
        return dict.fromkeys(names, Estimate(math.nan, math.nan))
    design = np.stack([np.ones(len(fine)), fine.width, fine.step], axis=1)
    fit = fit_linear(design, fine.transfer / fine.width**2)
    return {name: fit.estimate(n) for n, name in enumerate(names)}


POWER = 0.1  # largest relative uncertainty with which a coefficient is tested
SEEN = 0.02  # smallest relative change of a transport coefficient that tests the coefficient of the change
WIDE = 1.5  # width of cells, in mean free paths, from which the diffusion coefficient is tested
# The volume of the spheres changes the flux between plates by less than 4 times the packing fraction.
POINTLIKE = 0.003
# Exact coefficients of dilute spheres over their first Sonine approximation.
SONINE = {"viscosity": 1.0160, "conductivity": 1.0252, "diffusion": 1.01895}


def claims(dataset: xr.Dataset) -> Iterator[Claim]:
    """Yield the claims on cells and steps, on the dense gas, and on plates."""
    gases = Table(dataset, "point")
    fluxes, paths, dense, plates, event = (
        gases[gases.part == part] for part in ("fluxes", "paths", "dense", "plates", "event_plates")
    )
    of = {"viscosity": fluxes, "conductivity": fluxes, "diffusion": paths}
    for quantity, own in of.items():
        fine = own[_predict(quantity, own) < 1.0 + SEEN]
        yield Claim(
            f"{quantity} over Chapman and Enskog's, with narrow cells and short steps",
            combine_estimates(getattr(fine, quantity) / _predict(quantity, fine)), 1.0, 0.02,
            "[Chapman 1970], with the Sonine polynomials that matter",
            "pairs drawn with a wrong chance, or scattering that is not isotropic",
            alternative=1.0 / SONINE[quantity],
        )  # fmt: skip
    cells = CELL_COEFFICIENTS["viscosity"]
    yield Claim(
        "coefficient of (width/l)^2 in the viscosity, narrow cells",
        gases.coefficient, cells, POWER * cells, "[Alexander 1998]",
        "partners that are not drawn from the whole cell, or momentum that is not conserved", alternative=0.0,
    )  # fmt: skip
    for quantity, expected in STEP_COEFFICIENTS.items():
        long = of[quantity][step_factor(quantity, of[quantity].step) - 1.0 > SEEN]
        added = getattr(long, quantity) / cell_factor(quantity, long.width) - 1.0
        strength = combine_estimates(added / (step_factor(quantity, long.step) - 1.0))
        yield Claim(
            f"coefficient of (c step/l)^2 in the {quantity}", strength * expected, expected,
            POWER * expected, "[Hadjiconstantinou 2000]; [Garcia 2000]",
            "particles that fly for other times than a step between their collisions", alternative=0.0,
        )  # fmt: skip
    wide = paths[paths.width > WIDE]
    yield Claim(
        f"diffusion over Chapman and Enskog's, with cells wider than {WIDE:g} mean free paths",
        combine_estimates(wide.diffusion / _predict("diffusion", wide)), 1.0, 0.01,
        "a particle's own displacement passes nothing on",
        "collisions that move particles, or whose number depends on the cell",
        alternative=float(cell_factor("conductivity", WIDE)),
    )  # fmt: skip
    for gas in dense:
        where = f"in the Enskog model at packing fraction {gas.packing_fraction:g}"
        ratios = {"Z - 1 over Carnahan and Starling's": gas.excess, "collision rate over Enskog's": gas.rate}
        for subject, ratio in ratios.items():
            yield Claim(
                f"{subject} {where}", ratio, 1.0, 0.003,
                "the contact value of Carnahan and Starling, which the model is given",
                "a wrong chance to collide, or a loss of pairs that approach",
            )  # fmt: skip
        yield Claim(
            f"diffusion over Enskog's {where}", gas.diffusion, 1.0, 0.01,
            "Enskog theory, 1.01895 times the first Sonine approximation",
            "correlated collisions, which this model does not have",
            alternative=theory.erpenbeck_wood_ratio(gas.packing_fraction),
        )  # fmt: skip
    yield from _claims_on_plates(plates, event)


def _claims_on_plates(plates: Table, event: Table) -> Iterator[Claim]:
    for gas in plates:
        beside = event[np.abs(event.knudsen / gas.knudsen - 1.0) < 0.02]
        if not beside or beside[0].packing_fraction > POINTLIKE:
            continue
        yield Claim(
            f"heat flux by DSMC over that of the event-driven engine at Kn = {gas.knudsen:.2g}",
            gas.flux / beside[0].flux, Estimate(1.0, 4.0 * beside[0].packing_fraction / 3.0), 0.03,
            "the Boltzmann equation is that of hard spheres in the dilute limit",
            "wrong draws at thermal faces, wrong mean free path",
            allowance_source="the first order in the density: 4 times the packing fraction, as 3 sigma",
        )  # fmt: skip


def _predict(quantity: str, gases: Table) -> np.ndarray:
    """Compute a transport coefficient with cells and steps, divided by the exact one, (points,)."""
    return np.asarray(cell_factor(quantity, gases.width) * step_factor(quantity, gases.step))


FINE = 0.3  # width of cells and length of steps below which one effect is too small to hide the other


def draw(dataset: xr.Dataset) -> Figure:
    """Draw transport coefficients against cells and steps, flux between plates, and dense gas."""
    figure, (cells, steps, plates, dense) = style.new((2.4,), (2.4,), (2.4,), (2.4,))
    gases = Table(dataset, "point")
    _coarse(cells, gases, "width", "step")
    style.label_axes(cells, r"width of a cell $w/\lambda$")
    _coarse(steps, gases, "step", "width")
    style.label_axes(steps, r"time step $\sqrt{2k_\mathrm{B}T/m}\,\Delta t/\lambda$")
    for kind, (part, title) in enumerate({"event_plates": "event-driven", "plates": "DSMC"}.items()):
        own = gases[gases.part == part]
        style.points(plates, own.knudsen, own.flux, kind=kind, hollow=kind == 1, label=title)
    plates.axhline(1.0, color=style.GREY, lw=0.8, label="free flight")
    plates.set(xscale="log", yscale="log")
    labels = r"Knudsen number $\lambda/L$", "heat flux / free-flight flux", "lower right"
    style.label_axes(plates, *labels)
    _draw_dense(dense, gases[gases.part == "dense"], gases[gases.part == "event_paths"])
    style.letters(cells, steps, plates, dense)
    return figure


def _coarse(axis: Axes, gases: Table, along: str, other: str) -> None:
    """Draw coefficients and theory along widths or steps, for points whose `other` resolution is fine. The
    effect of the `other` resolution is removed.
    """
    factors = {"width": cell_factor, "step": step_factor}
    fine = gases[getattr(gases, other) < FINE]
    curve = np.linspace(0.0, 1.08 * np.nanmax(getattr(gases, along)), 200)
    titles = {"viscosity": "viscosity", "conductivity": "heat conductivity", "diffusion": "self-diffusion"}
    for kind, (quantity, title) in enumerate(titles.items()):
        own = fine[np.isfinite(getattr(fine, quantity).value)]
        ratio = getattr(own, quantity) / factors[other](quantity, getattr(own, other))
        style.points(axis, getattr(own, along), ratio, kind=kind, label=title)
        axis.plot(curve, factors[along](quantity, curve), color=style.COLOURS[kind], lw=0.8)
    if along == "width":
        own = fine[np.isfinite(fine.transfer.value)]
        style.points(axis, own.width, 1.0 + own.transfer, hollow=True, label="1 + transfer")
    predicted = "predicted, first order" if along == "width" else "predicted"
    axis.plot([], [], color=style.GREY, lw=0.8, label=predicted)
    style.label_axes(axis, y="ratio to the exact value", legend="upper left", xlim=(0.0, None))


def _draw_dense(axis: Axes, model: Table, spheres: Table) -> None:
    """Draw the dense-gas model and hard spheres, divided by Enskog theory."""
    eta = model.packing_fraction
    style.points(axis, eta - 0.004, model.excess, kind=0, label="$Z-1$, DSMC")
    style.points(axis, eta, model.rate, kind=1, label="collision rate, DSMC")
    style.points(axis, eta + 0.004, model.diffusion, kind=2, label="self-diffusion, DSMC")
    label = "self-diffusion, event-driven"
    style.points(axis, spheres.packing_fraction, spheres.diffusion, kind=2, hollow=True, label=label)
    curve = np.linspace(0.0, 0.42, 100)
    axis.plot(curve, theory.erpenbeck_wood_ratio(curve), color=style.GREY, lw=0.8, label="Erpenbeck & Wood")
    axis.axhline(1.0, color=style.GREY, lw=0.8, ls=":")
    labels = r"packing fraction $\eta$", "ratio to Enskog's theory", "upper left"
    style.label_axes(axis, *labels, ylim=(0.95, 1.7))  # with space for the legend


FIGURES = {"dsmc_convergence": Parts(SETTINGS, measure, claims, draw)}
