"""A dense fluid between two hard walls."""

from __future__ import annotations

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from gaspart.rendering import style
from gaspart.reproduction.families.shared.rows import estimates


def thin_film(dataset: xr.Dataset) -> Figure:
    """Density above a wall, the contact theorem at every width, and the pressure against the width."""
    figure, (profile, contact, pressure) = style.new((2.8,), (1.3, 2.1))
    _profile(profile, dataset)
    _contact(contact, dataset)
    _solvation(pressure, dataset)
    style.letters(profile, contact, pressure)
    return figure


def _profile(axis: Axes, dataset: xr.Dataset) -> None:
    widest = dataset.isel(width=-1)
    axis.plot(dataset["place"], dataset["functional"], color=style.REFERENCE, label="White Bear", zorder=4)
    style.measured(
        axis, dataset["place"], estimates(dataset, "density"), color=style.DATA,
        markersize=1.8, label=f"measured, $H={float(widest['width']):g}\\,\\sigma$",
    )  # fmt: skip
    label = "$P/k_\\mathrm{B}T$ on the wall"
    style.measured(axis, 0.0, estimates(widest, "pressure"), kind=1, label=label)
    style.level(axis, dataset.attrs["bulk_density"])
    axis.set(xlim=(-0.3, min(4.0, float(dataset["place"].max()))), ylim=(0.0, None))
    axis.set(xlabel="distance of centres from contact $z/\\sigma$", ylabel="density $\\rho\\sigma^3$")
    axis.legend(loc="upper right")


def _contact(axis: Axes, dataset: xr.Dataset) -> None:
    style.band(axis, -1.0, 1.0)
    style.level(axis, 0.0)
    ratio = dataset["contact"] / dataset["pressure"]
    error = ratio * np.hypot(
        np.hypot(dataset["contact_error"], dataset["truncation"]) / dataset["contact"],
        dataset["pressure_error"] / dataset["pressure"],
    )
    style.points(axis, _shown(dataset), 100.0 * (ratio - 1.0), 100.0 * error, color=style.DATA)
    axis.set_ylabel("$\\rho(0)k_\\mathrm{B}T/P-1$  (%)")


def _solvation(axis: Axes, dataset: xr.Dataset) -> None:
    style.level(axis, 0.0)
    curve = dataset["curve"] - dataset.attrs["functional_bulk_pressure"]
    axis.plot(dataset["theory_width"], curve, color=style.REFERENCE, label="White Bear")
    excess = dataset["at_bulk"] - dataset.attrs["bulk_pressure"]
    style.points(axis, _shown(dataset), excess, dataset["at_bulk_error"], color=style.DATA, label="measured")
    widest = dataset["width"].values[-1]
    axis.annotate(
        f"{widest:g}",
        (_shown(dataset)[-1], excess.values[-1]),
        (-6, 0),
        textcoords="offset points",
        ha="right",
        va="center",
    )
    axis.set(xlabel="width of the slit $H/\\sigma$", ylabel="$(P-P_\\mathrm{bulk})\\sigma^3/k_\\mathrm{B}T$")
    axis.legend(loc="upper right")


def _shown(dataset: xr.Dataset) -> np.ndarray:
    """(width,) places on the axis: the widest slit is drawn at its end, and labelled with its width."""
    width = dataset["width"].values.copy()
    width[-1] = min(width[-1], float(dataset["theory_width"].max()) + 0.3)
    return width
