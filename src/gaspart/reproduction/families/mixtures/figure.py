"""Figure of mixtures and polydisperse gases."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import ArrayLike

from gaspart import theory
from gaspart.rendering import style
from gaspart.reproduction.families.mixtures.claims import deviations
from gaspart.reproduction.families.shared import PARTICLES
from gaspart.reproduction.table import Table
from gaspart.scene.sizes import relative_radii

BASE = {3: "boublik", 2: "santos"}
"""Theory from which deviations are drawn, by dimension."""
_OVER = {3: r"$Z/Z_\mathrm{BMCSL}-1$ (%)", 2: r"$Z/Z_\mathrm{SYH}-1$ (%)"}
_SHORT = {3: "BMCSL", 2: "SYH"}
_MANY = 500  # number of sizes of a polydisperse gas for which theory is drawn
_RATIOS = np.linspace(0.28, 1.0, 60)


def mixture_state(dataset: xr.Dataset) -> Figure:
    """Draw deviations of Z from theory, contact values and collision rates.

    The deviations are drawn against size ratio, density and polydispersity.
    """
    figure, axes = style.new(*[(2.1,)] * 6)
    ratio, density, discs, many, contact, rate = axes
    gases = Table(dataset, "point")
    two = gases[np.isfinite(gases.size_ratio)]
    _by_ratio(ratio, two, 3)
    _by_density(density, two)
    _by_ratio(discs, two, 2)
    _by_polydispersity(many, gases[np.isfinite(gases.polydispersity)])
    _pairs(contact, two, "contact", theory.mixture_contact_values)
    style.label_axes(contact, y=r"contact value $g_{ij}$, spheres")
    _pairs(rate, two, "rate", theory.mixture_collision_rates)
    style.label_axes(rate, y=r"rate $\nu_{ij}\,\sigma_1\sqrt{m/k_\mathrm{B}T}$, spheres", yscale="log")
    style.letters(*axes)
    return figure


def _densest_grid(gases: Table, dimension: int) -> Table:
    """Return the points of a dimension at the most frequent packing fraction."""
    part = gases[gases.dimension == dimension]
    if not part:
        return part
    values, counts = np.unique(np.round(part.packing_fraction, 9), return_counts=True)
    return part[np.isclose(part.packing_fraction, values[np.argmax(counts)])]


def _theories(axis: Axes, x: np.ndarray, spheres: Sequence[tuple], kind: int, named: bool = True) -> None:
    """Draw other theories for mixtures of spheres, relative to BMCSL, in per cent.

    For each x, `spheres` has packing fraction, diameters and numbers.
    """

    def z(name: str) -> np.ndarray:
        factor = theory.mixture_compressibility_factor
        return np.array([factor(eta, 3, sizes, numbers, name) for eta, sizes, numbers in spheres])

    for name, dashes, title in (("linear", "--", "SYH 1999"), ("santos", "-", "SYH 2002")):
        percent = 100.0 * (z(name) / z("boublik") - 1.0)
        axis.plot(x, percent, dashes, color=style.COLOURS[kind], lw=0.9, label=title if named else None)


def _points(axis: Axes, x: ArrayLike, gases: Table, dimension: int, kind: int, label: str) -> None:
    percent = 100.0 * deviations(gases, BASE[dimension])
    style.points(axis, x, percent, kind=kind, label=label)


def _by_ratio(axis: Axes, two: Table, dimension: int) -> None:
    """Draw deviations against the size ratio, by composition."""
    for kind, (small, gases) in enumerate(_densest_grid(two, dimension).by("small_fraction")):
        beside = gases.size_ratio + 0.008 * (kind - 0.5)
        _points(axis, beside, gases, dimension, kind, f"{small:.0%} small")
        if dimension == 3:
            eta = gases.packing_fraction[0]
            spheres = [(eta, (1.0, ratio), (1.0 - small, small)) for ratio in _RATIOS]
            _theories(axis, _RATIOS, spheres, kind, named=kind == 0)
    axis.axhline(0.0, color=style.GREY, lw=0.8, label="BMCSL" if dimension == 3 else "SYH 1999, 2002")
    over = f"{_OVER[dimension]}, {PARTICLES[dimension]}"
    style.label_axes(axis, r"size ratio $\sigma_2/\sigma_1$", over, legend="best")


def _by_density(axis: Axes, two: Table) -> None:
    """Draw deviations against packing fraction, for one size ratio and composition."""
    chosen = two[np.isclose(two.size_ratio, 0.5) & np.isclose(two.small_fraction, 0.5)]
    for kind, dimension in enumerate((3, 2)):
        gases = chosen[chosen.dimension == dimension].sorted_by("packing_fraction")
        label = f"{PARTICLES[dimension]} / {_SHORT[dimension]}"
        _points(axis, gases.packing_fraction, gases, dimension, kind, label)
        if dimension == 3:
            eta = np.linspace(0.01, 0.46, 60)
            _theories(axis, eta, [(fraction, (1.0, 0.5), (0.5, 0.5)) for fraction in eta], kind)
    axis.axhline(0.0, color=style.GREY, lw=0.8)
    x = r"packing fraction $\eta$, size ratio 0.5"
    style.label_axes(axis, x, r"$Z/Z_\mathrm{theory}-1$ (%)", legend="best", xlim=(0.0, None))


def _by_polydispersity(axis: Axes, many: Table) -> None:
    """Draw deviations against the polydispersity of spheres and discs."""
    for kind, dimension in enumerate((3, 2)):
        gases = many[many.dimension == dimension]
        if not gases:
            continue
        label = f"{PARTICLES[dimension]} / {_SHORT[dimension]}"
        _points(axis, gases.polydispersity, gases, dimension, kind, label)
        if dimension == 3:
            spread, eta = np.linspace(0.0, 0.32, 33), gases.packing_fraction[0]
            spheres = [
                (eta, relative_radii(_MANY, polydispersity, "lognormal"), None) for polydispersity in spread
            ]
            _theories(axis, spread, spheres, kind)
    axis.axhline(0.0, color=style.GREY, lw=0.8)
    style.label_axes(axis, "polydispersity of the radii", r"$Z/Z_\mathrm{theory}-1$ (%)", legend="best")


def _pairs(axis: Axes, two: Table, name: str, predicted: Callable[..., np.ndarray]) -> None:
    """Draw a property of each pair of species against size ratio.

    The gases consist of spheres; half of them are small.
    """
    gases = _densest_grid(two, 3)
    gases = gases[np.isclose(gases.small_fraction, 0.5)]
    if not gases:
        return
    eta, pairs = gases.packing_fraction[0], ((0, 0), (0, 1), (1, 1))
    for dashes, kind, title in (("-", "boublik", "BMCSL"), ("--", "santos", "SYH 2002")):
        curves = np.array([predicted(eta, 3, (1.0, q), (0.5, 0.5), theory=kind) for q in _RATIOS])
        for n, (i, j) in enumerate(pairs):
            label = title if n == 0 else None
            axis.plot(_RATIOS, curves[:, i, j], dashes, color=style.COLOURS[n], lw=0.9, label=label)
    for n, pair in enumerate(gases.pair):
        style.points(axis, gases.size_ratio, getattr(gases, name)[:, n], kind=n, label=pair)
    style.label_axes(axis, r"size ratio $\sigma_2/\sigma_1$", legend="best")
