"""Figures of the structure of the fluid, and of its chemical potential."""

from __future__ import annotations

from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from gaspart import theory
from gaspart.analysis.estimate import Estimate
from gaspart.rendering import style
from gaspart.reproduction.families.shared import PARTICLES
from gaspart.reproduction.table import Row, Table

SHIFT = 0.006
"""Horizontal shift of packing fractions, so that points of several methods do not overlap."""


def structure(ds: xr.Dataset) -> Figure:
    """Draw g(r) and S(k) of the densest fluids with theory, and ratios of methods.

    The methods determine the same number.
    """
    figure, axes = style.new((2.3,), (2.3,), (2.3,), (2.3,))
    g, s, zero, contact = axes
    for kind, fluids in enumerate(_spheres_and_discs(ds)):
        if fluids:
            _curves(g, s, fluids[-1], kind)
            _ratios(zero, fluids, kind, {"$S(0)$": fluids.s0_ratio})
            _ratios(contact, fluids, kind, {"$g(r)$": fluids.g_ratio, "rate": fluids.rate_ratio})
    for axis in (zero, contact):
        style.band(axis, 0.99, 1.01)
        style.level(axis, 1.0)
    density = r"packing fraction $\eta$"
    style.label_axes(g, r"distance $r/\sigma$", "$g(r)$", "best", xlim=(0.9, None))
    style.label_axes(s, r"wave number $k\sigma$", "$S(k)$", "best", xlim=(0.0, None))
    style.label_axes(zero, density, r"$S(0)$ / ($kT\,\mathrm{d}\rho/\mathrm{d}P$)", "best", xlim=(0.0, None))
    style.label_axes(contact, density, r"$g(\sigma)$ / $g(\sigma)$ from $Z$", "best", xlim=(0.0, None))
    style.letters(*axes)
    return figure


def _spheres_and_discs(ds: xr.Dataset) -> list[Table]:
    """Return the spheres and the discs, both in order of ascending packing fraction."""
    fluids = Table(ds, "point")
    return [fluids[fluids.dimension == dimension].sorted_by("packing_fraction") for dimension in (3, 2)]


def _curves(g: Axes, s: Axes, fluid: Row, kind: int) -> None:
    """Draw the measured curves of a fluid, for spheres with theory."""
    eta, distance, wave_number = fluid.packing_fraction, fluid.distance, fluid.wave_number
    beyond, finite = distance >= 1.0, np.isfinite(fluid.s.value)
    small: dict[str, Any] = {"kind": kind, "hollow": True, "markersize": 2.0}
    small["label"] = rf"{PARTICLES[fluid.dimension]}, $\eta={eta:.2g}$"
    style.points(g, distance[beyond], fluid.g[beyond], **small)
    style.points(s, wave_number[finite], fluid.s[finite], **small)
    if fluid.dimension == 3:
        r = np.linspace(1.0, distance.max(), 300)
        k = np.linspace(0.0, np.nanmax(wave_number), 300)
        laws = {
            "Verlet–Weis": (theory.verlet_weis_rdf, theory.verlet_weis_structure_factor),
            "Percus–Yevick": (theory.percus_yevick_rdf, theory.percus_yevick_structure_factor),
        }
        for n, (name, (of_r, of_k)) in enumerate(laws.items()):
            look: dict[str, Any] = {"color": "black", "linestyle": ("-", "--")[n], "label": name}
            g.plot(r, of_r(r, eta), **look)
            s.plot(k, of_k(k, eta), **look)


def _ratios(axis: Axes, fluids: Table, kind: int, ratios: dict[str, Estimate]) -> None:
    """Draw ratios that theory predicts to be 1."""
    for n, (name, ratio) in enumerate(ratios.items()):
        eta = fluids.packing_fraction + SHIFT * (kind - 0.5 + 0.4 * n)
        look: dict[str, Any] = {"hollow": n == 1, "color": style.COLOURS[kind]}
        style.points(axis, eta, ratio, kind=kind, label=f"{name}, {PARTICLES[fluids.dimension[0]]}", **look)


def chemical_potential(ds: xr.Dataset) -> Figure:
    """Draw the chemical potential, its ratio, the insertion probability, and ln Q / N.

    The ratio compares both methods.
    """
    figure, axes = style.new((2.3, 1.6), (2.3,), (2.3,))
    upper, ratio, chance, partition = axes
    style.band(ratio, 0.99, 1.01)
    style.level(ratio, 1.0)
    for kind, fluids in enumerate(_spheres_and_discs(ds)):
        if fluids:
            _potential(upper, ratio, fluids, kind)
            _chance(chance, fluids, kind)
            _partition(partition, fluids, kind)
    density = r"packing fraction $\eta$"
    style.label_axes(upper, y=r"$\mu_\mathrm{excess}/kT$", legend="best")
    style.label_axes(ratio, density, "insertion / integral", xlim=(0.0, None), ylim=(0.97, 1.03))
    chance.set(yscale="log", xlim=(0.0, None), ylim=(1e-16, 3.0))  # with space for the legend
    style.label_axes(chance, density, "probability of insertion", "lower left")
    style.label_axes(partition, density, r"$-\ln Q/N$", "best", xlim=(0.0, None))
    style.letters(*axes)
    return figure


def _potential(upper: Axes, ratio: Axes, fluids: Table, kind: int) -> None:
    dimension, colour = fluids.dimension[0], style.COLOURS[kind]
    eta = np.linspace(0.0, fluids.packing_fraction.max(), 200)
    curve = theory.excess_chemical_potential(eta, dimension)
    upper.plot(eta, curve, color=colour, label=f"{PARTICLES[dimension]}, integral")
    label = f"{PARTICLES[dimension]}, insertion"
    style.points(upper, fluids.packing_fraction, fluids.inserted, kind=kind, label=label)
    style.points(ratio, fluids.packing_fraction, fluids.ratio, kind=kind)
    if dimension == 3:
        eta, curve = eta[1:], curve[1:]
        integral = (4.0 * eta - 3.0 * eta**2) / (1.0 - eta) ** 2
        starling = integral + theory.carnahan_starling(eta) - 1.0
        ratio.plot(eta, starling / curve, color=colour, linestyle="--", linewidth=0.8)


def _chance(axis: Axes, fluids: Table, kind: int) -> None:
    """Draw the insertion probability, its theory, and the smallest measurable probability."""
    dimension, colour = fluids.dimension[0], style.COLOURS[kind]
    eta = np.linspace(0.0, fluids.packing_fraction.max(), 200)
    axis.plot(eta, np.exp(-theory.excess_chemical_potential(eta, dimension)), color=colour)
    some = fluids[fluids.probability.value > 0.0]
    style.points(axis, some.packing_fraction, some.probability, kind=kind, label=PARTICLES[dimension])
    look: dict[str, Any] = {"color": colour, "marker": "_", "linestyle": ":", "linewidth": 0.8}
    label = f"one success, {PARTICLES[dimension]}"
    axis.plot(fluids.packing_fraction, fluids.resolution, label=label, **look)


def _partition(axis: Axes, fluids: Table, kind: int) -> None:
    dimension = fluids.dimension[0]
    eta = np.linspace(0.0, fluids.packing_fraction.max(), 200)
    label = f"{PARTICLES[dimension]}, integral"
    axis.plot(eta, theory.excess_free_energy(eta, dimension), color=style.COLOURS[kind], label=label)
    if "ln_q" in fluids.dataset:
        style.points(axis, fluids.packing_fraction, fluids.ln_q, kind=kind)
