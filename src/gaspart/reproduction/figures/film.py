"""Dense fluid between two hard walls: layers, the contact theorem, and pressure against width.

Lengths are in diameters, energies in k_B T. Slits of several widths are in equilibrium with one bulk fluid.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
import xarray as xr

from gaspart import theory
from gaspart.analysis.estimate import Estimate
from gaspart.analysis.flow import Grid
from gaspart.analysis.run import Run
from gaspart.analysis.series import face_pressures
from gaspart.analysis.statistics import average, correlated_mean, fit_curve, fit_polynomial, mean_of, means_of
from gaspart.keys import POSITIVE, count, list_of, positive
from gaspart.rendering import style
from gaspart.rendering.style import Axes, Figure
from gaspart.reproduction.claims import Claim
from gaspart.reproduction.figure import Parts, runs
from gaspart.reproduction.points.point import Point
from gaspart.reproduction.table import Row, Table, entries, table
from gaspart.scene.facts import plain_gas
from gaspart.state.random import stream

TITLE, CHAPTER = "Thin films", "Equation of state and structure"
SETTINGS = {
    "bulk_packing_fraction": positive(
        "packing fraction of the fluid with which all slits are (nearly) in equilibrium"
    ),
    "insertions": count("number of Widom's trial insertions for each width", minimum=1000),
    "theory_widths": list_of(POSITIVE, "first, last and number of the curve's widths", 3, 3),
}
NEAR = 0.2
"""Thickness of the layer from which the density at contact is extrapolated by a cubic."""
_BINS, _BLOCKS = 20, 16


class Slit:
    """Run between walls across the third axis; heights of centres are above the nearer contact plane."""

    def __init__(self, positions: np.ndarray, sides: np.ndarray, pressure: np.ndarray) -> None:
        self.positions, self.sides, self.pressure = positions, sides, pressure
        self.width, self.area = float(sides[2]), float(sides[0] * sides[1])
        self.heights = np.minimum(positions[..., 2], sides[2] - positions[..., 2]) - 0.5

    @classmethod
    def of(cls, run: Run) -> Slit:
        """Return the slit of a run of spheres; the pressure is that on both walls in each interval."""
        diameter = plain_gas(run.scene).diameter
        pressure = face_pressures(run)[:, 4:6].mean(axis=1) * diameter**3 / run.temperature
        sides = np.array(run.scene.container.lengths) / diameter
        return cls(run.positions[1:] / diameter, sides, pressure)

    def densities(self, grid: Grid) -> np.ndarray:
        """Compute the density (blocks, bins) by height above both walls, in blocks of frames."""
        block = np.arange(len(self.heights)) * _BLOCKS // len(self.heights)
        counts = grid.sums(grid.cells(self.heights[..., None]), blocks=block)
        return counts / (np.bincount(block)[:, None] * 2.0 * self.area * grid.volume)

    def contact(self) -> Estimate:
        """Extrapolate the density to the contact plane; the error is from the scatter of blocks."""
        grid = Grid.line(0.0, NEAR, _BINS)
        fits = [fit_polynomial(grid.middles[0], row, powers=range(4)) for row in self.densities(grid)]
        return mean_of([fit.values[0] for fit in fits])

    def chemical_potential(self, insertions: int, seed: int | tuple[int, ...]) -> Estimate:
        """Estimate ln[(N + 1) / (V p)] by Widom's insertion, V the volume accessible to centres. p is the
        probability that a further sphere fits (Widom, J. Chem. Phys. 39, 2808 (1963)).
        """
        from scipy.spatial import cKDTree

        frames = self.positions[:: max(1, len(self.positions) // 64)]
        per_frame = insertions // len(frames)
        rng, chances = stream(seed, 7), []
        periodic = np.array([self.sides[0], self.sides[1], 0.0])
        for positions in frames:
            inside = positions.copy()
            inside[:, :2] %= periodic[:2]
            trials = rng.random((per_frame, 3)) * (self.sides - [0.0, 0.0, 1.0]) + [0.0, 0.0, 0.5]
            nearest = cKDTree(inside, boxsize=periodic).query(trials, distance_upper_bound=1.0)[0]
            chances.append(np.isinf(nearest).mean())
        chance = mean_of(chances)
        if chance.value == 0.0:
            return Estimate(math.nan, math.inf)
        volume = self.area * (self.width - 1.0)
        potential = math.log((self.positions.shape[1] + 1) / (volume * chance.value))
        return Estimate(potential, chance.error / chance.value, chance.freedom)


def measure(points: list[Point], settings: dict) -> xr.Dataset:
    """Measure pressures of all slits, the profile of the widest, and the same by density functional theory.
    `at_bulk` is the pressure at exactly the chemical potential of the bulk, to first order.
    """
    points = sorted(points, key=lambda point: point.extents[2][2])
    eta = settings["bulk_packing_fraction"]
    bulk, rows = theory.number_density(eta, 3), []
    for point in points:
        slits = [Slit.of(run) for run in runs(point)]
        functional = theory.white_bear_slit(bulk, slits[0].width)
        rows.append(_row(point, slits, settings["insertions"] // len(slits), *functional))
    first, last, number = settings["theory_widths"]
    widths = np.linspace(first, last, int(number))
    curve = [theory.white_bear_slit(bulk, width, 0.02)[1][0] for width in widths]
    dataset = table("width", rows, dict, of=points).merge(
        _profile(slits, *functional), join="outer", compat="no_conflicts"
    )
    dataset = dataset.assign_coords(theory_width=widths).assign(curve=("theory_width", curve))
    return _at_bulk(
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
    near = distance <= NEAR  # the functional's contact value states the error of a cubic
    cubic = fit_polynomial(distance[near], functional[near], powers=range(4)).values[0]
    contact = average([slit.contact() for slit in slits])
    return {
        "width": slits[0].width,
        "count": point.extents[0],
        "pressure": average([correlated_mean(slit.pressure).estimate for slit in slits]),
        "contact": contact,
        "truncation": abs(cubic / functional[0] - 1.0) * contact.value,
        "chemical_potential": average([
            slit.chemical_potential(insertions, point.seed(k)) for k, slit in enumerate(slits)
        ]),
        "functional_pressure": functional[0],
    }  # fmt: skip


def _profile(slits: list[Slit], distance: np.ndarray, functional: np.ndarray) -> xr.Dataset:
    """Compute the density above a wall of the widest slit, and its mean over two diameters in the middle."""
    top = 0.5 * (slits[0].width - 1.0)
    grid = Grid.line(0.0, top, 4 * _BINS * round(slits[0].width / 4.0))
    density = means_of(np.concatenate([slit.densities(grid) for slit in slits]))
    middle = np.concatenate([slit.densities(Grid.line(top - 1.0, top, 1))[:, 0] for slit in slits])
    (place,) = grid.middles
    profile = entries({"density": density})
    profile |= {"place": place, "functional": np.interp(place, distance, functional)}
    columns = {name: ("bin", values) for name, values in profile.items()}
    return xr.Dataset(columns | entries({"middle": mean_of(middle)}))


def _at_bulk(dataset: xr.Dataset) -> xr.Dataset:
    """Correct the pressures to the bulk's chemical potential, and add the periods."""
    slits = Table(dataset, "width")
    # The functional's dP/dmu at fixed width. The bulk's, rho (Gibbs-Duhem), holds for the widest slit only.
    densities = slits.bulk_density * np.array([0.99, 1.01])
    eta = theory.packing_fraction(densities, 3)
    potentials = np.log(densities) + theory.excess_chemical_potential(eta, 3)
    pressures = [[theory.white_bear_slit(rho, w, 0.02)[1][0] for rho in densities] for w in slits.width]
    response = np.diff(pressures, axis=1)[:, 0] / np.diff(potentials)
    pressure = slits.pressure + response * (slits.bulk_chemical_potential - slits.chemical_potential)
    excess = slits.functional_pressure - slits.functional_bulk_pressure
    measured = _period(slits.width, pressure - slits.bulk_pressure)
    functional = _period(slits.width, Estimate(excess, pressure.error))
    return slits.assign(at_bulk=(pressure.value, pressure.error)).dataset.assign_attrs(
        period=measured.value, period_error=measured.error, functional_period=functional.value
    )


