"""Inelastic gases that cool: Haff's law, its rate and exponent, and clusters that end it in a dense gas.

Time is in collisions per particle, s = 2 N_coll / N; temperatures are in units of the initial one.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
import xarray as xr

from gaspart import theory
from gaspart.analysis.flow import Grid
from gaspart.analysis.run import Run
from gaspart.analysis.statistics import mean_of, means_of
from gaspart.keys import count, names
from gaspart.rendering import style
from gaspart.rendering.style import Axes, Figure
from gaspart.reproduction.claims import Claim, Estimate
from gaspart.reproduction.figure import PARTICLES, Parts, runs
from gaspart.reproduction.figures.equipartition import law, read
from gaspart.reproduction.points.point import Point
from gaspart.reproduction.table import Table, table
from gaspart.theory.granular import cooling_rate_finite_size_factor
from gaspart.trajectory.reading import open_trajectory

TITLE, CHAPTER = "Granular gases", "Granular matter"
SETTINGS = {
    "clustering": names("the experiments of dense and large gases, which leave Haff's law"),
    "cells_per_side": count("cells per side in which their particles are counted"),
}
RELAXED = 3.0  # collisions per particle after which a gas has its own velocity distribution, not Maxwell's


def measure(points: list[Point], settings: dict) -> xr.Dataset:
    """Measure dilute gases (`gas`), dense ones (`clusters`), and the discs of the most inelastic one."""
    apart = [point for point in points if point.experiment in settings["clustering"]]
    dilute = [point for point in points if point not in apart]
    gases = table("gas", dilute, _gas, inner=("frame",), units={})
    clusters = table("clusters", apart, _clusters, settings["cells_per_side"], inner=("step",), units={})
    parts = [gases, clusters, _picture(min(apart, key=lambda point: law(point).normal))]
    return xr.merge(parts, join="outer", compat="no_conflicts", combine_attrs="drop_conflicts")


def _gas(point: Point) -> dict[str, Any]:
    scene, replicas = point.scene, read(point)
    restitution, dimension, kind = law(point).normal, scene.dimension, scene.species[0]
    rates, exponents, times = [], [], []
    for run in replicas:
        frequency = theory.collision_rate(
            scene.packing_fraction, dimension, 2.0 * kind.radius, run.start, kind.mass
        )
        times.append(run.time / theory.haff_time(restitution, dimension, float(frequency)))
        late = np.flatnonzero(run.collisions >= RELAXED)
        first, logarithm = late[0], np.log(run.translation)
        rates.append((logarithm[first] - logarithm[-1]) / (run.collisions[-1] - run.collisions[first]))
        exponents.append(np.polyfit(np.log1p(times[-1][late]), logarithm[late], 1)[0])
    return {
        "dimension": dimension,
        "count": scene.count,
        "restitution": restitution,
        "collisions": np.mean([run.collisions for run in replicas], axis=0),
        "time": np.mean(times, axis=0),  # in Haff's t_H
        "temperature": means_of([run.translation for run in replicas]),
        "rate": mean_of(rates),
        "exponent": mean_of(exponents),
    }


def _clusters(point: Point, cells: int) -> dict[str, Any]:
    replicas, restitution = read(point), law(point).normal
    rate = theory.cooling_rate(restitution, point.scene.dimension)
    # Logarithms are averaged: after so many collisions, replicas differ by large factors.
    excess, relative = means_of([np.log(run.translation) + rate * run.collisions for run in replicas])
    return {
        "cluster_restitution": restitution,
        "cluster_collisions": np.mean([run.collisions for run in replicas], axis=0),
        "cluster_excess": (np.exp(excess), np.exp(excess) * relative),
        "variance": means_of([number_variance(run, cells) for run in runs(point)]),
    }


def number_variance(run: Run, cells: int) -> np.ndarray:
    """Compute the variance (T,) of the particle number in a cell over its mean; 1 if all are independent."""
    lengths = run.scene.container.lengths
    grid = Grid((0.0,) * len(lengths), lengths, (cells,) * len(lengths))
    # In single precision, a particle close to the upper boundary may lie on the boundary itself.
    where = grid.cells(run.positions, inside=True)
    counts = grid.sums(where, blocks=np.arange(len(where))).reshape(len(where), grid.size)
    return counts.var(axis=1) / counts.mean(axis=1)


def _picture(point: Point) -> xr.Dataset:
    with open_trajectory(point.replica_path(0)) as trajectory:
        positions = trajectory["coordinates"][-1].values
    units = {"units": "scene length"}
    return xr.Dataset(
        {"x": ("particle", positions[:, 0], units), "y": ("particle", positions[:, 1], units)},
        attrs={"side": point.scene.container.lengths[0], "radius": point.scene.largest_radius},
    )


VAN_NOIJE = "[Haff 1983]; [van Noije 1998], to first order in a2"


def claims(dataset: xr.Dataset) -> Iterator[Claim]:
    """Yield the claims on rate and exponent of Haff's law, and on clusters that end it."""
    for gas in Table(dataset, "gas"):
        dimension, e = gas.dimension, gas.restitution
        which = f"{PARTICLES[dimension]}, restitution {e:g}"
        finite = float(cooling_rate_finite_size_factor(gas.count, dimension))
        yield Claim(
            f"-d ln T / ds over (1 - e^2)/d (1 + a2/4), {which}",
            gas.rate / theory.cooling_rate(e, dimension), finite, 0.005,
            f"{VAN_NOIJE}; times d N/(d N - d + 1), at one energy and total momentum zero (exact)",
            "contacts that dissipate too much or too little, as without a2",
            alternative=finite / (1.0 + 0.25 * float(theory.fourth_cumulant(e, dimension))),
        )  # fmt: skip
        yield Claim(
            f"exponent of T against 1 + t/t_H, {which}", gas.exponent, -2.0, 0.02, VAN_NOIJE,
            "a gas that does not stay homogeneous, or collisions that do not slow down as sqrt(T)",
        )  # fmt: skip
    gases = Table(dataset, "clusters")
    usual = elastic_variance(gases)
    for gas in gases[gases.cluster_restitution != 1.0]:
        end = f"in the end, restitution {gas.cluster_restitution:g}"
        yield _growth(
            f"variance of the number in a cell over the elastic gas's, {end}", gas.variance[-1] / usual, 3.0,
            "[Goldhirsch 1993]: a large inelastic gas forms clusters", "a gas that stays homogeneous",
        )  # fmt: skip
        yield _growth(
            f"T over Haff's law, {end}", gas.cluster_excess[-1], 2.0,
            "vortices and clusters hold energy that contacts do not reach (same source)",
            "a gas that continues to cool by Haff's law",
        )  # fmt: skip


