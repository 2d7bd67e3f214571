"""A large sphere in a gas: its paths, its mean-squared displacement, its velocity autocorrelation."""

from __future__ import annotations

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

from gaspart import theory
from gaspart.rendering import style
from gaspart.reproduction.families.shared.rows import estimates

LONGEST = 3.2
"""Friction times up to which the velocity autocorrelation is drawn: noise dominates beyond."""
MOST = 10
"""About so many of its points are drawn of each sphere."""


def brownian_paths(ds: xr.Dataset) -> Figure:
    """Paths from above, a panel for each point; in the middle, the sphere to scale."""
    from matplotlib.patches import Circle

    figure, axes = style.new(*((3.4,),) * ds.sizes["point"])
    for index, axis in enumerate(axes):
        row = ds.isel(point=index)
        axis.add_patch(Circle((0.0, 0.0), float(row["radius"]), color=style.GREY, alpha=0.35, lw=0))
        for path in range(ds.sizes["path"]):
            points = row["way"].isel(path=path).values
            colour = style.COLOURS[path % len(style.COLOURS)]
            axis.plot(points[:, 0], points[:, 1], color=colour, lw=0.7)
            end = points[np.isfinite(points[:, 0])][-1]
            axis.plot(*end[:2], color=colour, marker=style.MARKERS[path % len(style.MARKERS)], zorder=4)
        axis.plot(0.0, 0.0, color=style.DATA, marker="o", ms=2.5, zorder=5)
        widest = 1.08 * np.nanmax(np.abs(row["way"].values[..., :2]))
        axis.set_xlim(-widest, widest)
        axis.set_ylim(-widest, widest)
        axis.set_aspect("equal")
        axis.set_xlabel("$x$ (length)")
        axis.set_ylabel("$y$ (length)")
        masses = float(row["mass"] / row["gas_mass"])
        collisions = float(row["duration"] * row["friction"])
        style.letter(axis, f"({'ab'[index]}) $M={masses:g}\\,m$, {collisions:.0f} friction times")
    return figure


def brownian_msd(ds: xr.Dataset) -> Figure:
    """Mean-squared displacement and velocity autocorrelation, with those of the Langevin equation; below, the
    deviations from it, with those that theory expects of a light particle as lines."""
    figure, axes = style.new((2.4, 1.1), (2.4, 1.1))
    t = np.geomspace(0.05, 1.05 * float(ds["time"].max()), 300)
    axes[0].loglog(t, theory.langevin_msd(t, 1.0 / 6.0, 1.0), color=style.DATA, label="Langevin", zorder=2)
    axes[2].semilogy(t, np.exp(-t), color=style.DATA, label=r"$e^{-\gamma t}$", zorder=2)
    for residual in (axes[1], axes[3]):
        style.level(residual, 0.0)
    for kind in range(ds.sizes["point"]):
        row = ds.isel(point=kind).dropna("lag", subset=["time"])
        label = f"$M={float(row['mass'] / row['gas_mass']):g}\\,m$"
        label += ", equal speeds" * bool(row["equal_speeds"]) + ", steps" * bool(row["stepped"])
        time = row["time"].values
        shown = np.unique(np.round(np.geomspace(1, time.size - 1, 16)).astype(int))
        curve = theory.langevin_msd(time[shown], 1.0 / 6.0, 1.0)
        msd, error = estimates(row, "msd")[:, shown]
        hollow = kind > 0
        style.points(axes[0], time[shown], msd, error, kind=kind, hollow=hollow, label=label)
        style.points(axes[1], time[shown], msd / curve - 1.0, error / curve, kind=kind, hollow=hollow)
        if row["is_light"]:
            expected = row["expected_msd"].values[1:] / theory.langevin_msd(time[1:], 1.0 / 6.0, 1.0) - 1.0
            axes[1].plot(time[1:], expected, color=style.COLOURS[kind], lw=0.8, zorder=2)
            early = time < LONGEST
            expected = row["expected_vacf"].values[early] - np.exp(-time[early])
            axes[3].plot(time[early], expected, color=style.COLOURS[kind], lw=0.8, zorder=2)
        shown = np.flatnonzero(time < LONGEST)
        shown = shown[:: max(1, round(shown.size / MOST))]
        (vacf, error), curve = estimates(row, "vacf")[:, shown], np.exp(-time[shown])
        style.points(axes[2], time[shown], vacf, error, kind=kind, hollow=hollow, label=label)
        style.points(axes[3], time[shown], vacf - curve, error, kind=kind, hollow=hollow)
    axes[0].set_ylabel(r"$\langle\Delta r^2\rangle\,M\gamma^2/6k_\mathrm{B}T$")
    axes[2].set_ylabel(r"$\langle V(0)\!\cdot\!V(t)\rangle\,M/3k_\mathrm{B}T$")
    axes[1].set_ylabel("ratio $-$ 1")
    axes[3].set_ylabel("difference")
    for bottom in (axes[1], axes[3]):
        bottom.set_ylim(-0.25, 0.25)
        bottom.set_xlabel(r"time $\gamma t$")
    axes[0].legend(loc="lower right")
    axes[2].legend(loc="lower left")
    for axis in axes[:2]:
        axis.set_xscale("log")
        axis.set_xlim(0.07, t[-1])
    for axis in axes[2:]:
        axis.set_xlim(-0.05, LONGEST)
    axes[2].set_ylim(0.02, 1.4)
    style.letters(axes[0], axes[2])
    return figure
