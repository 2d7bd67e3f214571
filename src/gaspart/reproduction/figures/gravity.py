"""Columns of discs of one size under gravity: profiles of one and of two kinds, and the source's own runs."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import xarray as xr

from gaspart.analysis.estimate import Estimate
from gaspart.analysis.flow import Grid
from gaspart.keys import POSITIVE, list_of, positive
from gaspart.rendering import style
from gaspart.rendering.style import Axes, Figure
from gaspart.reproduction.claims import Claim
from gaspart.reproduction.figure import Parts
from gaspart.reproduction.figures._columns import column_settings, field, measure_columns, stretches
from gaspart.reproduction.points.point import Point
from gaspart.reproduction.table import Row, Table
from gaspart.theory.gravity import ideal_profile
from gaspart.theory.state import compressibility_factor
from gaspart.trajectory.reading import open_trajectory

TITLE, CHAPTER = "Under gravity", "Gravity, heat and walls"
ONE_KIND = column_settings(
    source="source C's own run", later="its scene, after a longer time, without side walls"
) | {"source_temperature": positive("that source C fits to the speeds of its sample")}
TWO_KINDS = column_settings(source="source C's own run") | {
    "source_shares": list_of(
        POSITIVE, "of the light discs in source C's sample, in equal layers from the floor up"
    )
}
_FALL = 0.3  # fraction of the time before the sample in which the oscillation is not yet harmonic


def measure_one_kind(points: list[Point], settings: dict) -> xr.Dataset:
    """Measure density, temperature and pressure against height for one kind of discs."""
    dataset = measure_columns(points, settings, ringing)
    return dataset.assign_attrs(source_temperature=settings["source_temperature"])


def measure_two_kinds(points: list[Point], settings: dict) -> xr.Dataset:
    """Measure profiles of heavy and light discs, and the slope of their ratio."""
    shares = settings["source_shares"]
    dataset = measure_columns(points, settings, lambda point: layer_fractions(point, len(shares)))
    return dataset.assign_attrs(source_shares=shares)


def ringing(point: Point) -> dict[str, Estimate]:
    """Fit the relative amplitude of the kinetic energy's oscillation at the start of the sample, t = 0. The
    fit is mean + e^{-t / decay} (a cos w t + b sin w t) to all frames after the fall; the error follows from
    their scatter.
    """
    from scipy.optimize import curve_fit

    begin = point.schedule.equilibration
    with open_trajectory(point.replica_path(0)) as trajectory:
        time, kinetic = trajectory["time"].values, trajectory["kinetic_energy"].values
    late = time > _FALL * begin
    time, kinetic = time[late] - begin, kinetic[late] / kinetic[late].mean()

    def model(t: np.ndarray, mean: float, a: float, b: float, w: float, decay: float) -> np.ndarray:
        return mean + np.exp(-t / decay) * (a * np.cos(w * t) + b * np.sin(w * t))

    frequencies = np.linspace(2.0, 30.0, 600) * np.pi / np.ptp(time)
    power = np.abs(np.exp(1j * np.outer(frequencies, time)) @ (kinetic - 1.0))
    start = (1.0, 0.01, 0.01, frequencies[power.argmax()], 0.5 * begin)
    (_, a, b, _, _), covariance = curve_fit(model, time, kinetic, start, sigma=None, absolute_sigma=False)
    amplitude = float(np.hypot(a, b))
    direction = np.array([a, b]) / amplitude
    error = np.sqrt(direction @ covariance[1:3, 1:3] @ direction)
    return {"ringing": Estimate(amplitude, error, len(time) - len(start))}


def layer_fractions(point: Point, layers: int) -> dict[str, tuple[np.ndarray, np.ndarray]]:
    """Compute the fraction of the first species in equal layers of the container, (layers,). The error is the
    binomial error of a single frame. Frames of one sample are close in time, so that the composition of a
    layer is nearly the same in all. The source has one frame.
    """
    column, [sample] = field(point), stretches(point, 1)
    grid = Grid.line(-0.5 * column.diameter, column.height + 0.5 * column.diameter, layers)
    cells = grid.cells(sample.heights[..., None])
    first, second = (grid.sums(cells[:, column.species == kind]) / len(cells) for kind in (0, 1))
    share = first / (first + second)
    return {"share": (share, np.sqrt(share * (1.0 - share) / (first + second)))}


EXCHANGE = "exchange of two discs of one size costs (M - m) g dz (exact at any density)"
C = "notebooks of [source C]'s code (tms-ninja/billiards)"
IDEAL = 0.01
"""Largest packing fraction of a column that counts as an ideal gas."""


def claim_one_kind(dataset: xr.Dataset) -> Iterator[Claim]:
    """Yield claims on the barometric formula, equation of state by weight, and uniform temperature."""
    for row in Table(dataset, "point"):
        at = _at(row)
        if row.column == "source":
            yield from _claim_source_column(row)
            yield _balance(row, at)
            continue
        if row.column == "later":
            # Heat crosses the column in about the duration of a block: only local quantities are independent
            # in each block.
            yield _balance(row, at)
            yield from _pressures(row, at)
            continue
        discs = Table(row.dataset, "species")[0]
        yield _slope(discs, "discs", at, 0.005 if _is_dilute(row) else 0.01)
        yield Claim(
            f"temperature against height, d ln T / dz over -1/(scale height), {at}",
            -row.temperature_gradient, 0.5 / row.count, 0.005,
            "an isothermal column ([Maxwell 1867]); at fixed energy 1/C_V more, 2Nk in a high one",
            "a column that is warmer at one end: not in equilibrium, or an engine that heats",
        )  # fmt: skip
        yield _balance(row, at)
        yield from [_mean_height(discs, "discs", at)] if _is_dilute(row) else _pressures(row, at)


def _claim_source_column(row: Row) -> Iterator[Claim]:
    """Yield claims on source C's column at the time of its sample, not yet in equilibrium."""
    yield _collisions_of_source(row)
    yield Claim.within(
        "temperature of the source's column over the source's, in its sample",
        row.temperature / row.source_temperature, 1.0, 0.02,
        f"{C}, gravity: {row.source_temperature:g}, fitted to ten bins of speeds, of a "
        "sample that is shorter than a period of the oscillation",
        "a column that falls, bounces or heats up otherwise", kind="reproduction",
    )  # fmt: skip
    yield Claim.at_most(
        "amplitude of the oscillation of the temperature in the source's sample, in per cent",
        row.ringing * 100.0, 1.0, 0.3,
        f"{C}, gravity: takes the column to be in equilibrium after its collisions",
        "a column that still rings more than the accuracy of the other claims", "reproduction",
        source_error="the oscillation after the fall decays as slowly as sound does over 200 diameters",
    )  # fmt: skip


