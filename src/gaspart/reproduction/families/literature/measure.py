"""Our values of spheres and discs, with values measured by programs of others.

They are in units of the diameter, the mass and k_B T, and of the infinite system where the law of finite
numbers is known to the accuracy of both, else of as many particles in the same container.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
import xarray as xr

from gaspart import theory
from gaspart.analysis.estimate import Estimate
from gaspart.analysis.motion import mask_between
from gaspart.analysis.run import Run
from gaspart.analysis.statistics import combine_estimates, mean_of
from gaspart.analysis.transport import green_kubo
from gaspart.reproduction.families.displacement.measure import spheres
from gaspart.reproduction.families.shared.pressure import pressure
from gaspart.reproduction.points.point import Point
from gaspart.reproduction.table import table
from gaspart.scene.gas import Gas, plain_gas
from gaspart.trajectory.reading import open_trajectory

CONTAINERS = {2: "29 x 30", 3: "cube"}
"""Containers of our points, as `theory.literature` names them."""
SAME = 1e-8
"""Largest difference of two packing fractions that are the same in nine digits."""
STRETCH = 0.3, 1.0
"""Times between which others have taken the slope of Einstein's expressions, the mean of the integrals."""
FLUXES = {"viscosity": "shear", "conductivity": "heat"}


def literature(points: list[Point], settings: dict) -> xr.Dataset:
    """Measure each value that others have measured too.

    The settings are `judged`, experiments whose values have claims of their own; other values are judged by
    their figures. Over `value` are quantity (see `theory.literature`), packing_fraction, count, judged; ours
    and theirs with their errors; source of theirs. Z of both holds for the infinite system, to first order in
    1/N; theirs is the mean of all runs at the packing fraction, weighted by their errors. Of the other
    quantities both hold for `count` particles; D holds for particles whose total momentum is zero, and
    viscosity and conductivity are means of the integral over `STRETCH`.
    """
    values = [(point, row) for point in points for row in _values(point)]
    rows = [row | {"judged": int(point.experiment in settings["judged"])} for point, row in values]
    return table("value", rows, dict, units={}, of=[point for point, _ in values])


def _values(point: Point) -> Iterator[dict[str, Any]]:
    """Yield the values of a point that others have measured, if any."""
    gas = plain_gas(point.scene)
    if gas.dimension == 3 and not {"displacements", "stress"} & set(point.settings):
        yield from _of_infinite_system(point, gas)
        return
    for quantity, ours in _of_as_many(point, gas).items():
        published = _literature_values(gas, quantity)
        for row in published[published.count == gas.count]:
            yield _row(gas, quantity, ours, Estimate(float(row.value), float(row.error)), str(row.source))


def _row(gas: Gas, quantity: str, ours: Estimate, theirs: Estimate, source: str) -> dict[str, Any]:
    return {
        "quantity": quantity,
        "dimension": gas.dimension,
        "packing_fraction": gas.packing_fraction,
        "count": gas.count,
        "ours": ours,
        "theirs": theirs,
        "source": source,
    }


def _literature_values(gas: Gas, quantity: str) -> np.recarray:
    """Return the values of others at this packing fraction in such a container."""
    rows = theory.literature(quantity, gas.dimension)
    same = np.abs(rows.packing_fraction - gas.packing_fraction) < SAME
    return rows[same & (rows.container == CONTAINERS[gas.dimension])]


def _of_infinite_system(point: Point, gas: Gas) -> Iterator[dict[str, Any]]:
    """Yield Z of a fluid or a crystal of spheres.

    Our Z is canonical (see `analysis.series.compressibility`), the other Z is at a fixed energy and momentum,
    by which a crystal is not shifted to first order; the next order in V / V_c - 1 of ours is not known, and
    part of its error.
    """
    eta = gas.packing_fraction
    fluid = eta <= theory.HIGHEST_PACKING_FRACTION[3]
    quantity = "Z" if fluid else "Z_crystal"
    published = _literature_values(gas, quantity)
    if not len(published):
        return
    z = pressure(point).z
    if fluid:
        shift = Estimate(float(theory.finite_size_correction(eta, 3, gas.count, ensemble="canonical")))
        shifts = np.array([theory.finite_size_correction(eta, 3, int(count)) for count in published["count"]])
    else:
        first = float(theory.crystal_finite_size_correction(z.value, gas.count))
        shift = Estimate(first, abs(first) * (theory.CLOSE_PACKING[3] / eta - 1.0))
        shifts = np.zeros(len(published))
    theirs = combine_estimates(Estimate(published.value - shifts, published.error))
    yield _row(gas, quantity, z - shift, theirs, str(published.source[0]))


def _of_as_many(point: Point, gas: Gas) -> dict[str, Estimate]:
    """Compute the quantities of a point of finite numbers, by name."""
    if gas.dimension == 2:
        return {"pressure": gas.packing_fraction * 4.0 / np.pi * pressure(point).z}
    if point.settings.get("stress"):
        return {quantity: _coefficient(point, flux) for quantity, flux in FLUXES.items()}
    return {"diffusion": (1.0 - 1.0 / gas.count) * spheres(point)["diffusion"]}


def _coefficient(point: Point, flux: str) -> Estimate:
    """Measure a transport coefficient by the mean of Green and Kubo's integral in `STRETCH`."""
    samples: list[float] = []
    for path in point.replica_paths:
        with open_trajectory(path) as trajectory:
            run = Run(point.scene, trajectory["time"].values, trajectory)
            lags = trajectory["lag"].values
            inside = mask_between(lags + 0.5 * (lags[1] - lags[0]), *STRETCH)
            samples += list(green_kubo(run, flux)[:, inside].mean(axis=1))
    return mean_of(samples)
