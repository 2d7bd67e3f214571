"""Figures of rough, inelastic and driven gases."""

from __future__ import annotations

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from gaspart import theory
from gaspart.rendering import style
from gaspart.reproduction.families.granular.claims import DIFFERENCE, elastic_variance
from gaspart.reproduction.families.shared import PARTICLES
from gaspart.reproduction.table import Table


def equipartition(dataset: xr.Dataset) -> Figure:
    """Draw temperatures against collisions, differences from theory, and steady ratios.

    The temperatures of particles that only hit rough walls are drawn too.
    """
    figure, (upper, middle, lower, walls) = style.new((2.3, 1.2), (2.0,), (2.0,))
    _temperatures(upper, Table(dataset, "start"))
    _differences(middle, Table(dataset, "start"))
    _ratios(lower, Table(dataset, "cooling"), Table(dataset, "equilibrium"))
    _at_walls(walls, Table(dataset, "walls"))
    style.letters(upper, middle, lower, walls)
    return figure


def _temperatures(axis: Axes, gases: Table) -> None:
    s = np.linspace(0.0, 1.02 * np.nanmax(gases.collisions), 200)
    for kind, gas in enumerate(gases):
        for curve in theory.rough_temperatures(s, gas.inertia, 1.0):
            axis.plot(s, curve, color=style.COLOURS[kind], zorder=1)
        style.points(axis, gas.collisions, gas.translation, kind=kind, label=f"$q={gas.inertia:g}$")
        style.points(axis, gas.collisions, gas.rotation, kind=kind, hollow=True)
    both = r"$T_\mathrm{tr}$ (filled), $T_\mathrm{rot}$ (hollow)"
    style.label_axes(axis, y=both, legend="lower right", xlim=(0.0, s[-1]), ylim=(0.0, 1.05))


def _differences(axis: Axes, gases: Table) -> None:
    """Draw 100 (T_tr - T_rot - exp(-3 q s / (1 + q)^2)).

    The result is in per cent of the initial temperature.
    """
    style.level(axis, 0.0)
    for kind, gas in enumerate(gases):
        q, s = gas.inertia, gas.collisions
        expected = np.exp(-3.0 * q / (1.0 + q) ** 2 * s)
        excess = gas.translation.value - gas.rotation.value - expected
        style.points(axis, s, 100.0 * excess, 100.0 * DIFFERENCE * gas.rotation.error, kind=kind)
    style.label_axes(axis, "collisions per particle $s$", "difference (%)")


def _ratios(axis: Axes, cooling: Table, equilibrium: Table) -> None:
    """Draw T_rot / T_tr against tangential restitution: theory, cooling discs, elastic discs."""
    curve = np.linspace(-0.99, 1.0, 200)
    for kind, (q, still) in enumerate(equilibrium.by("equilibrium_inertia")):
        theoretical = [theory.rough_ratio(q, tangential) for tangential in curve]
        axis.plot(curve, theoretical, color=style.COLOURS[kind], label=f"$q={q:g}$", zorder=1)
        cooled = cooling[np.isclose(cooling.cooling_inertia, q)]
        style.points(axis, cooled.tangential, cooled.steady_ratio, kind=kind)
        elastic = np.ones(len(still))
        style.points(axis, elastic, still.equilibrium_ratio, kind=kind, hollow=True, clip_on=False)
    computed = theory.rough_cooling()
    computed = computed[np.isin(computed[:, 0], cooling.cooling_inertia)]
    axis.plot(computed[:, 1], computed[:, 3], "x", color=style.DATA, zorder=5, label="Boltzmann equation")
    axis.set(xlim=(-1.0, 1.0), xticks=np.linspace(-1.0, 1.0, 5), ylim=(0.0, 1.08))
    x, y = r"tangential restitution $\epsilon_\mathrm{t}$", r"steady $T_\mathrm{rot}/T_\mathrm{tr}$"
    style.label_axes(axis, x, y, legend="upper left")


def _at_walls(axis: Axes, gases: Table) -> None:
    """Draw T along the walls and T_rot against time, with theory.

    Both are divided by the initial T along the walls.
    """
    fine = np.linspace(0.0, np.nanmax(gases.wall_time), 200)
    for kind, gas in enumerate(gases):
        label = rf"{PARTICLES[gas.wall_dimension]}, $q={gas.wall_inertia:g}$"
        difference = theory.rough_wall_difference(fine, gas.wall_inertia)
        axis.plot(fine, 0.5 * (1.0 + difference), color=style.COLOURS[kind], zorder=1)
        style.points(axis, gas.wall_time, gas.wall_translation, kind=kind, label=label)
        axis.plot(fine, 0.5 * (1.0 - difference), color=style.COLOURS[kind], zorder=1)
        style.points(axis, gas.wall_time, gas.wall_rotation, kind=kind, hollow=True)
    x = r"time $t\,\sqrt{k_\mathrm{B}T/m}/h$ between rough walls"
    y = r"$T_\parallel$ (filled), $T_\mathrm{rot}$ (hollow)"
    style.label_axes(axis, x, y, legend="upper right", xlim=(0.0, fine[-1]), ylim=(0.0, 1.05))


