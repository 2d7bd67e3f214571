"""Figures of freezing: pressure and order of both starts, structure, coexistence."""

from __future__ import annotations

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from gaspart import theory
from gaspart.analysis.estimate import Estimate
from gaspart.rendering import style
from gaspart.reproduction.table import Row, Table

LOOKS = {"crystal": 1, "fluid": 0}
"""Index of the colour and marker of each start."""
PUBLISHED = (
    (870, "Li 2022", "29 x 30", ":"),
    (65536, "Engel 2013", "square", "--"),
    (1048576, "Engel 2013", "square", "-"),
)
"""Published values: number of discs, source, container and line style."""
EQUILIBRATED = 3.0
"""Largest deviation between starts or halves, in standard errors, of points in equilibrium; other points are
drawn hollow."""


def freezing_discs(dataset: xr.Dataset) -> Figure:
    """Draw pressure with the plateau, psi_6, g(r), and three snapshots with structure factors."""
    pictures = Table(dataset, "shown")
    figure, (loop, order, shells, below) = style.new((2.4, 1.5), (2.0,), (1.65 * len(pictures),))
    starts = _starts(dataset)
    _loop(loop, Table(dataset, "packing_fraction"), starts)
    _order(order, starts, 2)
    style.label_axes(order, y=r"$|\langle\psi_6\rangle|$", ylim=(0.0, 1.0))
    pairs = style.split(below, len(pictures), 2)
    for k, (picture, (snapshot, scattering)) in enumerate(zip(pictures, pairs, strict=True)):
        label = f"{picture.shown:.3g}"
        shells.plot(picture.distance, picture.g + 2.0 * k, color=style.COLOURS[k], label=label)
        _snapshot(snapshot, picture, label)
        _scattering(scattering, picture)
    end = pictures.distance.max()
    style.label_axes(shells, r"distance $r/\sigma$", "$g(r)$, shifted by 2", xlim=(0.0, end))
    shells.legend(ncols=len(pictures), loc="upper right", title=r"$\eta$")
    style.letters(loop, order, shells, pairs[0, 0])
    return figure


def freezing_spheres(dataset: xr.Dataset) -> Figure:
    """Draw pressure of both branches, its residuals, Q_6, and profiles of coexistence."""
    figure, axes = style.new((2.4, 1.2), (1.5,), (2.0,))
    upper, middle, order, slab = axes
    starts = _starts(dataset)
    _branches(upper, Table(dataset, "packing_fraction").packing_fraction, starts)
    _coexistence(upper, Row(dataset))
    _residuals(middle, starts)
    _order(order, starts, 3)
    style.label_axes(order, y="global $Q_6$", ylim=(0.0, 0.6), xlim=upper.get_xlim())
    _profiles(slab, Table(dataset, "half"))
    style.letters(*axes)
    return figure


def _starts(dataset: xr.Dataset) -> dict[str, Table]:
    """Return the packing fractions of the runs of each start."""
    starts = {}
    for side in Table(dataset, "start"):
        states = Table(side.dataset, "packing_fraction")
        starts[side.start] = states[np.isfinite(states.pressure.value)]
    return starts


def _points(axis: Axes, states: Table, y: Estimate, kind: int, label: str | None = None) -> None:
    """Draw filled symbols in equilibrium, and hollow symbols out of equilibrium."""
    equilibrated = states.disagreement <= EQUILIBRATED
    for chosen, hollow in ((equilibrated, False), (~equilibrated, True)):
        if chosen.any():
            named = None if hollow and equilibrated.any() else label
            style.points(
                axis, states.packing_fraction[chosen], y[chosen], kind=kind, hollow=hollow, label=named
            )


def _loop(axis: Axes, states: Table, starts: dict[str, Table]) -> None:
    expected, eta = theory.COEXISTENCE_PRESSURE[2], states.packing_fraction
    style.band(axis, 0.98 * expected, 1.02 * expected)
    style.level(axis, expected)
    for edge in theory.coexistence_packing_fractions(2):
        axis.axvline(edge, color=style.GREY, linewidth=0.6, linestyle=":")
    fluid = np.linspace(eta.min(), 0.70, 100)
    crystal = np.linspace(theory.LOWEST_CRYSTAL[2], eta.max(), 100)
    for at, z, label, dashes in (
        (fluid, theory.compressibility_factor(fluid, 2), "virial series", "--"),
        (crystal, theory.alder_hoover_young_crystal(crystal, 2), "crystal (AHY)", "-."),
    ):
        axis.plot(at, at / (np.pi / 4.0) * z, color=style.GREY, linestyle=dashes, label=label)
    for start, side in starts.items():
        _points(axis, side, side.pressure, LOOKS[start], f"from the {start}")
        if np.isfinite(side.plateau.value):
            ends, level = [side.plateau_low, side.plateau_high], [side.plateau.value] * 2
            axis.plot(ends, level, color=style.COLOURS[LOOKS[start]], linewidth=0.8)
    _draw_published(axis)
    low, high = np.nanmin(states.pressure.value), np.nanmax(states.pressure.value)
    axis.set_ylim(low - 0.1 * (high - low), high + 0.25 * (high - low))
    style.label_axes(axis, y="pressure $P\\sigma^2/k_\\mathrm{B}T$", legend="lower right")


