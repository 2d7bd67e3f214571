"""Figure of mixtures and polydisperse gases."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from gaspart import theory
from gaspart.rendering import style
from gaspart.reproduction.families.mixtures.claims import deviations
from gaspart.reproduction.families.shared.claims import PARTICLES
from gaspart.reproduction.families.shared.rows import estimates
from gaspart.scene.sizes import relative_radii

BASE = {3: "boublik", 2: "santos"}
"""The theory from which deviations are drawn."""
_OVER = {3: r"$Z/Z_\mathrm{BMCSL}-1$ (%)", 2: r"$Z/Z_\mathrm{SYH}-1$ (%)"}
_LINES = {"linear": ("--", "SYH 1999"), "santos": ("-", "SYH 2002")}
_MANY = 500  # sizes of a polydisperse gas whose theory is drawn


def mixture_state(ds: xr.Dataset) -> Figure:
    """Deviations of Z from theory by size ratio, density and polydispersity; contact values and rates."""
    figure, axes = style.new(*[(2.1,)] * 6)
    ratio, density, discs, many, contact, rate = axes
    two = _part(ds, np.isfinite(ds["size_ratio"]))
    _by_ratio(ratio, two, 3)
    _by_density(density, two)
    _by_ratio(discs, two, 2)
    _by_polydispersity(many, _part(ds, np.isfinite(ds["polydispersity"])))
    _pairs(contact, two, "contact", theory.mixture_contact_values)
    contact.set_ylabel(r"contact value $g_{ij}$, spheres")
    _pairs(rate, two, "rate", theory.mixture_collision_rates)
    rate.set_yscale("log")
    rate.set_ylabel(r"rate $\nu_{ij}\,\sigma_1\sqrt{m/k_\mathrm{B}T}$, spheres")
    style.letters(*axes)
    return figure


def _part(ds: xr.Dataset, chosen: xr.DataArray | np.ndarray) -> xr.Dataset:
    """Some points."""
    return ds.isel(point=np.flatnonzero(chosen))


def _densest_grid(ds: xr.Dataset, dimension: int) -> xr.Dataset:
    """The points of a dimension at the packing fraction that most of them have."""
    part = _part(ds, ds["dimension"] == dimension)
    values, counts = np.unique(np.round(part["packing_fraction"].values, 9), return_counts=True)
    if not len(values):
        return part
    return _part(part, np.isclose(part["packing_fraction"], values[np.argmax(counts)]))


def _curve(
    axis: Axes, x: np.ndarray, dimension: int, of: Callable[[float], tuple], colour: str, label: bool
) -> None:
    """Theories over the one that is the base, in per cent; of(x): packing fraction, diameters, numbers."""
    for name, (dashes, title) in _LINES.items():
        if name == BASE[dimension] or dimension == 2:
            continue
        values = []
        for at in x:
            eta, sizes, numbers = of(float(at))
            z, base = (
                theory.mixture_compressibility_factor(eta, dimension, sizes, numbers, kind)
                for kind in (name, BASE[dimension])
            )
            values.append(100.0 * (z / base - 1.0))
        axis.plot(x, values, dashes, color=colour, lw=0.9, label=title if label else None)


def _by_ratio(axis: Axes, two: xr.Dataset, dimension: int) -> None:
    """Against the size ratio, by composition."""
    part = _densest_grid(two, dimension)
    x = np.linspace(0.28, 1.0, 60)
    for kind, small in enumerate(np.unique(part["small_fraction"].values)):
        chosen = _part(part, part["small_fraction"] == small)
        eta, shift = float(chosen["packing_fraction"][0]), 0.008 * (kind - 0.5)

        def of(q: float, eta: float = eta, small: float = float(small)) -> tuple:
            return eta, (1.0, q), (1.0 - small, small)

        _points(axis, chosen["size_ratio"] + shift, chosen, BASE[dimension], kind, f"{small:.0%} small")
        _curve(axis, x, dimension, of, style.COLOURS[kind], kind == 0)
    axis.axhline(0.0, color=style.GREY, lw=0.8, label="BMCSL" if dimension == 3 else "SYH 1999, 2002")
    axis.set_xlabel(r"size ratio $\sigma_2/\sigma_1$")
    axis.set_ylabel(f"{_OVER[dimension]}, {PARTICLES[dimension]}")
    axis.legend(loc="best")


def _points(
    axis: Axes, x: xr.DataArray | np.ndarray, ds: xr.Dataset, base: str, kind: int, label: str
) -> None:
    value, error = deviations(ds, base)
    style.points(axis, x, 100.0 * value, 100.0 * error, kind=kind, label=label)


def _by_density(axis: Axes, two: xr.Dataset) -> None:
    """Against the packing fraction, of one size ratio and composition."""
    chosen = _part(two, np.isclose(two["size_ratio"], 0.5) & np.isclose(two["small_fraction"], 0.5))
    for kind, dimension in enumerate((3, 2)):
        part = _part(chosen, chosen["dimension"] == dimension).sortby("packing_fraction")
        label = "spheres, over BMCSL" if dimension == 3 else "discs, over SYH"
        _points(axis, part["packing_fraction"], part, BASE[dimension], kind, label)
        x = np.linspace(0.01, 0.46, 60)
        _curve(axis, x, dimension, lambda eta: (eta, (1.0, 0.5), (0.5, 0.5)), style.COLOURS[kind], True)
    axis.axhline(0.0, color=style.GREY, lw=0.8)
    axis.set_xlim(0.0)
    axis.set_xlabel(r"packing fraction $\eta$, size ratio 0.5")
    axis.set_ylabel("$Z$ over theory $-1$ (%)")
    axis.legend(loc="best")


def _by_polydispersity(axis: Axes, many: xr.Dataset) -> None:
    """Against the polydispersity: spheres and discs."""
    for kind, dimension in enumerate((3, 2)):
        part = _part(many, many["dimension"] == dimension)
        if not part.sizes["point"]:
            continue
        label = f"{PARTICLES[dimension]}, over {'BMCSL' if dimension == 3 else 'SYH'}"
        _points(axis, part["polydispersity"], part, BASE[dimension], kind, label)
        eta = float(part["packing_fraction"][0])
        x = np.linspace(0.0, 0.32, 33)

        def of(spread: float, eta: float = eta) -> tuple:
            return eta, relative_radii(_MANY, spread, "lognormal"), None

        _curve(axis, x, dimension, of, style.COLOURS[kind], True)
    axis.axhline(0.0, color=style.GREY, lw=0.8)
    axis.set_xlabel("polydispersity of the radii")
    axis.set_ylabel("$Z$ over theory $-1$ (%)")
    axis.legend(loc="best")


def _pairs(axis: Axes, two: xr.Dataset, name: str, predicted: Callable[..., np.ndarray]) -> None:
    """A property of each pair of species against the size ratio: spheres, half of them small."""
    part = _densest_grid(two, 3)
    part = _part(part, np.isclose(part["small_fraction"], 0.5))
    if not part.sizes["point"]:
        return
    eta = float(part["packing_fraction"][0])
    x = np.linspace(0.28, 1.0, 60)
    places = {"large-large": (0, 0), "large-small": (0, 1), "small-small": (1, 1)}
    for dashes, kind in (("-", "boublik"), ("--", "santos")):
        curves = np.array([predicted(eta, 3, (1.0, q), (0.5, 0.5), theory=kind) for q in x])
        for n, at in enumerate(places.values()):
            label = {"boublik": "BMCSL", "santos": "SYH 2002"}[kind] if n == 0 else None
            axis.plot(x, curves[:, at[0], at[1]], dashes, color=style.COLOURS[n], lw=0.9, label=label)
    for n, pair in enumerate(places):
        at = part.sel(pair=pair)
        style.measured(axis, at["size_ratio"], estimates(at, name), n, label=pair)
    axis.set_xlabel(r"size ratio $\sigma_2/\sigma_1$")
    axis.legend(loc="best")