def claim_two_kinds(dataset: xr.Dataset) -> Iterator[Claim]:
    """Yield claims on scale heights of the species of a dilute gas, and on the ratio of their densities."""
    for row in Table(dataset, "point"):
        at = _at(row)
        yield Claim(
            f"temperature of the heavy over that of the light discs, {at}",
            row.species_temperature_ratio[-1], 1.0, 0.01,
            "equipartition", "species that do not share their energy",
        )  # fmt: skip
        yield _balance(row, at)
        if row.column == "source":
            yield from _claim_source_mixture(row)
            continue
        yield Claim(
            f"slope of ln(heavy/light) over -(M - m) g / kT, {at}",
            row.exchange_ratio, 1.0, 0.01 if _is_dilute(row) else 0.02, EXCHANGE,
            "species that do not separate according to their weights, or runs too short for it",
        )  # fmt: skip
        if not _is_dilute(row):
            yield from _pressures(row, at)
            continue
        species = list(zip(Table(row.dataset, "species"), ("light", "heavy"), strict=True))
        yield from (_slope(kind, name, at, 0.005) for kind, name in species)
        yield from (_mean_height(kind, name, at) for kind, name in species)


def _claim_source_mixture(row: Row) -> Iterator[Claim]:
    """Yield claims on source C's mixture at the end of its run, not yet in equilibrium."""
    yield _collisions_of_source(row)
    yield Claim.joint(
        "share of light discs in ten layers, over the source's",
        (row.share - Estimate(row.source_shares, row.share.error)).deviation,
        f"{C}, separation, last picture: as many discs in a layer, so the error is as large",
        "discs that diffuse through each other, or fall, faster or more slowly", kind="reproduction",
    )  # fmt: skip
    yield Claim.at_most(
        "slope of ln(heavy/light) over -(M - m) g / kT, the source's mixture at the end of its run",
        row.exchange_ratio, 0.9, 0.05,
        f"{EXCHANGE}; {C}, separation, does not state that its run has arrived there",
        "a mixture that separates within the source's collisions", "reproduction",
    )  # fmt: skip


