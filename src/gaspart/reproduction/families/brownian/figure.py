"""Figures of a large sphere in a gas: paths, mean-squared displacement, velocity autocorrelation."""

from __future__ import annotations

from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from gaspart import theory
from gaspart.rendering import style
from gaspart.reproduction.table import Row, Table

LONGEST = 3.2
"""Maximum time at which the velocity autocorrelation is drawn, in friction times; noise dominates later."""
MOST = 10
"""Approximate number of points per sphere in the figure."""


def brownian_paths(ds: xr.Dataset) -> Figure:
    """Draw paths from above, a panel for each point, with the sphere to scale."""
    from matplotlib.patches import Circle

    spheres = Table(ds, "point")
    figure, axes = style.new(*((3.4,),) * len(spheres))
    for letter, axis, sphere in zip("abcdefgh", axes, spheres, strict=False):
        axis.add_patch(Circle((0.0, 0.0), sphere.radius, color=style.GREY, alpha=0.35, lw=0))
        for path, way in enumerate(sphere.way):
            colour = style.COLOURS[path % len(style.COLOURS)]
            axis.plot(way[:, 0], way[:, 1], color=colour, lw=0.7)
            end = way[np.isfinite(way[:, 0])][-1]
            axis.plot(*end[:2], color=colour, marker=style.MARKERS[path % len(style.MARKERS)], zorder=4)
        axis.plot(0.0, 0.0, color=style.DATA, marker="o", ms=2.5, zorder=5)
        widest = 1.08 * np.nanmax(np.abs(sphere.way[..., :2]))
        axis.set(xlim=(-widest, widest), ylim=(-widest, widest), aspect="equal")
        style.label_axes(axis, "$x$ (length)", "$y$ (length)")
        mass, collisions = sphere.mass / sphere.gas_mass, sphere.duration * sphere.friction
        style.letter(axis, f"({letter}) $M={mass:g}\\,m$, {collisions:.0f} friction times")
    return figure


def brownian_msd(ds: xr.Dataset) -> Figure:
    """Draw mean-squared displacement and velocity autocorrelation, with the Langevin equation.

    Lower panels show the deviations from the Langevin equation. Lines are the expected deviations of a light
    particle.
    """
    figure, (far, ratio, memory, difference) = style.new((2.4, 1.1), (2.4, 1.1))
    spheres = Table(ds, "point")
    t = np.geomspace(0.05, 1.05 * np.nanmax(spheres.time), 300)
    far.loglog(t, _langevin(t), color=style.DATA, label="Langevin", zorder=2)
    memory.semilogy(t, np.exp(-t), color=style.DATA, label=r"$e^{-\gamma t}$", zorder=2)
    for residual in (ratio, difference):
        style.level(residual, 0.0)
    for kind, sphere in enumerate(spheres):
        label = f"$M={sphere.mass / sphere.gas_mass:g}\\,m$"
        label += ", equal speeds" * bool(sphere.equal_speeds) + ", steps" * bool(sphere.stepped)
        look: dict[str, Any] = {"kind": kind, "hollow": kind > 0}
        _displacement(far, ratio, sphere, label, look)
        _memory(memory, difference, sphere, label, look)
    style.label_axes(far, y=r"$\langle\Delta r^2\rangle\,M\gamma^2/6k_\mathrm{B}T$", legend="lower right")
    correlation = r"$\langle V(0)\!\cdot\!V(t)\rangle\,M/3k_\mathrm{B}T$"
    style.label_axes(memory, y=correlation, legend="lower left", ylim=(0.02, 1.4))
    for residual, name in ((ratio, "ratio $-$ 1"), (difference, "difference")):
        style.label_axes(residual, r"time $\gamma t$", name, ylim=(-0.25, 0.25))
    for axis in (far, ratio):
        axis.set(xscale="log", xlim=(0.07, t[-1]))
    for axis in (memory, difference):
        axis.set_xlim(-0.05, LONGEST)
    style.letters(far, memory)
    return figure


def _langevin(time: np.ndarray) -> np.ndarray:
    """Compute the mean-squared displacement of the Langevin equation in reduced units."""
    return np.asarray(theory.langevin_msd(time, 1.0 / 6.0, 1.0))


def _displacement(axis: Axes, residual: Axes, sphere: Row, label: str, look: dict) -> None:
    """Draw the mean-squared displacement of a sphere, and its ratio to the Langevin equation."""
    time = sphere.time[np.isfinite(sphere.time)]
    frames = np.unique(np.round(np.geomspace(1, time.size - 1, 16)).astype(int))
    msd = sphere.msd[frames]
    style.points(axis, time[frames], msd, label=label, **look)
    style.points(residual, time[frames], msd / _langevin(time[frames]) - 1.0, **look)
    if sphere.is_light:
        expected = sphere.expected_msd[1 : time.size] / _langevin(time[1:]) - 1.0
        residual.plot(time[1:], expected, color=style.COLOURS[look["kind"]], lw=0.8, zorder=2)


def _memory(axis: Axes, residual: Axes, sphere: Row, label: str, look: dict) -> None:
    """Draw the velocity autocorrelation of a sphere, and its deviation from the Langevin equation."""
    early = np.flatnonzero(sphere.time < LONGEST)
    if sphere.is_light:
        expected = sphere.expected_vacf[early] - np.exp(-sphere.time[early])
        line: dict[str, Any] = {"color": style.COLOURS[look["kind"]], "lw": 0.8, "zorder": 2}
        residual.plot(sphere.time[early], expected, **line)
    frames = early[:: max(1, round(early.size / MOST))]
    time, vacf = sphere.time[frames], sphere.vacf[frames]
    style.points(axis, time, vacf, label=label, **look)
    style.points(residual, time, vacf - np.exp(-time), **look)
