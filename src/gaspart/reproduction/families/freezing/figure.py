"""Freezing: pressure and order of both starts, structure, and coexisting crystal and fluid."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from gaspart import theory
from gaspart.rendering import style
from gaspart.reproduction.families.shared.rows import estimates

LOOKS = {"crystal": 1, "fluid": 0}
"""Index of the colour and marker of each start."""
EQUILIBRATED = 3.0
"""Points whose starts or halves differ by more standard errors are drawn hollow: not in equilibrium."""


def freezing_discs(dataset: xr.Dataset) -> Figure:
    """Pressure with the plateau, psi_6, g(r), and three snapshots with their structure factors."""
    shown = dataset.sizes["shown"]
    figure, (loop, order, shells, below) = style.new((2.4, 1.5), (2.0,), (1.65 * shown,))
    _loop(loop, dataset)
    _order(order, dataset, r"$|\langle\psi_6\rangle|$")
    order.set_ylim(0.0, 1.0)
    pairs = style.split(below, shown, 2)
    for k, (left, right) in enumerate(pairs):
        at = dataset.isel(shown=k)
        label = f"{float(at['shown']):.3g}"
        shells.plot(at["distance"], at["g"] + 2.0 * k, color=style.COLOURS[k], label=label)
        _snapshot(left, at, label)
        _scattering(right, at)
    end = float(dataset["distance"].max())
    shells.set(xlim=(0.0, end), xlabel=r"distance $r/\sigma$", ylabel="$g(r)$, shifted by 2")
    shells.legend(ncols=shown, loc="upper right", title=r"$\eta$")
    style.letters(loop, order, shells, pairs[0, 0])
    return figure


def freezing_spheres(dataset: xr.Dataset) -> Figure:
    """Pressure of both branches, its residuals, Q_6, and the profiles of coexisting crystal and fluid."""
    figure, axes = style.new((2.4, 1.2), (1.5,), (2.0,))
    upper, middle, order, slab = axes
    _branches(upper, dataset)
    _residuals(middle, dataset)
    _order(order, dataset, "global $Q_6$")
    order.set_ylim(0.0, 0.6)
    order.set_xlim(upper.get_xlim())
    middle.set_xlabel(r"packing fraction $\eta$")
    _profiles(slab, dataset)
    style.letters(*axes)
    return figure


def _starts(dataset: xr.Dataset) -> Iterator:
    """Each start's name, points, colour, and which of them are in equilibrium."""
    for start in dataset["start"].values:
        side = dataset.sel(start=start).dropna("packing_fraction", subset=["pressure"])
        yield str(start), side, LOOKS[str(start)], (side["disagreement"] <= EQUILIBRATED).values


def _points(
    axis: Axes,
    side: xr.Dataset,
    what: str,
    kind: int,
    equilibrated: np.ndarray,
    label: str | None = None,
    scale: float = 1.0,
    shift: float = 0.0,
) -> None:
    """Filled symbols in equilibrium, hollow ones not."""
    eta, (value, error) = side["packing_fraction"].values, scale * estimates(side, what)
    value = value + shift
    for chosen, hollow in ((equilibrated, False), (~equilibrated, True)):
        if chosen.any():
            style.points(
                axis,
                eta[chosen],
                value[chosen],
                error[chosen],
                kind=kind,
                hollow=hollow,
                label=None if hollow and equilibrated.any() else label,
            )


def _loop(axis: Axes, dataset: xr.Dataset) -> None:
    expected = theory.COEXISTENCE_PRESSURE[2]
    style.band(axis, 0.98 * expected, 1.02 * expected)
    style.level(axis, expected)
    eta = dataset["packing_fraction"].values
    for edge in theory.coexistence_packing_fractions(2):
        axis.axvline(edge, color=style.GREY, linewidth=0.6, linestyle=":")
    fluid = np.linspace(eta.min(), 0.70, 100)
    crystal = np.linspace(theory.LOWEST_CRYSTAL[2], eta.max(), 100)
    for at, z, label, dashes in (
        (fluid, theory.compressibility_factor(fluid, 2), "virial series", "--"),
        (crystal, theory.alder_hoover_young_crystal(crystal, 2), "crystal (AHY)", "-."),
    ):
        axis.plot(at, at / (np.pi / 4.0) * z, color=style.GREY, linestyle=dashes, label=label)
    for start, side, kind, equilibrated in _starts(dataset):
        _points(axis, side, "pressure", kind, equilibrated, f"from the {start}")
        if np.isfinite(side["plateau"]):
            ends = [float(side["plateau_low"]), float(side["plateau_high"])]
            axis.plot(ends, [float(side["plateau"])] * 2, color=style.COLOURS[kind], linewidth=0.8)
    known = theory.LIQUID_DISCS
    axis.plot(*known, marker="*", color="black", linestyle="none", markersize=6, label="65 536 discs (2013)")
    low, high = float(dataset["pressure"].min()), float(dataset["pressure"].max())
    axis.set_ylim(low - 0.1 * (high - low), high + 0.25 * (high - low))
    axis.set_ylabel("pressure $P\\sigma^2/k_\\mathrm{B}T$")
    axis.legend(loc="lower right")