def _collisions_of_source(row: Row) -> Claim:
    """Return the claim on the number of collisions, of a single run, until the source's ends."""
    reported, count = row.source_collisions, row.collisions
    return Claim.within(
        f"collisions until the source's {reported:.1e}, over them",
        Estimate(count, np.sqrt(count)) / reported, 1.0, 0.01,
        f"{C}: the time at which its run ends; walls count, and its grid is square",
        "an engine that misses contacts or makes up others, or another scene than the source's",
        kind="reproduction",
    )  # fmt: skip


def _is_dilute(row: Row) -> bool:
    return bool(row.packing_fraction.value.max() < IDEAL)


def _at(row: Row) -> str:
    density = "dilute" if _is_dilute(row) else "dense"
    whose = "the source's " if row.column == "source" else ""
    return f"{whose}{density} column of {row.count:g} discs"


def _slope(species: Row, name: str, at: str, required: float) -> Claim:
    return Claim(
        f"slope of the chemical potential of the {name} over -m g / kT, {at}",
        species.slope_ratio, 1.0, required,
        "ln rho + mu_excess(rho) + m g z / kT is uniform in equilibrium; in a dilute gas ln rho alone",
        "a density that does not decay exponentially with its own scale height",
    )  # fmt: skip


def _mean_height(species: Row, name: str, at: str) -> Claim:
    return Claim(
        f"mean height of the {name} over the ideal gas's, {at}",
        species.mean_height_ratio, 1.0 + species.packing_fraction.value.max(), 0.01,
        "<z> = kT/mg - H/(exp(mgH/kT) - 1); B2 raises it by the packing fraction at the floor (first "
        "order, high column)",
        "a gas that does not fill its container according to Boltzmann's factor",
    )  # fmt: skip


def _pressures(row: Row, at: str) -> Iterator[Claim]:
    for part in Table(row.dataset, "range"):
        if np.isfinite(part.range_ratio.value):
            yield Claim(
                "pressure that carries the weight above over rho kT Z(eta), "
                f"eta from {part.range_low:g} to {part.range_high:g}, {at}",
                part.range_ratio, 1.0, 0.01,
                "hydrostatics dP/dz = -m g rho, Z of the virial series to B10 with a linear tail "
                "([Clisby 2006])",
                "a density profile that is not the equation of state's",
            )  # fmt: skip


def _balance(row: Row, at: str) -> Claim:
    return Claim.at_most(
        f"(floor - ceiling - weight - gain of momentum) over the weight, {at}",
        Estimate(row.imbalance, 1e-9), 1e-8, 1e-8, "balance of momentum (exact)",
        "impulses on floor and ceiling that are not those of the particles", "identity",
    )  # fmt: skip


KNOWN = 0.1
"""Largest relative error of a bin of height that is drawn; other bins contain hardly any particles."""


