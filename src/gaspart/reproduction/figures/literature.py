"""Our values for spheres and discs beside those that others have published.

Units are the diameter, the mass and k_B T. Values are for the infinite system if the effect of finite size is
known accurately enough; otherwise both are for the same particle number in the same container.
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
from gaspart.keys import names
from gaspart.rendering import style
from gaspart.rendering.style import Axes, Figure
from gaspart.reproduction.claims import Claim
from gaspart.reproduction.figure import PARTICLES, Parts, pressure
from gaspart.reproduction.figures.msd_spheres import spheres
from gaspart.reproduction.points.point import Point
from gaspart.reproduction.table import Table, table
from gaspart.scene.facts import Gas, plain_gas
from gaspart.trajectory.reading import open_trajectory

TITLE, CHAPTER = "Equation of state", "Equation of state and structure"
SETTINGS = {"judged": names("experiments whose values have claims of their own, not only together")}
CONTAINERS = {2: "29 x 30", 3: "cube"}  # of our points, by their names in `theory.literature`
# Times between which the published slopes of Einstein's expressions were measured; here, the mean of the
# integrals.
STRETCH = 0.3, 1.0


def measure(points: list[Point], settings: dict) -> xr.Dataset:
    """Measure each quantity for which there are published values, `theirs`. Claims on values that are not
    `judged` belong to other figures.
    """
    values = [(point, row) for point in points for row in _values(point)]
    rows = [row | {"judged": int(point.experiment in settings["judged"])} for point, row in values]
    return table("value", rows, dict, units={}, of=[point for point, _ in values])


def _values(point: Point) -> Iterator[dict[str, Any]]:
    gas = plain_gas(point.scene)
    if gas.dimension == 3 and not {"displacements", "stress"} & set(point.settings):
        yield from _of_infinite_system(point, gas)
        return
    for quantity, ours in _of_as_many(point, gas).items():
        published = _published(gas, quantity)
        for row in published[published.count == gas.count]:
            theirs = Estimate(float(row.value), float(row.error))
            yield _row(gas, quantity, ours, theirs, str(row.source))


def _row(gas: Gas, quantity: str, ours: Estimate, theirs: Estimate, source: str) -> dict[str, Any]:
    row = {name: getattr(gas, name) for name in ("dimension", "packing_fraction", "count")}
    return row | {"quantity": quantity, "ours": ours, "theirs": theirs, "source": source}


def _published(gas: Gas, quantity: str) -> np.recarray:
    """Return the published values at this packing fraction, to nine digits, in such a container."""
    rows = theory.literature(quantity, gas.dimension)
    same = np.abs(rows.packing_fraction - gas.packing_fraction) < 1e-8
    return rows[same & (rows.container == CONTAINERS[gas.dimension])]


def _of_infinite_system(point: Point, gas: Gas) -> Iterator[dict[str, Any]]:
    """Yield Z of a fluid or a crystal of spheres beside the mean of all published runs. Our Z is canonical
    (see `analysis.series.compressibility`). The published Z is for fixed energy and momentum, which does not
    shift Z of a crystal to first order. The next order of our Z in V / V_c - 1 is unknown, and is part of its
    error.
    """
    eta = gas.packing_fraction
    fluid = eta <= theory.HIGHEST_PACKING_FRACTION[3]
    quantity = "Z" if fluid else "Z_crystal"
    published = _published(gas, quantity)
    if not len(published):
        return
    z, shifts = pressure(point).z, np.zeros(len(published))
    if fluid:
        shift = Estimate(float(theory.finite_size_correction(eta, 3, gas.count, ensemble="canonical")))
        shifts = np.array([theory.finite_size_correction(eta, 3, int(count)) for count in published["count"]])
    else:
        first = float(theory.crystal_finite_size_correction(z.value, gas.count))
        shift = Estimate(first, abs(first) * (theory.CLOSE_PACKING[3] / eta - 1.0))
    theirs = combine_estimates(Estimate(published.value - shifts, published.error))
    yield _row(gas, quantity, z - shift, theirs, str(published.source[0]))


def _of_as_many(point: Point, gas: Gas) -> dict[str, Estimate]:
    """Compute the quantities of a point for its number of particles; D at zero total momentum."""
    if gas.dimension == 2:
        return {"pressure": gas.packing_fraction * 4.0 / np.pi * pressure(point).z}
    if point.settings.get("stress"):
        return {"viscosity": _coefficient(point, "shear"), "conductivity": _coefficient(point, "heat")}
    return {"diffusion": (1.0 - 1.0 / gas.count) * spheres(point)["diffusion"]}


def _coefficient(point: Point, flux: str) -> Estimate:
    """Measure a transport coefficient by the mean of the Green-Kubo integral in `STRETCH`."""
    samples: list[float] = []
    for path in point.replica_paths:
        with open_trajectory(path) as trajectory:
            run = Run(point.scene, trajectory["time"].values, trajectory)
            lags = trajectory["lag"].values
            inside = mask_between(lags + 0.5 * (lags[1] - lags[0]), *STRETCH)
            samples += list(green_kubo(run, flux)[:, inside].mean(axis=1))
    return mean_of(samples)


# By quantity: text of the claim, label, and largest relative uncertainty of ours for a conclusive claim. The
# published values have uncertainties of up to 1e-5, 0.2 %, and 3 to 11 %.
STATIC = {
    "Z": ("Z of the fluid of", "$Z$, fluid of spheres", 1e-3),
    "Z_crystal": ("Z of the face-centred cubic crystal of", "$Z$, crystal of spheres", 1e-3),
    "pressure": ("pressure of", "$P$, 870 discs", np.nan),  # claimed together alone
}
TRANSPORT = {
    "diffusion": ("diffusion coefficient of", "$D$ of spheres", 0.015),
    "viscosity": ("viscosity of", "viscosity of spheres", 0.1),
    "conductivity": ("conductivity of", "heat conductivity of spheres", 0.1),
}
QUANTITIES = STATIC | TRANSPORT
SOURCES = {  # that are not keys of references
    "Chudak": "runs by the program DynamO of an author of [Pieprzyk 2019]",
    "DynamO test": "[Bannerman 2011], expected by a test of its authors' program",
    "DynamO tutorial": "[Bannerman 2011], a run of its authors' tutorial",
}


def claims(dataset: xr.Dataset) -> Iterator[Claim]:
    """Yield the claims that our values agree with published values, singly and all together."""
    values = Table(dataset, "value")
    for row in values[values.judged == 1]:
        name, _, required = QUANTITIES[row.quantity]
        yield Claim(
            f"{name} {PARTICLES[row.dimension]} at packing fraction {row.packing_fraction:.4g}, "
            f"{row.count} particles, by {row.source}",
            row.ours, row.theirs, required * row.theirs.value, _cite(row.source),
            "contacts are missed, correlations cut too early, or finite numbers act otherwise",
            allowance_source="their statement",
        )  # fmt: skip
    for part, name in zip(_parts(values), ("Z and pressures", "transport coefficients"), strict=True):
        if part:
            yield Claim.joint(
                f"{name} beside those of others", (part.ours - part.theirs).deviation,
                f"programs of others: {', '.join(map(_cite, dict.fromkeys(part.source)))}",
                "a bias too small for one value is common to many, or error bars are wrong",
            )  # fmt: skip


def _cite(source: str) -> str:
    return SOURCES.get(source, f"[{source}]")


def _parts(values: Table) -> tuple[Table, Table]:
    """Return the values in equilibrium, and transport coefficients."""
    is_static = np.isin(values.quantity, list(STATIC))
    return values[is_static], values[~is_static]


def draw(dataset: xr.Dataset) -> Figure:
    """Draw ratios to published values minus 1, whose errors are wide pale bars."""
    figure, panels = style.new((2.4,), (2.4,))
    for axis, values in zip(panels, _parts(Table(dataset, "value")), strict=True):
        _ratios(axis, values)
    style.letters(*panels)
    return figure


def _ratios(axis: Axes, values: Table) -> None:
    style.level(axis, 0.0)
    pale: dict[str, Any] = {"linestyle": "none", "elinewidth": 4.0, "capsize": 0.0, "alpha": 0.35}
    for kind, (name, (_, label, _)) in enumerate(QUANTITIES.items()):
        part = values[values.quantity == name]
        if not part:
            continue
        eta, theirs = part.packing_fraction, part.theirs.value
        error = 100.0 * part.theirs.error / theirs
        axis.errorbar(eta, 0.0 * eta, error, color=style.COLOURS[kind], **pale)
        style.points(axis, eta, 100.0 * (part.ours / theirs - 1.0), kind=kind, label=label)
    style.label_axes(axis, r"packing fraction $\eta$", "ours / published $-1$  (%)", legend="best")


FIGURES = {"literature": Parts(SETTINGS, measure, claims, draw)}