def cooling(dataset: xr.Dataset) -> Figure:
    """Draw Haff's law, its rate, deviations of a large gas, and the final state."""
    figure, axes = style.new((2.6,), (2.4,), (2.4,), (2.8,))
    gases, clusters = Table(dataset, "gas"), Table(dataset, "clusters")
    _haff(axes[0], gases)
    _rates(axes[1], gases)
    _leaving(axes[2], clusters)
    _picture(axes[3], Table(dataset, "particle"))
    style.letters(*axes[:3])
    last = clusters[np.argmin(clusters.cluster_restitution)]
    e, s = last.cluster_restitution, last.cluster_collisions[-1]
    style.letter(axes[3], rf"(d) $\epsilon={e:g}$, $s={s:.0f}$")
    return figure


def _haff(axis: Axes, gases: Table) -> None:
    """Draw T divided by Haff's law T_0 / (1 + t / t_H)^2.

    The horizontal axis is 1 + t / t_H.
    """
    style.level(axis, 1.0)
    for dimension in (2, 3):
        own = gases[gases.dimension == dimension].sorted_by("restitution")[::-1]
        for kind, gas in enumerate(own):
            since = 1.0 + gas.time
            label = rf"{PARTICLES[dimension]}, $\epsilon={gas.restitution:g}$"
            style.points(
                axis, since, gas.temperature * since**2, kind=kind, hollow=dimension == 3, label=label
            )
    x, y = r"$1+t/t_\mathrm{H}$", r"$T/T_\mathrm{Haff}$"
    style.label_axes(axis, x, y, legend="lower left", columns=2, xscale="log")


def _rates(axis: Axes, gases: Table) -> None:
    """Draw -d ln T / ds divided by (1 - e^2)/d.

    This ratio is 1 for Maxwell's distribution, and 1 + a2/4 for the cooling gas.
    """
    style.level(axis, 1.0)
    curve = np.linspace(0.55, 1.0, 100)
    for kind, (dimension, own) in enumerate(gases.by("dimension")):
        correction = 1.0 + 0.25 * theory.fourth_cumulant(curve, dimension)
        axis.plot(curve, correction, color=style.COLOURS[kind], zorder=1)
        maxwell = (1.0 - own.restitution**2) / dimension
        style.points(axis, own.restitution, own.rate / maxwell, kind=kind, label=PARTICLES[dimension])
    x, y = r"restitution $\epsilon$", r"$-(\mathrm{d}\ln T/\mathrm{d}s)\; d/(1-\epsilon^2)$"
    style.label_axes(axis, x, y, legend="upper right")


def _leaving(axis: Axes, gases: Table) -> None:
    """Draw T divided by Haff's law, and the variance of the particle number in a cell.

    The horizontal axis is (1 - e^2) s. The variance is divided by the variance of the elastic gas.
    """
    style.level(axis, 1.0)
    inelastic = gases[gases.cluster_restitution < 1.0].sorted_by("cluster_restitution")[::-1]
    for kind, gas in enumerate(inelastic):
        e = gas.cluster_restitution
        lost = (1.0 - e**2) * gas.cluster_collisions
        label = rf"$T/T_\mathrm{{Haff}}$, $\epsilon={e:g}$"
        axis.plot(lost, gas.cluster_excess.value, color=style.COLOURS[kind], label=label)
        variance = gas.variance / elastic_variance(gases)
        label = rf"number variance, $\epsilon={e:g}$"
        style.points(axis, lost[::4], variance[::4], kind=kind, label=label)
    axis.axvline(10.0, color=style.GREY, linestyle=":", linewidth=0.8, zorder=1)
    axis.set(yscale="log", ylim=(0.6, 300.0), xlim=(0.0, None))
    style.label_axes(axis, r"$(1-\epsilon^2)\, s$", "ratio to homogeneous gas", legend="upper left")


def _picture(axis: Axes, particles: Table) -> None:
    """Draw the discs at the end of a run, to scale."""
    from matplotlib.collections import EllipseCollection

    side, diameter = particles.side, 2.0 * particles.radius
    centres = np.stack([particles.x, particles.y], axis=1)
    size = np.full(len(centres), diameter)
    discs = EllipseCollection(
        size, size, np.zeros(len(centres)), units="x", offsets=centres, transOffset=axis.transData,
        facecolor=style.REFERENCE, linewidth=0,
    )  # fmt: skip
    axis.add_collection(discs)
    axis.set_aspect("equal")
    style.label_axes(axis, r"$x/\sigma$", r"$y/\sigma$", xlim=(0.0, side), ylim=(0.0, side))


def driven_gas(ds: xr.Dataset) -> Figure:
    """Draw the steady temperature divided by theory, and the fourth cumulant."""
    figure, (upper, lower) = style.new((2.5,), (2.5,))
    table = Table(ds, "gas")
    curve = np.linspace(0.95 * table.restitution.min(), 1.0, 200)
    style.level(upper, 1.0)
    style.level(lower, 0.0)
    for kind, (dimension, gases) in enumerate(table.by("dimension")):
        e, name = gases.restitution, PARTICLES[dimension]
        balance = theory.driven_temperature(e, dimension, gases.power, gases.packing_fraction)
        style.points(upper, e, gases.temperature / balance, kind=kind, label=name)
        style.points(lower, e, gases.cumulant, kind=kind, label=name)
        for of, line in ((theory.driven_cumulant, "-"), (theory.fourth_cumulant, ":")):
            own = theory.finite_size_cumulant(of(curve, dimension), gases.count[0], dimension)
            lower.plot(curve, own, color=style.COLOURS[kind], linestyle=line, zorder=1)
    style.label_axes(upper, r"restitution $\epsilon$", r"$T$ / $T$ of energy balance")
    style.label_axes(lower, r"restitution $\epsilon$", r"fourth cumulant $a_2$", "upper right")
    style.letters(upper, lower)
    return figure