def draw_one_kind(dataset: xr.Dataset) -> Figure:
    """Draw density and temperature against height, equation of state by weight, and the source's column."""
    of_source = _columns_named(dataset, "later", "source")
    figure, axes = style.new((2.4, 1.1, 1.1), (1.7, 1.0), *([(1.5, 1.1)] if of_source else []))
    top, ratio, warm, state, off = axes[:5]
    for kind, row in enumerate(_columns_named(dataset, "dilute", "dense")):
        expected = _expected_density(row, 0)
        _draw_density(top, row, kind, f"{row.column}, {'hydrostatics' if kind else 'ideal gas'}", row.column)
        density = row.density[0]
        seen = _enough_particles(density) & row.used
        _draw_percent(ratio, row.height[seen], (density / expected)[seen], kind)
        _draw_temperature(warm, row, kind)
    [dense] = _columns_named(dataset, "dense")
    eta = dense.packing_fraction.value[dense.used]
    line = np.linspace(0.0, 1.05 * eta.max(), 200)
    state.plot(line, compressibility_factor(line, 2), color=style.DATA, label="virial series to $B_{10}$")
    label = "weight above / $\\rho kT$"
    style.points(state, eta, dense.compressibility[dense.used], kind=1, hollow=True, label=label)
    _draw_percent(off, eta, dense.pressure_ratio[dense.used], 1)
    top.set_yscale("log")
    style.label_axes(top, y=r"density $\rho/\bar\rho$", ylim=(0.04, 12.0))
    top.legend(loc="upper right", ncol=2, columnspacing=0.8)
    style.label_axes(ratio, y=r"$\rho/\rho_\mathrm{th} - 1$ (%)")
    style.label_axes(warm, "height $z$ (length)", r"$T(z)/T - 1$ (%)")
    style.label_axes(state, y=r"$Z = P/\rho kT$", legend="upper left")
    style.label_axes(off, r"packing fraction $\eta$", r"$Z/Z_\mathrm{ref} - 1$ (%)")
    if of_source:
        _draw_source_columns(axes[5], axes[6], of_source)
    style.letters(top, ratio, warm, state, *axes[5:6])
    return figure


def _draw_source_columns(top: Axes, bottom: Axes, columns: list[Row]) -> None:
    for kind, row in enumerate(columns, start=2):
        name = {"later": "later", "source": "source's sample"}[row.column]
        _draw_density(top, row, kind, None if kind > 2 else "hydrostatics", name)
        _draw_temperature(bottom, row, kind)
    top.set_ylim(0.0)
    style.label_axes(top, y=r"density $\rho/\bar\rho$", legend="upper right")
    label = "height $z$ (length) in the source's column"
    style.label_axes(bottom, label, r"$T(z)/T - 1$ (%)", ylim=(-6.0, 12.0))


def draw_two_kinds(dataset: xr.Dataset) -> Figure:
    """Draw densities of heavy and light discs in two gases, their ratio, and the source's mixture."""
    of_source = _columns_named(dataset, "source")
    figure, axes = style.new((2.2,), (2.2,), (2.0, 1.0), *[(1.6,) for _ in of_source])
    names = ("light", "heavy")
    columns = _columns_named(dataset, "dilute", "dense")
    for n, (axis, row) in enumerate(zip(axes[:2], columns, strict=True)):
        for kind, name in enumerate(names):
            _draw_density(axis, row, kind, None, name)
            if n:
                ideal = _ideal(row, kind) / row.mean_density
                axis.plot(row.height, ideal, color=style.COLOURS[kind], ls=":", label=f"{name} if ideal")
        axis.set_yscale("log")
        style.label_axes(axis, "height $z$ (length)", r"density $\rho_i/\bar\rho$", ylim=(0.01, 20.0))
        axis.legend(loc="upper right", ncol=2, columnspacing=0.8)
    _draw_exchange(axes[2], axes[3], columns)
    for axis, row in zip(axes[4:], of_source, strict=True):
        _draw_shares(axis, row)
    titled = (*axes[:3], *axes[4:])
    for axis, title in zip(titled, ("(a) dilute", "(b) dense", "(c)", "(d)"), strict=False):
        style.letter(axis, title)
    return figure


