"""Rough and inelastic particles: relaxation to equal temperatures, steady ratios, Haff's law and clusters."""

from __future__ import annotations

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from gaspart import theory
from gaspart.rendering import style
from gaspart.reproduction.families.shared.claims import PARTICLES
from gaspart.reproduction.families.shared.rows import estimates


def equipartition(ds: xr.Dataset) -> Figure:
    """Both temperatures against collisions, and their difference minus theory's; steady ratios; the same
    temperatures of particles that meet rough walls only."""
    figure, (upper, middle, lower, walls) = style.new((2.3, 1.2), (2.0,), (2.0,))
    _temperatures(upper, ds)
    _differences(middle, ds)
    _ratios(lower, ds)
    _at_walls(walls, ds)
    style.letters(upper, middle, lower, walls)
    return figure


def _temperatures(axis: Axes, ds: xr.Dataset) -> None:
    s = np.linspace(0.0, 1.02 * float(ds["collisions"].max()), 200)
    for kind in range(ds.sizes["start"]):
        row = ds.isel(start=kind)
        q = float(row["inertia"])
        for curve in theory.rough_temperatures(s, q, 1.0):
            axis.plot(s, curve, color=style.COLOURS[kind], zorder=1)
        both = dict(zip(("translation", "rotation"), (False, True), strict=True))
        for name, hollow in both.items():
            label = None if hollow else f"$q={q:g}$"
            style.measured(axis, row["collisions"], estimates(row, name), kind, hollow=hollow, label=label)
    axis.set_xlim(0.0, s[-1])
    axis.set_ylim(0.0, 1.05)
    axis.set_ylabel(r"$T_\mathrm{tr}$ (filled), $T_\mathrm{rot}$ (hollow)")
    axis.legend(loc="lower right")


def _differences(axis: Axes, ds: xr.Dataset) -> None:
    """100 (T_tr - T_rot - exp(-3 q s / (1 + q)^2)): in per cent of the initial temperature."""
    style.level(axis, 0.0)
    for kind in range(ds.sizes["start"]):
        row = ds.isel(start=kind)
        q = float(row["inertia"])
        expected = np.exp(-3.0 * q / (1.0 + q) ** 2 * row["collisions"])
        # 2 T_tr + T_rot is conserved, so both errors come from the same fluctuation.
        error = 1.5 * row["rotation_error"]
        style.points(
            axis,
            row["collisions"],
            100.0 * (row["translation"] - row["rotation"] - expected),
            100.0 * error,
            kind=kind,
        )
    axis.set_xlabel("collisions per particle $s$")
    axis.set_ylabel("minus theory (%)")


def _ratios(axis: Axes, ds: xr.Dataset) -> None:
    """T_rot / T_tr against the tangential restitution: theories, cooling discs, elastic rough discs."""
    curve = np.linspace(-0.99, 1.0, 200)
    for kind, q in enumerate(sorted(set(ds["equilibrium_inertia"].values))):
        theoretical = [theory.rough_ratio(q, tangential) for tangential in curve]
        axis.plot(curve, theoretical, color=style.COLOURS[kind], label=f"$q={q:g}$", zorder=1)
        cooled = ds.isel(cooling=np.isclose(ds["cooling_inertia"].values, q))
        style.measured(axis, cooled["tangential"], estimates(cooled, "steady_ratio"), kind)
        still = ds.isel(equilibrium=np.isclose(ds["equilibrium_inertia"].values, q))
        style.measured(
            axis,
            np.ones(still.sizes["equilibrium"]),
            estimates(still, "equilibrium_ratio"),
            kind,
            hollow=True,
            clip_on=False,
        )
    known = theory.rough_cooling()
    known = known[np.isin(known[:, 0], ds["cooling_inertia"].values)]
    axis.plot(known[:, 1], known[:, 3], "x", color=style.DATA, zorder=5, label="Boltzmann equation")
    axis.set_xlim(-1.0, 1.0)
    axis.set_xticks(np.linspace(-1.0, 1.0, 5))
    axis.set_ylim(0.0, 1.08)
    axis.set_xlabel(r"tangential restitution $\epsilon_\mathrm{t}$")
    axis.set_ylabel(r"steady $T_\mathrm{rot}/T_\mathrm{tr}$")
    axis.legend(loc="upper left")


def _at_walls(axis: Axes, ds: xr.Dataset) -> None:
    """T along the walls and T_rot against time, over the former at the start, and theory's."""
    fine = np.linspace(0.0, float(ds["wall_time"].max()), 200)
    for kind in range(ds.sizes["walls"]):
        row = ds.isel(walls=kind)
        q = float(row["wall_inertia"])
        label = rf"{PARTICLES[int(row['wall_dimension'])]}, $q={q:g}$"
        difference = theory.rough_wall_difference(fine, q)
        for name, hollow, sign in (("translation", False, 1.0), ("rotation", True, -1.0)):
            axis.plot(fine, 0.5 * (1.0 + sign * difference), color=style.COLOURS[kind], zorder=1)
            style.measured(
                axis,
                row["wall_time"],
                estimates(row, f"wall_{name}"),
                kind,
                hollow=hollow,
                label=None if hollow else label,
            )
    axis.set_xlim(0.0, fine[-1])
    axis.set_ylim(0.0, 1.05)
    axis.set_xlabel(r"time $t\,\sqrt{k_\mathrm{B}T/m}/h$ between rough walls")
    axis.set_ylabel(r"$T_\parallel$ (filled), $T_\mathrm{rot}$ (hollow)")
    axis.legend(loc="upper right")


