"""Figures of the structure of the fluid and of its chemical potential."""

from __future__ import annotations

from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from gaspart import theory
from gaspart.rendering import style
from gaspart.reproduction.families.shared.claims import PARTICLES
from gaspart.reproduction.families.shared.rows import estimates

SHIFT = 0.006
"""Of packing fractions, so that the points of several routes lie beside each other."""


def structure(ds: xr.Dataset) -> Figure:
    """g(r) and S(k) of the densest of each, against theory; the routes to one number over each other."""
    figure, axes = style.new((2.3,), (2.3,), (2.3,), (2.3,))
    g, s, zero, contact = axes
    for kind, dimension in enumerate((3, 2)):
        part = ds.isel(point=np.flatnonzero(ds["dimension"].values == dimension)).sortby("packing_fraction")
        if part.sizes["point"]:
            _curves(g, s, part.isel(point=-1), kind)
            _ratios(zero, part, kind, {"s0_ratio": "$S(0)$"})
            _ratios(contact, part, kind, {"g_ratio": "$g(r)$", "rate_ratio": "rate"})
    g.set_xlabel(r"distance $r/\sigma$")
    g.set_ylabel("$g(r)$")
    g.set_xlim(0.9)
    s.set_xlabel(r"wave number $k\sigma$")
    s.set_ylabel("$S(k)$")
    s.set_xlim(0.0)
    zero.set_ylabel(r"$S(0)$ over $kT\,\mathrm{d}\rho/\mathrm{d}P$")
    contact.set_ylabel(r"$g(\sigma)$ over that from $Z$")
    for axis in (zero, contact):
        style.band(axis, 0.99, 1.01)
        style.level(axis, 1.0)
        axis.set_xlim(0.0)
        axis.set_xlabel(r"packing fraction $\eta$")
    for axis in axes:
        axis.legend()
    style.letters(*axes)
    return figure


def _curves(g: Axes, s: Axes, row: xr.Dataset, kind: int) -> None:
    """The measured curves of one gas, of spheres with those of theory."""
    eta, dimension = float(row["packing_fraction"]), int(row["dimension"])
    label = rf"{PARTICLES[dimension]}, $\eta={eta:.2g}$"
    beyond = row["distance"].values >= 1.0
    for axis, x, y in ((g, "distance", "g"), (s, "wave_number", "s")):
        kept = beyond if y == "g" else np.isfinite(row[y].values)
        places, values = row[x].values[kept], estimates(row, y)[:, kept]
        style.measured(axis, places, values, kind, hollow=True, markersize=2.0, label=label)
    if dimension == 3:
        r = np.linspace(1.0, float(row["distance"].max()), 300)
        k = np.linspace(0.0, float(row["wave_number"].max()), 300)
        laws = {
            "Verlet–Weis": (theory.verlet_weis_rdf, theory.verlet_weis_structure_factor),
            "Percus–Yevick": (theory.percus_yevick_rdf, theory.percus_yevick_structure_factor),
        }
        for n, (name, (of_r, of_k)) in enumerate(laws.items()):
            look: dict[str, Any] = {"color": "black", "linestyle": ("-", "--")[n], "label": name}
            g.plot(r, of_r(r, eta), **look)
            s.plot(k, of_k(k, eta), **look)


def _ratios(axis: Axes, part: xr.Dataset, kind: int, names: dict[str, str]) -> None:
    """Ratios that are 1."""
    eta = part["packing_fraction"].values
    for n, (name, title) in enumerate(names.items()):
        shift = SHIFT * (kind - 0.5 + 0.4 * n)
        label = f"{title}, {PARTICLES[int(part['dimension'][0])]}"
        look = {"hollow": n == 1, "color": style.COLOURS[kind], "label": label}
        style.measured(axis, eta + shift, estimates(part, name), kind, **look)


def chemical_potential(ds: xr.Dataset) -> Figure:
    """The chemical potential, its ratio of both routes, the chance of an insertion, and ln Q / N."""
    figure, axes = style.new((2.3, 1.6), (2.3,), (2.3,))
    upper, ratio, chance, partition = axes
    style.band(ratio, 0.99, 1.01)
    style.level(ratio, 1.0)
    for kind, dimension in enumerate((3, 2)):
        part = ds.isel(point=np.flatnonzero(ds["dimension"].values == dimension)).sortby("packing_fraction")
        if part.sizes["point"]:
            _potential(upper, ratio, part, kind)
            _chance(chance, part, kind)
            _partition(partition, part, kind)
    upper.set_ylabel(r"$\mu_\mathrm{excess}/kT$")
    ratio.set_ylabel("insertion / integral")
    ratio.set_ylim(0.97, 1.03)
    chance.set_yscale("log")
    chance.set_ylabel("chance of an insertion")
    chance.set_ylim(1e-16, 3.0)  # with room for the legend
    partition.set_ylabel(r"$-\ln Q/N$")
    for axis in (ratio, chance, partition):
        axis.set_xlim(0.0)
        axis.set_xlabel(r"packing fraction $\eta$")
    for axis in (upper, partition):
        axis.legend()
    chance.legend(loc="lower left")
    style.letters(*axes)
    return figure


def _potential(upper: Axes, ratio: Axes, part: xr.Dataset, kind: int) -> None:
    dimension = int(part["dimension"][0])
    colour = style.COLOURS[kind]
    eta = np.linspace(0.0, float(part["packing_fraction"].max()), 200)
    curve = theory.excess_chemical_potential(eta, dimension)
    upper.plot(eta, curve, color=colour, label=f"{PARTICLES[dimension]}, integral")
    label = f"{PARTICLES[dimension]}, insertion"
    style.measured(upper, part["packing_fraction"], estimates(part, "inserted"), kind, label=label)
    style.measured(ratio, part["packing_fraction"], estimates(part, "ratio"), kind)
    if dimension == 3:
        over = eta[1:], (4.0 - 3.0 * eta[1:]) / (1.0 - eta[1:]) ** 2
        integral = 4.0 * eta[1:] - 3.0 * eta[1:] ** 2
        starling = integral / (1.0 - eta[1:]) ** 2 + theory.carnahan_starling(eta[1:]) - 1.0
        ratio.plot(over[0], starling / curve[1:], color=colour, linestyle="--", linewidth=0.8)


def _chance(axis: Axes, part: xr.Dataset, kind: int) -> None:
    """The chance, its theory, and the smallest that could be measured."""
    dimension, eta = int(part["dimension"][0]), part["packing_fraction"].values
    curve = np.linspace(0.0, eta.max(), 200)
    colour = style.COLOURS[kind]
    axis.plot(curve, np.exp(-theory.excess_chemical_potential(curve, dimension)), color=colour)
    found = part["probability"].values > 0.0
    some = part.isel(point=np.flatnonzero(found))
    style.measured(
        axis, some["packing_fraction"], estimates(some, "probability"), kind, label=PARTICLES[dimension]
    )
    label = f"one success, {PARTICLES[dimension]}"
    axis.plot(eta, part["resolution"], color=colour, marker="_", linestyle=":", linewidth=0.8, label=label)


def _partition(axis: Axes, part: xr.Dataset, kind: int) -> None:
    dimension = int(part["dimension"][0])
    eta = np.linspace(0.0, float(part["packing_fraction"].max()), 200)
    label = f"{PARTICLES[dimension]}, integral"
    axis.plot(eta, theory.excess_free_energy(eta, dimension), color=style.COLOURS[kind], label=label)
    if "ln_q" in part:
        style.measured(axis, part["packing_fraction"], estimates(part, "ln_q"), kind)