def _draw_exchange(top: Axes, bottom: Axes, columns: list[Row]) -> None:
    style.band(bottom, -3.0, 3.0)
    style.level(bottom, 0.0)
    for kind, row in enumerate(columns, start=2):
        error = row.log_ratio.error
        seen = np.isfinite(error) & (error < 0.3)
        height, ratio, expected = row.height[seen], row.log_ratio[seen], row.log_ratio_expected[seen]
        style.points(top, height, ratio, kind=kind, hollow=True, label=row.column)
        top.plot(height, expected, color=style.COLOURS[kind], zorder=4)
        style.points(bottom, height, (ratio.value - expected) / ratio.error, kind=kind, markersize=2.5)
    style.label_axes(top, y=r"$\ln(\rho_\mathrm{heavy}/\rho_\mathrm{light})$", legend="upper right")
    style.label_axes(
        bottom, "height $z$ (length)", r"residual ($\sigma$)", ylim=(-4.5, 4.5), yticks=[-3, 0, 3]
    )


def _draw_shares(axis: Axes, row: Row) -> None:
    reported = np.array(row.source_shares)
    edges = np.linspace(0.0, row.top, len(reported) + 1)
    axis.stairs(reported, edges, baseline=None, color=style.GREY, label="source's run")
    style.points(axis, 0.5 * (edges[1:] + edges[:-1]), row.share, kind=1, label="our run")
    light, heavy = row.hydrostatic
    axis.plot(row.height, light / (light + heavy), color=style.REFERENCE, label="equilibrium at the same $T$")
    label = "height $z$ (length) in the source's mixture"
    style.label_axes(axis, label, "fraction of light discs", "upper left", ylim=(0.0, 1.0))


def _columns_named(dataset: xr.Dataset, *names: str) -> list[Row]:
    """Return those of these columns that exist, in this order."""
    columns = {row.column: row for row in Table(dataset, "point")}
    return [columns[name] for name in names if name in columns]


def _draw_density(axis: Axes, row: Row, kind: int, theory: str | None, label: str) -> None:
    """Draw the density of species `kind`, or of the only one, over the mean density, with theory."""
    species = kind if len(row.density) > 1 else 0
    density, mean = row.density[species], row.mean_density
    seen = _enough_particles(density)
    style.points(axis, row.height[seen], density[seen] / mean, kind=kind, hollow=True, label=label)
    axis.plot(
        row.height, _expected_density(row, species) / mean, color=style.COLOURS[kind], label=theory, zorder=4
    )


def _enough_particles(density: Estimate) -> np.ndarray:
    return np.asarray(density.error < KNOWN * density.value)


def _draw_temperature(axis: Axes, row: Row, kind: int) -> None:
    seen = _enough_particles(row.density[0])
    _draw_percent(axis, row.height[seen], row.temperature_ratio[seen], kind)


def _expected_density(row: Row, kind: int) -> np.ndarray:
    """Return the expected density (B,): ideal gas in a dilute column, else hydrostatics."""
    return _ideal(row, kind) if _is_dilute(row) else np.asarray(row.hydrostatic[kind])


def _ideal(row: Row, kind: int) -> np.ndarray:
    """Compute the density (B,) of an ideal gas with the column's particle number and temperature."""
    weight = row.mass[kind] * row.strength / row.temperature.value
    number = row.density.value[kind].mean() * row.top
    return np.asarray(number * ideal_profile(row.height, row.top, weight))


def _draw_percent(axis: Axes, x: np.ndarray, ratio: Estimate, kind: int) -> None:
    """Draw the deviation of a ratio from 1 in per cent, with a line at zero."""
    style.level(axis, 0.0)
    style.points(axis, x, 100.0 * (ratio - 1.0), kind=kind, hollow=True, markersize=2.5)
    axis.set_ylim(-4.5, 4.5)


FIGURES = {
    "barometric": Parts(ONE_KIND, measure_one_kind, claim_one_kind, draw_one_kind, key=3),
    "separation": Parts(TWO_KINDS, measure_two_kinds, claim_two_kinds, draw_two_kinds),
}