def _period(width: np.ndarray, excess: Estimate) -> Estimate:
    """Fit the period of a damped oscillation of the pressure; NaN for fewer than six widths."""
    if len(width) < 6:
        return Estimate(math.nan, math.nan)

    def wave(width: np.ndarray, amplitude: float, decay: float, period: float, phase: float) -> np.ndarray:
        return amplitude * np.exp(-(width - 2.0) / decay) * np.cos(2.0 * np.pi * (width - phase) / period)

    values, covariance = fit_curve(wave, width, excess, (1.5, 1.0, 1.0, 2.0))
    return Estimate(values[2], np.sqrt(covariance[2, 2]))


CONTACT = "contact theorem (exact: momentum balance at a hard wall)"
FUNCTIONAL = "White Bear functional ([Roth 2002]; computed)"


def claims(dataset: xr.Dataset) -> Iterator[Claim]:
    """Yield claims on the contact theorem, on the bulk in the middle, and on the oscillating pressure."""
    slits = Table(dataset, "width")
    widest, ratio = slits[-1], _contact_ratio(slits)
    subject = "density at the wall times k_B T over the pressure on it"
    yield Claim(
        f"{subject}, width {widest.width:g}", ratio[-1], 1.0, 0.01, CONTACT,
        "missed or spurious collisions with walls, or spheres that accumulate at walls",
    )  # fmt: skip
    yield Claim.joint(
        f"{subject}, all widths", (ratio - 1.0).deviation, CONTACT,
        "a bias too small for one width, or error bars that are wrong",
    )  # fmt: skip
    bulk = _of_density(lambda rho, eta: rho * theory.compressibility_factor(eta, 3), widest.middle)
    yield Claim(
        f"pressure on the walls over the bulk's at the density in the middle, width {widest.width:g}",
        (widest.pressure + (bulk - bulk.value)) / bulk.value, 1.0, 0.005,
        "uniform normal pressure (exact) and [Kolafa 2004]",
        "wrong momentum transfer to walls, or layers that reach the middle",
    )  # fmt: skip
    bulk = _of_density(
        lambda rho, eta: math.log(rho) + theory.excess_chemical_potential(eta, 3), widest.middle
    )
    yield Claim(
        "chemical potential by insertion minus the bulk's at the density in the middle, k_B T, "
        f"width {widest.width:g}",
        widest.chemical_potential - bulk, 0.0, 0.1,
        "uniform chemical potential (exact) and [Kolafa 2004]",
        "the slit is not in equilibrium, or too small for its number to fluctuate freely",
    )  # fmt: skip
    if len(slits) < 6:
        return
    yield Claim(
        "period of the solvation pressure in diameters",
        Estimate(slits.period, slits.period_error), slits.functional_period, 0.05,
        f"{FUNCTIONAL}, the same fit to the same widths",
        "no layers, or widths too far apart to resolve them",
    )  # fmt: skip
    narrow = slits[:-1]
    excess = narrow.at_bulk - slits.bulk_pressure
    functional = narrow.functional_pressure - slits.functional_bulk_pressure
    yield Claim.within(
        "solvation pressure over that of the density functional, fitted to all widths but the widest",
        fit_polynomial(functional, excess, powers=(1,)).estimate(0), 1.0, 0.15, FUNCTIONAL,
        "the slits are not in equilibrium with one bulk",
    )  # fmt: skip


