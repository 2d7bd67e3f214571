"""Dense fluid between two hard walls: layers, the contact theorem, and pressure against width."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
import xarray as xr

from gaspart import theory
from gaspart.analysis.estimate import Estimate
from gaspart.analysis.flow import Grid
from gaspart.analysis.run import Run
from gaspart.analysis.series import face_pressures
from gaspart.analysis.statistics import average, correlated_mean, fit_curve, fit_polynomial, mean_of, means_of
from gaspart.reproduction.families.shared.runs import runs
from gaspart.reproduction.points.point import Point
from gaspart.reproduction.table import Table, entries, table
from gaspart.scene.gas import plain_gas
from gaspart.state.random import stream

NEAR = 0.2
"""Thickness of the layer, in diameters, from which the density at contact is extrapolated by a cubic."""
_BINS, _BLOCKS = 20, 16


@dataclass(frozen=True)
class Slit:
    """Run between walls at z = 0 and H, in units of diameter and k_B T.

    pressure : (samples,), from the momentum transferred to both walls in each interval.
    heights : (samples, N), heights of centres above the contact plane of the nearer wall.
    width : distance H between the walls.
    area : area of one wall.
    positions, sides : positions (samples, N, 3), and lengths (3,) of the container.
    """

    pressure: np.ndarray
    heights: np.ndarray
    width: float
    area: float
    positions: np.ndarray
    sides: np.ndarray


def thin_film(points: list[Point], settings: dict) -> xr.Dataset:
    """Measure profiles and pressures of slits of several widths at one chemical potential.

    The numbers of spheres are chosen for equal chemical potentials. The settings are:

    bulk_packing_fraction : packing fraction of the bulk fluid that is (nearly) in equilibrium with all slits
    insertions : number of Widom's trial insertions for each width
    theory_widths : [first, last, number] of the widths of the theoretical curve

    Variables over `width`, the distance between the surfaces of the walls in diameters:

    pressure, contact : pressure, and density rho(0) at contact (k_B T = 1); both have _error
    truncation : error of the cubic, for the contact value of the density functional
    chemical_potential : chemical potential with _error
    at_bulk : pressure at exactly the chemical potential of the bulk, to first order, with _error
    functional_pressure : pressure by the density functional
    count : number of spheres

    The dimension `bin` is for the widest slit. Its variables are the place, the density with density_error,
    and `functional`, the density by the density functional. The variable `middle` is the density of the
    widest slit, averaged over two diameters around its middle, with _error. Over `theory_width` is the
    theoretical curve. Attributes are bulk_density, bulk_pressure, bulk_chemical_potential, and the period and
    period_error of the damped oscillation.
    """
    points = sorted(points, key=lambda point: point.extents[2][2])
    eta = settings["bulk_packing_fraction"]
    bulk, rows = theory.number_density(eta, 3), []
    for point in points:
        slits = [slit_of(run) for run in runs(point)]
        functional = theory.white_bear_slit(bulk, slits[0].width)
        rows.append(_row(point, slits, settings["insertions"] // len(slits), *functional))
    first, last, number = settings["theory_widths"]
    widths = np.linspace(first, last, int(number))
    curve = [theory.white_bear_slit(bulk, width, 0.02)[1][0] for width in widths]
    dataset = table("width", rows, dict, of=points).merge(
        _profile(slits, *functional), join="outer", compat="no_conflicts"
    )
    dataset = dataset.assign_coords(theory_width=widths).assign(curve=("theory_width", curve))
    return _at_the_bulks_potential(
        dataset.assign_attrs(
            bulk_density=bulk,
            bulk_pressure=bulk * float(theory.compressibility_factor(eta, 3)),
            bulk_chemical_potential=math.log(bulk) + float(theory.excess_chemical_potential(eta, 3)),
            functional_bulk_pressure=theory.white_bear_pressure(bulk),
        )
    )


def _row(
    point: Point, slits: list[Slit], insertions: int, distance: np.ndarray, functional: np.ndarray
) -> dict[str, Any]:
    """Return pressure, contact density and chemical potential, averaged over replicas.

    `functional` (B,) is the density by the functional at `distance`.
    """
    contact = average([_contact(slit) for slit in slits])
    potentials = [_widom(slit, insertions, point.seed(k)) for k, slit in enumerate(slits)]
    return {
        "width": slits[0].width,
        "count": point.extents[0],
        "pressure": average([correlated_mean(slit.pressure).estimate for slit in slits]),
        "contact": contact,
        "truncation": _truncation(distance, functional) * contact.value,
        "chemical_potential": average(potentials),
        "functional_pressure": functional[0],
    }


def _at_the_bulks_potential(dataset: xr.Dataset) -> xr.Dataset:
    """Correct the pressures to the bulk's chemical potential, and add the periods.

    The chemical potentials of the slits differ slightly from the bulk's.
    """
    slits = Table(dataset, "width")
    response = _responses(slits.bulk_density, slits.width)
    pressure = slits.pressure + response * (slits.bulk_chemical_potential - slits.chemical_potential)
    excess = slits.functional_pressure - slits.functional_bulk_pressure
    measured = _period(slits.width, pressure - slits.bulk_pressure)
    functional = _period(slits.width, Estimate(excess, pressure.error))
    return slits.assign(at_bulk=(pressure.value, pressure.error)).dataset.assign_attrs(
        period=measured.value, period_error=measured.error, functional_period=functional.value
    )


def _responses(bulk: float, widths: np.ndarray) -> np.ndarray:
    """Compute dP/dmu of slits of fixed widths, by the density functional.

    The bulk value rho (Gibbs-Duhem) holds for the widest slit only.
    """
    densities = bulk * np.array([0.99, 1.01])
    eta = theory.packing_fraction(densities, 3)
    potentials = np.log(densities) + theory.excess_chemical_potential(eta, 3)
    pressures = [[theory.white_bear_slit(rho, w, 0.02)[1][0] for rho in densities] for w in widths]
    return np.diff(pressures, axis=1)[:, 0] / np.diff(potentials)


def _truncation(distance: np.ndarray, density: np.ndarray) -> float:
    """Compute the relative error of extrapolating a profile (B,) by a cubic.

    The profile is computed by the density functional.
    """
    near = distance <= NEAR
    cubic = fit_polynomial(distance[near], density[near], powers=range(4)).values[0]
    return abs(cubic / density[0] - 1.0)


def slit_of(run: Run) -> Slit:
    """Return the slit of a run of spheres between walls across the third axis.

    Raises SceneError for any other scene.
    """
    diameter = plain_gas(run.scene).diameter
    positions, sides = run.positions[1:] / diameter, np.array(run.scene.container.lengths) / diameter
    pressure = face_pressures(run)[:, 4:6].mean(axis=1) * diameter**3 / run.temperature
    height = np.minimum(positions[..., 2], sides[2] - positions[..., 2]) - 0.5
    return Slit(pressure, height, float(sides[2]), float(sides[0] * sides[1]), positions, sides)


def _densities(slit: Slit, grid: Grid) -> np.ndarray:
    """Compute the density (blocks, bins) by height above both walls, in blocks of frames."""
    block = np.arange(len(slit.heights)) * _BLOCKS // len(slit.heights)
    counts = grid.sums(grid.cells(slit.heights[..., None]), blocks=block)
    return counts / (np.bincount(block)[:, None] * 2.0 * slit.area * grid.volume)


def _contact(slit: Slit) -> Estimate:
    """Compute the density extrapolated to the contact plane, with its error.

    The error is computed from the scatter of blocks of frames.
    """
    grid = Grid.line(0.0, NEAR, _BINS)
    (middles,) = grid.middles
    fits = [fit_polynomial(middles, counts, powers=range(4)) for counts in _densities(slit, grid)]
    return mean_of([fit.values[0] for fit in fits])


def _widom(slit: Slit, insertions: int, seed: int | tuple[int, ...]) -> Estimate:
    """Estimate mu / k_B T = ln[(N + 1) / (V p)] by Widom's insertion.

    p is the probability that a further sphere fits (Widom, J. Chem. Phys. 39, 2808 (1963)). V is the volume
    accessible to centres. Lengths are in diameters. The thermal wavelength is left out.
    """
    from scipy.spatial import cKDTree

    frames = slit.positions[:: max(1, len(slit.positions) // 64)]
    per_frame = insertions // len(frames)
    rng, chances = stream(seed, 7), []
    periodic = np.array([slit.sides[0], slit.sides[1], 0.0])
    for positions in frames:
        inside = positions.copy()
        inside[:, :2] %= periodic[:2]
        trials = rng.random((per_frame, 3)) * (slit.sides - [0.0, 0.0, 1.0]) + [0.0, 0.0, 0.5]
        nearest = cKDTree(inside, boxsize=periodic).query(trials, distance_upper_bound=1.0)[0]
        chances.append(np.isinf(nearest).mean())
    chance = mean_of(chances)
    volume = slit.area * (slit.width - 1.0)
    if chance.value == 0.0:
        return Estimate(math.nan, math.inf)
    potential = math.log((slit.positions.shape[1] + 1) / (volume * chance.value))
    return Estimate(potential, chance.error / chance.value, chance.freedom)


def _profile(slits: list[Slit], distance: np.ndarray, functional: np.ndarray) -> xr.Dataset:
    """Compute the density above the nearer wall of the widest slit, up to its middle.

    The mean density around the middle is returned too, as a number.
    """
    top = 0.5 * (slits[0].width - 1.0)
    grid = Grid.line(0.0, top, 4 * _BINS * round(slits[0].width / 4.0))
    density = means_of(np.concatenate([_densities(slit, grid) for slit in slits]))
    inner = Grid.line(top - 1.0, top, 1)
    middle = np.concatenate([_densities(slit, inner)[:, 0] for slit in slits])
    (centre,) = grid.middles
    functional = np.interp(centre, distance, functional)
    profile = entries({"density": density}) | {"place": centre, "functional": functional}
    profile = {name: ("bin", values) for name, values in profile.items()}
    return xr.Dataset(profile | entries({"middle": mean_of(middle)}))


def _period(width: np.ndarray, excess: Estimate) -> Estimate:
    """Fit the period of a damped oscillation of the pressure against the width.

    `excess` is the pressure minus the bulk pressure. The result is NaN for fewer than six widths.
    """
    if len(width) < 6:
        return Estimate(math.nan, math.nan)

    def wave(width: np.ndarray, amplitude: float, decay: float, period: float, phase: float) -> np.ndarray:
        return amplitude * np.exp(-(width - 2.0) / decay) * np.cos(2.0 * np.pi * (width - phase) / period)

    start = (1.5, 1.0, 1.0, 2.0)
    values, covariance = fit_curve(wave, width, excess, start)
    return Estimate(values[2], np.sqrt(covariance[2, 2]))
