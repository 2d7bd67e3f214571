"""Errors of cells, steps and models of DSMC, relative to theory and the event-driven engine.

The literature states discretisation errors in the same units. Widths of cells are in mean free paths l of the
dilute gas, 1 / (sqrt 2 pi n sigma^2). Steps are in l / c with c = sqrt(2 k_B T / m). Transport coefficients
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
from gaspart.analysis.statistics import fit_linear, mean_of
from gaspart.analysis.transport import green_kubo
from gaspart.reproduction.families.heat.gap import Gap, averages
from gaspart.reproduction.families.motion.measure import spheres
from gaspart.reproduction.families.shared.runs import series_of
from gaspart.reproduction.points.point import Point
from gaspart.reproduction.table import Table, entries, table
from gaspart.scene.gas import plain_gas
from gaspart.theory import bulk
from gaspart.theory.heat import free_molecular_flux
from gaspart.trajectory.reading import open_trajectory

SHORT, NARROW = 1.0, 0.6
"""Largest length of steps and width of cells at which the transfer at collisions is fitted."""
NONE = 1e-12
"""Packing fraction of a gas so dilute that the Boltzmann equation is exact."""


def dsmc_convergence(points: list[Point], settings: dict) -> xr.Dataset:
    """Measure transport coefficients with cells and steps, the dense gas, and fluxes.

    The settings are `parts`, the experiments of each part, and `blocks`, the time blocks of each run between
    plates. The dimension is point. The suffix `_freedom` marks the degrees of freedom of an error `_error`.

    Each point has part and engine. Further variables depend on the part:

    width, step : resolution, of dilute gases
    viscosity, conductivity, diffusion : coefficients divided by their exact values, of dilute gases
    transfer : viscosity due to transfer at collisions, divided by the exact viscosity, of dilute gases
    packing_fraction, excess, rate : packing fraction, Z - 1 and collision rate, of dense gases
    diffusion : coefficient divided by Enskog theory, of dense gases
    knudsen, flux : l divided by the gap of centres, and flux divided by the flux of free flight, of plates

    Variables without dimension are coefficient, width_slope and step_slope; see `_narrow`.
    """
    measures = {
        "fluxes": _fluxes,
        "paths": _paths,
        "dense": _dense,
        "plates": _plates,
        "event_paths": _event_paths,
        "event_plates": _plates,
    }
    parts = [
        (part, point)
        for part, experiments in settings["parts"].items()
        for point in points
        if point.experiment in experiments
    ]

    def row(of: tuple[str, Point]) -> dict[str, Any]:
        part, point = of
        return {"part": part, "engine": point.engine.title, **measures[part](point, settings)}

    units = {"width": "mean free path", "step": "mean free path / sqrt(2 k_B T / m)"}
    dataset = table("point", parts, row, units=units)
    return dataset.assign(entries(_narrow(Table(dataset, "point"))))


def _narrow(gases: Table) -> dict[str, Estimate]:
    """Fit the transfer at collisions, divided by width^2, for narrow cells and short steps.

    The fit is linear in width and step. In a wider cell, a particle is often still near its last collision at
    the next one, and returns the momentum that it received. The same happens if there are several collisions
    in a step. Therefore the transfer is less than its limit, by terms linear in width and step.
    """
    names = ("coefficient", "width_slope", "step_slope")
    fluxes = gases[gases.part == "fluxes"]
    fine = fluxes[(fluxes.step < SHORT) & (fluxes.width < NARROW)] if fluxes else fluxes
    if len(fine) < len(names):
        return dict.fromkeys(names, Estimate(math.nan, math.nan))
    design = np.stack([np.ones(len(fine)), fine.width, fine.step], axis=1)
    fit = fit_linear(design, fine.transfer / fine.width**2)
    return {name: fit.estimate(n) for n, name in enumerate(names)}


def _dilute_path(point: Point) -> float:
    """Compute the mean free path l of the dilute gas."""
    gas = plain_gas(point.scene)
    return float(theory.mean_free_path(gas.packing_fraction, 3, gas.diameter, contact=1.0))


def _resolution(point: Point) -> dict[str, float]:
    """Compute the width of the cells and the length of a step."""
    gas, path = plain_gas(point.scene), _dilute_path(point)
    engine = asdict(point.engine.for_scene(point.scene, point.schedule.sample_interval))
    sides = np.array(point.scene.container.lengths) / np.array(engine["cells_per_side"])
    speed = math.sqrt(2.0) * gas.thermal_speed
    return {"width": float(sides.max()) / path, "step": engine["time_step"] * speed / path}


def _runs(point: Point) -> Iterator[Run]:
    """Yield each replica from its start, which is in equilibrium, to its end.

    Some replicas have few frames.
    """
    for path in point.replica_paths:
        with open_trajectory(path) as trajectory:
            yield Run(point.scene, trajectory["time"].values, trajectory)


def _fluxes(point: Point, settings: dict) -> dict[str, Any]:
    """Measure viscosity and conductivity of an infinite gas by Green and Kubo.

    The integrals extend to the longest lag.
    """
    gas = plain_gas(point.scene)
    shear, heat = (
        theory.transport_finite_size_factor(gas.count, 3, name) for name in ("viscosity", "conductivity")
    )
    share = 1.0 - 1.0 / gas.count
    exact = {
        "viscosity": (("shear", "rotational"), shear * theory.enskog_viscosity(NONE, 3, **gas.particle)),
        "transfer": (("collisional", "rotational"), share * theory.enskog_viscosity(NONE, 3, **gas.particle)),
        "conductivity": (("heat",), heat * theory.enskog_conductivity(NONE, 3, **gas.particle)),
    }
    ratios: dict[str, list[float]] = {name: [] for name in exact}
    for run in _runs(point):
        for name, (fluxes, value) in exact.items():
            ratios[name] += list(np.sum([green_kubo(run, flux)[:, -1] for flux in fluxes], axis=0) / value)
    return {**_resolution(point), **{name: mean_of(values) for name, values in ratios.items()}}


def _running_diffusion(point: Point) -> np.ndarray:
    """Compute D of each replica (R,) at the longest lag, divided by the Chapman-Enskog value.

    The Chapman-Enskog D holds for a dilute gas. A particle has only N - 1 partners, and therefore keeps its
    velocity longer. In the frame of the centre of mass, the mean square velocity is lower by the same factor.
    At a given density this D is therefore independent of N.
    """
    gas = plain_gas(point.scene)
    dilute = theory.enskog_diffusion(**gas.parameters, contact=1.0)
    return np.array([average_correlations(run.data).running[-1] for run in _runs(point)]) / float(dilute)


def _paths(point: Point, settings: dict) -> dict[str, Any]:
    """Return D of a dilute gas."""
    return {**_resolution(point), "diffusion": mean_of(_running_diffusion(point))}


def _dense(point: Point, settings: dict) -> dict[str, Any]:
    """Measure Z, collision rate and D of the dense-gas model, divided by theory.

    The theory is for the actual number of particles. Model and theory use the contact value of Carnahan and
    Starling.
    """
    gas = plain_gas(point.scene)
    excess, rate = [], []
    for run in _runs(point):
        series, theories = series_of(run), (compressibility_factor(run), collision_rate(run))
        z, own = (expected.value for expected in theories if expected)
        excess.append((series.z.mean() - 1.0) / (z - 1.0))
        rate.append(series.rate.mean() / own)
    return {
        "packing_fraction": gas.packing_fraction,
        "excess": mean_of(excess),
        "rate": mean_of(rate),
        "diffusion": mean_of(_running_diffusion(point) * bulk.contact_value(gas, bulk.ENSKOG)),
    }


def _event_paths(point: Point, settings: dict) -> dict[str, Any]:
    """Return D of the event-driven engine in an infinite container, divided by Enskog theory."""
    row = spheres(point)
    enskog = float(theory.enskog_diffusion(row["packing_fraction"], 3))
    infinite = row["diffusion"] + Estimate(row["correction"], row["correction_uncertainty"])
    return {"packing_fraction": row["packing_fraction"], "diffusion": infinite / enskog}


def _plates(point: Point, settings: dict) -> dict[str, Any]:
    """Measure the flux between plates, divided by the flux of free flight."""
    scene = point.scene
    gap, kind = Gap.of(scene), scene.kinds[0]
    density = scene.count / (gap.length * gap.area)
    filled = theory.packing_fraction(density, 3, 2.0 * kind.radius)
    path = float(theory.mean_free_path(filled, 3, 2.0 * kind.radius, contact=1.0))
    return {
        "knudsen": path / gap.length,
        "packing_fraction": scene.packing_fraction,
        "flux": averages(point, gap, settings["blocks"], 1).flux()
        / float(free_molecular_flux(density, gap.hot, gap.cold, 3)),
    }