def _contact_ratio(slits: Table) -> Estimate:
    """Divide k_B T times the density at the wall by the pressure; the cubic's error counts."""
    return (slits.contact + Estimate(0.0, slits.truncation)) / slits.pressure


def _of_density(function: Callable[..., Any], density: Estimate) -> Estimate:
    """Return a function of density and packing fraction, with the error due to a measured density."""
    step = 1e-4
    here, above = (
        float(function(rho, float(theory.packing_fraction(rho, 3))))
        for rho in (density.value, density.value + step)
    )
    return Estimate(here, (above - here) / step * density.error, density.freedom)


def draw(dataset: xr.Dataset) -> Figure:
    """Draw density above a wall, contact theorem at every width, and pressure against width."""
    figure, (profile, contact, pressure) = style.new((2.8,), (1.3, 2.1))
    slits = Table(dataset, "width")
    _draw_profile(profile, slits[-1])
    # the widest slit is at the end of the axis, with its width in words
    widths = np.append(slits.width[:-1], min(slits.width[-1], slits.theory_width.max() + 0.3))
    style.band(contact, -1.0, 1.0)
    style.level(contact, 0.0)
    style.points(contact, widths, 100.0 * (_contact_ratio(slits) - 1.0), color=style.DATA)
    style.label_axes(contact, y=r"$\rho(0)k_\mathrm{B}T/P-1$  (%)")
    style.level(pressure, 0.0)
    curve, excess = slits.curve - slits.functional_bulk_pressure, slits.at_bulk - slits.bulk_pressure
    pressure.plot(slits.theory_width, curve, color=style.REFERENCE, label="White Bear")
    style.points(pressure, widths, excess, color=style.DATA, label="measured")
    pressure.annotate(
        f"{slits.width[-1]:g}", (widths[-1], excess.value[-1]), (-6, 0),
        textcoords="offset points", ha="right", va="center",
    )  # fmt: skip
    labels = r"width of the slit $H/\sigma$", r"$(P-P_\mathrm{bulk})\sigma^3/k_\mathrm{B}T$"
    style.label_axes(pressure, *labels, legend="upper right")
    style.letters(profile, contact, pressure)
    return figure


def _draw_profile(axis: Axes, widest: Row) -> None:
    axis.plot(widest.place, widest.functional, color=style.REFERENCE, label="White Bear", zorder=4)
    label = rf"measured, $H={widest.width:g}\,\sigma$"
    style.points(axis, widest.place, widest.density, color=style.DATA, markersize=1.8, label=label)
    style.points(axis, 0.0, widest.pressure, kind=1, label=r"$P/k_\mathrm{B}T$ on the wall")
    style.level(axis, widest.bulk_density)
    labels = r"distance of centres from contact $z/\sigma$", r"density $\rho\sigma^3$", "upper right"
    limits = -0.3, min(4.0, widest.place.max())
    style.label_axes(axis, *labels, xlim=limits, ylim=(0.0, None))


FIGURES = {"thin_film": Parts(SETTINGS, measure, claims, draw)}