def elastic_variance(gases: Table) -> float:
    """Compute the variance of the particle number in a cell of an elastic gas in equilibrium."""
    elastic = gases[gases.cluster_restitution == 1.0]
    return float(np.nanmean(elastic.variance.value[:, 1:]))


def _growth(subject: str, ratio: Estimate, least: float, source: str, fails_if: str) -> Claim:
    """Return the claim that ln of a ratio, 0 for an unchanged gas, is at least ln(`least`)."""
    logarithm, bound = Estimate(np.log(ratio.value), ratio.error / ratio.value), np.log(least)
    # distinguishes an unchanged gas with 3 sigma
    return Claim.at_least(f"ln of {subject}", logarithm, bound, bound / 3.0, source, fails_if)


def draw(dataset: xr.Dataset) -> Figure:
    """Draw Haff's law, its rate, deviations of a large gas, and the final state."""
    figure, axes = style.new((2.6,), (2.4,), (2.4,), (2.8,))
    gases, clusters = Table(dataset, "gas"), Table(dataset, "clusters")
    _haff(axes[0], gases)
    _rates(axes[1], gases)
    _leaving(axes[2], clusters)
    _discs(axes[3], Table(dataset, "particle"))
    style.letters(*axes[:3])
    last = clusters[np.argmin(clusters.cluster_restitution)]
    e, s = last.cluster_restitution, last.cluster_collisions[-1]
    style.letter(axes[3], rf"(d) $\epsilon={e:g}$, $s={s:.0f}$")
    return figure


def _haff(axis: Axes, gases: Table) -> None:
    """Draw T over Haff's law T_0 / (1 + t / t_H)^2."""
    style.level(axis, 1.0)
    for dimension in (2, 3):
        own = gases[gases.dimension == dimension].sorted_by("restitution")[::-1]
        for kind, gas in enumerate(own):
            since, is_hollow = 1.0 + gas.time, dimension == 3
            label = rf"{PARTICLES[dimension]}, $\epsilon={gas.restitution:g}$"
            style.points(
                axis, since, gas.temperature * since**2, kind=kind, hollow=is_hollow, label=label
            )  # fmt: skip
    x, y = r"$1+t/t_\mathrm{H}$", r"$T/T_\mathrm{Haff}$"
    style.label_axes(axis, x, y, legend="lower left", columns=2, xscale="log")


def _rates(axis: Axes, gases: Table) -> None:
    """Draw -d ln T / ds over (1 - e^2)/d: 1 for Maxwell's distribution, 1 + a2/4 for the cooling gas."""
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
    """Draw T over Haff's law, and the number variance over the elastic gas's, against (1 - e^2) s."""
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


def _discs(axis: Axes, particles: Table) -> None:
    """Draw the discs at the end of a run, to scale."""
    from matplotlib.collections import EllipseCollection

    side, centres = particles.side, np.stack([particles.x, particles.y], axis=1)
    size = np.full(len(centres), 2.0 * particles.radius)
    discs = EllipseCollection(
        size, size, np.zeros(len(centres)), units="x", offsets=centres, transOffset=axis.transData,
        facecolor=style.REFERENCE, linewidth=0,
    )  # fmt: skip
    axis.add_collection(discs)
    axis.set_aspect("equal")
    style.label_axes(axis, r"$x/\sigma$", r"$y/\sigma$", xlim=(0.0, side), ylim=(0.0, side))


FIGURES = {"cooling": Parts(SETTINGS, measure, claims, draw, key=3)}