def cooling(ds: xr.Dataset) -> Figure:
    """Four panels: Haff's law, its rate, how a large gas leaves it, and the final state."""
    figure, axes = style.new((2.6,), (2.4,), (2.4,), (2.8,))
    _haff(axes[0], ds)
    _rates(axes[1], ds)
    _leaving(axes[2], ds)
    _picture(axes[3], ds)
    style.letters(*axes[:3])
    last = ds.isel(clusters=int(np.argmin(ds["cluster_restitution"].values)))
    e, s = float(last["cluster_restitution"]), float(last["cluster_collisions"][-1])
    style.letter(axes[3], rf"(d) $\epsilon={e:g}$, $s={s:.0f}$")
    return figure


def _haff(axis: Axes, ds: xr.Dataset) -> None:
    """T over Haff's T_0 / (1 + t / t_H)^2, against 1 + t / t_H."""
    style.level(axis, 1.0)
    for dimension in (2, 3):
        gases = ds.isel(gas=(ds["dimension"] == dimension).values).sortby("restitution", ascending=False)
        for kind in range(gases.sizes["gas"]):
            row = gases.isel(gas=kind)
            since = 1.0 + row["time"].values
            label = rf"{PARTICLES[dimension]}, $\epsilon={float(row['restitution']):g}$"
            values = estimates(row, "temperature") * since**2
            style.measured(axis, since, values, kind, hollow=dimension == 3, label=label)
    axis.set_xscale("log")
    axis.set_xlabel(r"$1+t/t_\mathrm{H}$")
    axis.set_ylabel(r"$T/T_\mathrm{Haff}$")
    axis.legend(loc="lower left", ncols=2)


def _rates(axis: Axes, ds: xr.Dataset) -> None:
    """-d ln T / ds over (1 - e^2)/d: 1 for Maxwell's distribution, 1 + a2/4 for that of the cooling gas."""
    style.level(axis, 1.0)
    curve = np.linspace(0.55, 1.0, 100)
    for kind, dimension in enumerate(sorted(set(ds["dimension"].values))):
        gases = ds.isel(gas=(ds["dimension"] == dimension).values)
        e = gases["restitution"].values
        unit = (1.0 - e**2) / dimension
        correction = 1.0 + 0.25 * theory.fourth_cumulant(curve, int(dimension))
        axis.plot(curve, correction, color=style.COLOURS[kind], zorder=1)
        style.measured(axis, e, estimates(gases, "rate") / unit, kind, label=PARTICLES[int(dimension)])
    axis.set_xlabel(r"restitution $\epsilon$")
    axis.set_ylabel(r"$-(\mathrm{d}\ln T/\mathrm{d}s)\; d/(1-\epsilon^2)$")
    axis.legend(loc="upper right")


def _leaving(axis: Axes, ds: xr.Dataset) -> None:
    """T over Haff's and the variance of the number in a cell over the elastic gas's, against (1 - e^2) s."""
    style.level(axis, 1.0)
    restitution = ds["cluster_restitution"].values
    usual = float(ds.isel(clusters=restitution == 1.0)["variance"].isel(step=slice(1, None)).mean())
    inelastic = [k for k in np.argsort(-restitution) if restitution[k] < 1.0]
    for kind, k in enumerate(inelastic):
        row, e = ds.isel(clusters=k), restitution[k]
        lost = (1.0 - e**2) * row["cluster_collisions"]
        axis.plot(
            lost,
            row["cluster_excess"],
            color=style.COLOURS[kind],
            label=rf"$T/T_\mathrm{{Haff}}$, $\epsilon={e:g}$",
        )
        style.points(
            axis,
            lost[::4],
            (row["variance"] / usual)[::4],
            (row["variance_error"] / usual)[::4],
            kind,
            label=rf"number variance, $\epsilon={e:g}$",
        )
    axis.axvline(10.0, color=style.GREY, linestyle=":", linewidth=0.8, zorder=1)
    axis.set_yscale("log")
    axis.set_ylim(0.6, 300.0)
    axis.set_xlim(0.0)
    axis.set_xlabel(r"$(1-\epsilon^2)\, s$")
    axis.set_ylabel("over the homogeneous gas")
    axis.legend(loc="upper left")


def _picture(axis: Axes, ds: xr.Dataset) -> None:
    """The discs of one run at its end, to scale."""
    from matplotlib.collections import EllipseCollection

    side, diameter = float(ds.attrs["side"]), 2.0 * float(ds.attrs["radius"])
    centres = np.stack([ds["x"].values, ds["y"].values], axis=1)
    size = np.full(len(centres), diameter)
    discs = EllipseCollection(
        size, size, np.zeros(len(centres)), units="x", offsets=centres, transOffset=axis.transData,
        facecolor=style.REFERENCE, linewidth=0,
    )  # fmt: skip
    axis.add_collection(discs)
    axis.set_xlim(0.0, side)
    axis.set_ylim(0.0, side)
    axis.set_aspect("equal")
    axis.set_xlabel(r"$x/\sigma$")
    axis.set_ylabel(r"$y/\sigma$")