def _draw_published(axis: Axes) -> None:
    """Draw the published pressures, for the compared number of discs and for larger ones."""
    published = theory.literature("pressure", 2)
    for count, source, container, dashes in PUBLISHED:
        same = (
            (published.source == source) & (published.container == container) & (published["count"] == count)
        )
        rows, label = published[same], f"{count:,} discs".replace(",", " ")
        axis.plot(rows.packing_fraction, rows.value, color="black", lw=0.8, linestyle=dashes, label=label)


def _order(axis: Axes, starts: dict[str, Table], dimension: int) -> None:
    for edge in theory.coexistence_packing_fractions(dimension):
        axis.axvline(edge, color=style.GREY, linewidth=0.6, linestyle=":")
    for start, side in starts.items():
        _points(axis, side, side.order, LOOKS[start])
    axis.set_xlabel("packing fraction $\\eta$")


def _snapshot(axis: Axes, picture: Row, label: str) -> None:
    """Draw discs coloured by the orientation of their bonds, with a period of 60 degrees."""
    from matplotlib.collections import EllipseCollection

    x, y = picture.x, picture.y
    discs = EllipseCollection(
        1.0, 1.0, 0.0, units="x", offsets=np.stack([x, y], axis=1), offset_transform=axis.transData,
        array=np.mod(picture.angle / np.pi + 0.5, 2.0), cmap="twilight", linewidths=0,
    )  # fmt: skip
    discs.set_clim(0.0, 2.0)
    axis.add_collection(discs)
    axis.set(xlim=(x.min(), x.max()), ylim=(y.min(), y.max()), aspect="equal", xticks=[], yticks=[])
    axis.set_title(f"$\\eta={label}$", pad=2)


def _scattering(axis: Axes, picture: Row) -> None:
    """Draw S(k) in grey levels, black where it is large."""
    from matplotlib.colors import LogNorm

    waves, factor, norm = (picture.wave_x, picture.wave_y), picture.structure_factor.T, LogNorm(0.1, 100.0)
    image = axis.pcolormesh(*waves, factor, cmap="Greys", norm=norm, rasterized=True)
    image.set_edgecolor("face")
    axis.set(aspect="equal", xlabel="$k_x\\sigma$", xticks=[-10, 0, 10], yticks=[-10, 0, 10])


def _branches(axis: Axes, eta: np.ndarray, starts: dict[str, Table]) -> None:
    expected = theory.COEXISTENCE_PRESSURE[3]
    style.level(axis, expected)
    densities = theory.coexistence_packing_fractions(3)
    axis.plot(densities, [expected] * 2, color=style.GREY, linewidth=2.5, alpha=0.6)
    fluid = np.linspace(eta[0], theory.HIGHEST_PACKING_FRACTION[3], 100)
    crystal = np.linspace(theory.LOWEST_CRYSTAL[3], eta[-1], 100)
    for at, z, label, kind in (
        (fluid, theory.compressibility_factor(fluid, 3), "fluid (KLM)", 2),
        (crystal, theory.etomica_crystal(crystal), "crystal (etomica)", 3),
    ):
        axis.plot(at, at / (np.pi / 6.0) * z, color=style.COLOURS[kind], label=label)
    for start, side in starts.items():
        _points(axis, side, side.pressure, LOOKS[start], f"from the {start}")


def _coexistence(axis: Axes, slab: Row) -> None:
    """Draw the pressure of coexisting crystal and fluid, at their mean density."""
    pressure = Estimate([slab.slab_pressure], [slab.slab_error])
    style.points(axis, [slab.slab_packing_fraction], pressure, kind=6, label="coexistence")
    style.label_axes(axis, y="pressure $P\\sigma^3/k_\\mathrm{B}T$", legend="upper left")


def _residuals(axis: Axes, starts: dict[str, Table]) -> None:
    style.level(axis, 0.0)
    for start, side in starts.items():
        finite = side[np.isfinite(side.reference)]
        _points(axis, finite, 100.0 * (finite.Z / finite.reference - 1.0), LOOKS[start])
    labels = r"packing fraction $\eta$", "$Z/Z_\\mathrm{branch}-1$  (%)"
    style.label_axes(axis, *labels, ylim=(-0.5, 0.5))


def _profiles(axis: Axes, halves: Table) -> None:
    """Draw local order (left) and density (right) along the container, in both halves of the run."""
    other = axis.twinx()
    for half, line in zip(halves, (":", "-"), strict=True):
        axis.plot(half.position, half.slab_order, linestyle=line, color=style.COLOURS[1])
        other.plot(half.position, half.slab_density, linestyle=line, color=style.COLOURS[0])
    for density in theory.COEXISTENCE_DENSITY[3]:
        other.axhline(density, color=style.COLOURS[0], linewidth=0.6, alpha=0.6)
    axis.set(
        xlabel="position along the container $/\\sigma$", ylim=(0.0, 0.6), xlim=(0.0, halves.slab_length)
    )
    axis.set_ylabel("local $q_6$", color=style.COLOURS[1])
    other.set_ylim(0.85, 1.15)
    other.set_ylabel("density $\\rho\\sigma^3$", color=style.COLOURS[0])
