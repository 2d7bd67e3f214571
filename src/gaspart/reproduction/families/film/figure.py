"""Figure of a dense fluid between two hard walls."""

from __future__ import annotations

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from gaspart.rendering import style
from gaspart.reproduction.families.film.claims import contact_ratio
from gaspart.reproduction.table import Row, Table


def thin_film(dataset: xr.Dataset) -> Figure:
    """Draw density above a wall, contact theorem at every width, and pressure against width."""
    figure, (profile, contact, pressure) = style.new((2.8,), (1.3, 2.1))
    slits = Table(dataset, "width")
    _profile(profile, slits[-1])
    _contact(contact, slits)
    _solvation(pressure, slits)
    style.letters(profile, contact, pressure)
    return figure


def _profile(axis: Axes, widest: Row) -> None:
    axis.plot(widest.place, widest.functional, color=style.REFERENCE, label="White Bear", zorder=4)
    label = rf"measured, $H={widest.width:g}\,\sigma$"
    style.points(axis, widest.place, widest.density, color=style.DATA, markersize=1.8, label=label)
    label = r"$P/k_\mathrm{B}T$ on the wall"
    style.points(axis, 0.0, widest.pressure, kind=1, label=label)
    style.level(axis, widest.bulk_density)
    labels = r"distance of centres from contact $z/\sigma$", r"density $\rho\sigma^3$"
    limits = -0.3, min(4.0, widest.place.max())
    style.label_axes(axis, *labels, legend="upper right", xlim=limits, ylim=(0.0, None))


def _contact(axis: Axes, slits: Table) -> None:
    style.band(axis, -1.0, 1.0)
    style.level(axis, 0.0)
    style.points(axis, _positions(slits), 100.0 * (contact_ratio(slits) - 1.0), color=style.DATA)
    style.label_axes(axis, y=r"$\rho(0)k_\mathrm{B}T/P-1$  (%)")


def _solvation(axis: Axes, slits: Table) -> None:
    style.level(axis, 0.0)
    curve = slits.curve - slits.functional_bulk_pressure
    axis.plot(slits.theory_width, curve, color=style.REFERENCE, label="White Bear")
    widths, excess = _positions(slits), slits.at_bulk - slits.bulk_pressure
    style.points(axis, widths, excess, color=style.DATA, label="measured")
    axis.annotate(
        f"{slits.width[-1]:g}", (widths[-1], excess.value[-1]), (-6, 0),
        textcoords="offset points", ha="right", va="center",
    )  # fmt: skip
    labels = r"width of the slit $H/\sigma$", r"$(P-P_\mathrm{bulk})\sigma^3/k_\mathrm{B}T$"
    style.label_axes(axis, *labels, legend="upper right")


def _positions(slits: Table) -> np.ndarray:
    """Return the positions (width,) on the axis.

    The widest slit is drawn at the end of the axis, and labelled with its width.
    """
    end = min(slits.width[-1], slits.theory_width.max() + 0.3)
    return np.append(slits.width[:-1], end)