def _order(axis: Axes, dataset: xr.Dataset, label: str) -> None:
    for edge in theory.coexistence_packing_fractions(2 if "shown" in dataset.dims else 3):
        axis.axvline(edge, color=style.GREY, linewidth=0.6, linestyle=":")
    for _, side, kind, equilibrated in _starts(dataset):
        _points(axis, side, "order", kind, equilibrated)
    axis.set_xlabel("packing fraction $\\eta$")
    axis.set_ylabel(label)


def _snapshot(axis: Axes, at: xr.Dataset, label: str) -> None:
    """Discs coloured by the orientation of their bonds, which has a period of 60 degrees."""
    from matplotlib.collections import EllipseCollection

    x, y = at["x"].values, at["y"].values
    discs = EllipseCollection(
        1.0, 1.0, 0.0, units="x", offsets=np.stack([x, y], axis=1), offset_transform=axis.transData,
        array=np.mod(at["angle"].values / np.pi + 0.5, 2.0), cmap="twilight", linewidths=0,
    )  # fmt: skip
    discs.set_clim(0.0, 2.0)
    axis.add_collection(discs)
    axis.set(xlim=(x.min(), x.max()), ylim=(y.min(), y.max()), aspect="equal", xticks=[], yticks=[])
    axis.set_title(f"$\\eta={label}$", pad=2)


def _scattering(axis: Axes, at: xr.Dataset) -> None:
    """S(k) in grey levels, black where it is large."""
    from matplotlib.colors import LogNorm

    image = axis.pcolormesh(
        at["wave_x"],
        at["wave_y"],
        at["structure_factor"].values.T,
        cmap="Greys",
        norm=LogNorm(0.1, 100.0),
        rasterized=True,
    )
    image.set_edgecolor("face")
    axis.set(aspect="equal", xlabel="$k_x\\sigma$", xticks=[-10, 0, 10], yticks=[-10, 0, 10])


def _branches(axis: Axes, dataset: xr.Dataset) -> None:
    expected = theory.COEXISTENCE_PRESSURE[3]
    style.level(axis, expected)
    axis.plot(
        theory.coexistence_packing_fractions(3), [expected] * 2, color=style.GREY, linewidth=2.5, alpha=0.6
    )
    low, high = dataset["packing_fraction"].values[[0, -1]]
    fluid = np.linspace(low, theory.HIGHEST_PACKING_FRACTION[3], 100)
    crystal = np.linspace(theory.LOWEST_CRYSTAL[3], high, 100)
    for at, z, label, kind in (
        (fluid, theory.compressibility_factor(fluid, 3), "fluid (KLM)", 2),
        (crystal, theory.speedy_crystal(crystal), "crystal (Speedy)", 3),
    ):
        axis.plot(at, at / (np.pi / 6.0) * z, color=style.COLOURS[kind], label=label)
    for start, side, kind, equilibrated in _starts(dataset):
        _points(axis, side, "pressure", kind, equilibrated, f"from the {start}")
    mean = float(dataset.attrs["slab_packing_fraction"])
    style.points(
        axis, [mean], [dataset["slab_pressure"]], [dataset["slab_error"]], kind=6, label="coexistence"
    )
    axis.set_ylabel("pressure $P\\sigma^3/k_\\mathrm{B}T$")
    axis.legend(loc="upper left")


def _residuals(axis: Axes, dataset: xr.Dataset) -> None:
    style.level(axis, 0.0)
    for _, side, kind, equilibrated in _starts(dataset):
        ratio = side.assign(r=side["Z"] / side["reference"], r_error=side["Z_error"] / side["reference"])
        known = np.isfinite(ratio["r"].values)
        _points(
            axis,
            ratio.isel(packing_fraction=known),
            "r",
            kind,
            equilibrated[known],
            scale=100.0,
            shift=-100.0,
        )
    axis.set_ylim(-0.5, 0.5)
    axis.set_ylabel("$Z/Z_\\mathrm{branch}-1$  (%)")


def _profiles(axis: Axes, dataset: xr.Dataset) -> None:
    """Local order (left) and density (right) along the container, in both halves of the run."""
    other = axis.twinx()
    for half, line in ((0, ":"), (1, "-")):
        at = dataset.isel(half=half)
        axis.plot(at["position"], at["slab_order"], linestyle=line, color=style.COLOURS[1])
        other.plot(at["position"], at["slab_density"], linestyle=line, color=style.COLOURS[0])
    for density in theory.COEXISTENCE_DENSITY[3]:
        other.axhline(density, color=style.COLOURS[0], linewidth=0.6, alpha=0.6)
    axis.set(
        xlabel="position along the container $/\\sigma$",
        ylim=(0.0, 0.6),
        xlim=(0.0, float(dataset["slab_length"])),
    )
    axis.set_ylabel("local $q_6$", color=style.COLOURS[1])
    other.set_ylim(0.85, 1.15)
    other.set_ylabel("density $\\rho\\sigma^3$", color=style.COLOURS[0])
