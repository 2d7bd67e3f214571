"""Freezing of discs: pressure and order from both starts, the plateau of coexistence, and structure."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

import numpy as np
import xarray as xr

from gaspart import theory
from gaspart.analysis import bond_order
from gaspart.analysis.estimate import Estimate
from gaspart.analysis.pairs import radial_distribution
from gaspart.analysis.series import plateau
from gaspart.analysis.statistics import average
from gaspart.keys import POSITIVE, count, list_of, positive
from gaspart.rendering import style
from gaspart.rendering.style import Axes, Figure
from gaspart.reproduction.claims import Claim
from gaspart.reproduction.figure import Parts, runs
from gaspart.reproduction.figures._freezing import (
    EQUILIBRIUM_LIMIT,
    LOOKS,
    TOLERANCE,
    draw_ends,
    draw_order,
    draw_points,
    extreme,
    measure_state,
    measure_states,
    of_start,
    starts,
    with_drift,
)
from gaspart.reproduction.points.point import Point
from gaspart.reproduction.table import Row, Table, table
from gaspart.theory.packing import CRYSTAL_OF_1024_DISCS

TITLE, CHAPTER = "Freezing and melting", "Equation of state and structure"
SETTINGS = {
    "shown": list_of(POSITIVE, "packing fractions whose structure is kept"),
    "furthest": positive("largest distance of g(r), in diameters"),
    "bins": count("bins of g(r)"),
    "highest": positive("largest wave number of S(k), times the diameter"),
}
COMPARED = 870  # discs with published pressures; such points are compared, and not drawn


def measure(points: list[Point], settings: dict) -> xr.Dataset:
    """Measure P and psi_6 of discs against packing fraction from both starts, plateau, and structure.
    `compared_pressure` is that of `COMPARED` discs, if there are such points. Structure is that of the last
    start.
    """
    compared = [point for point in points if point.scene.count == COMPARED]
    points = [point for point in points if point not in compared]
    dataset = measure_states(points, _disc)
    unlike = dataset["pressure"].max("start") - dataset["pressure"].min("start")
    sides = list(Table(dataset.assign(unlike=unlike), "start"))
    parts = [table("start", sides, _plateau), _pictures(of_start(points, sides[-1].start), settings)]
    if compared:
        names = [f"pressure{drift}{part}" for drift in ("", "_drift") for part in ("", "_error", "_freedom")]
        new = {name: f"compared_{name}" for name in (*names, "packing_fraction")}
        parts.append(measure_states(compared, _disc)[names].rename(new))
    return xr.merge([dataset, *parts], join="outer", compat="no_conflicts")


def _disc(point: Point) -> dict[str, Any]:
    return measure_state(point, lambda frame, lengths: abs(bond_order.hexatic(frame, lengths).mean()))


def _plateau(side: Row) -> dict[str, Any]:
    """Compute the plateau of one start. The uncertainty of a point includes half of its drift, and half of
    the difference between the starts, `unlike`. A run out of equilibrium is therefore uncertain.
    """
    own = Table(side.dataset, "packing_fraction")
    own = own[np.isfinite(own.pressure.value)]
    parts = own.pressure.error, 0.5 * own.pressure_drift.value, 0.5 * own.unlike
    error = np.sqrt(sum(part**2 for part in parts))
    pressure, uncertainty, (large, small) = plateau(1.0 / own.density, own.pressure.value, error)
    low, high = (np.pi / 4.0 / area for area in (large, small))
    return {"plateau": (pressure, uncertainty), "plateau_low": low, "plateau_high": high}


def _pictures(chosen: dict[float, Point], settings: dict) -> xr.Dataset:
    fractions = [x for x in chosen if any(abs(x - y) < 1e-6 for y in settings["shown"])]
    rows = [_picture(chosen[x], settings) for x in fractions]
    # The wave vectors depend on the container, which shrinks with the packing fraction. They are stored by
    # index.
    most_x, most_y = (min(row[name].size for row in rows) // 2 for name in ("wave_x", "wave_y"))
    for row in rows:
        row["wave_x"], row["wave_y"] = _middle(row["wave_x"], most_x), _middle(row["wave_y"], most_y)
        row["structure_factor"] = _middle(row["structure_factor"], most_x, most_y)
    inner = {
        **dict.fromkeys(("x", "y", "angle"), ("particle",)),
        "g": ("distance",),
        "wave_x": ("mode_x",),
        "wave_y": ("mode_y",),
        "structure_factor": ("mode_x", "mode_y"),
    }
    distances = [row.pop("distance") for row in rows]
    return table("shown", rows, dict, inner=inner).assign_coords(shown=fractions, distance=distances[0])


def _picture(point: Point, settings: dict) -> dict[str, Any]:
    """Return the last frame, g(r) and S(k) of the first replica; lengths are in diameters."""
    replicas = runs(point)  # the file is open during this block
    run = next(replicas)
    diameter = 2.0 * run.scene.largest_radius
    lengths = np.array(run.scene.container.lengths) / diameter
    frames = run.data["coordinates"].values[1:] / diameter
    row = {"x": frames[-1][:, 0], "y": frames[-1][:, 1]}
    row["angle"] = np.angle(bond_order.hexatic(frames[-1], lengths))
    row["distance"], row["g"] = radial_distribution(frames, lengths, settings["bins"], settings["furthest"])
    waves = bond_order.structure_factor(frames, lengths, settings["highest"])
    return row | dict(zip(("wave_x", "wave_y", "structure_factor"), waves, strict=True))


def _middle(values: np.ndarray, *most: int) -> np.ndarray:
    """Return the middle elements along each axis, equally many on both sides."""
    sizes = zip(values.shape, most, strict=True)
    return values[tuple(slice(size // 2 - n, size // 2 + n + 1) for size, n in sizes)]


DIFFERENCES = 6
"""Number of deviations at a packing fraction, of which the largest is used. They compare pressure and order,
between the starts and between the halves of each run."""
REQUIRED = {True: 2e-4, False: 4e-4}
"""Required relative uncertainty of the pressure of 870 discs, below NEAR and above it. It is reached in four
minutes of CPU time. Published values have 4e-6 to 2e-5. The correlation time of the order at 0.70 is six
times that at 0.68."""
NEAR = 0.69


def claims(dataset: xr.Dataset) -> Iterator[Claim]:
    """Yield claims on plateaus of both starts, melting and freezing, both branches, and equilibrium."""
    sides, own = Table(dataset, "start"), Table(dataset, "packing_fraction")
    expected = theory.COEXISTENCE_PRESSURE[2]
    for side in sides:
        yield Claim.within(
            f"plateau pressure of discs in k_B T / sigma^2, from the {side.start}",
            side.plateau, expected, TOLERANCE * expected, "[Bernard 2011], [Engel 2013]",
            "runs not in equilibrium, a loop too coarse, or far too few discs (the pressure falls with 1/N)",
            no_verdict="the literature's is that of 10^6 discs, and how much fewer discs shift it is not "
            "known",
        )  # fmt: skip
    if len(sides) == 2:
        yield Claim(
            "plateau pressure from the crystal minus that from the fluid, k_B T / sigma^2",
            sides.plateau[0] - sides.plateau[1], 0.0, TOLERANCE * expected / 2.0,
            "one equation of state, whatever the start", "one of the runs still depends on its start",
        )  # fmt: skip
    yield _orientation(own[0], melted=True)
    yield _orientation(own[-1], melted=False)
    yield from _liquid(Table(dataset, "compared_packing_fraction"))
    yield from _crystal(own)
    yield _equilibrium(own)


def _orientation(state: Row, melted: bool) -> Claim:
    make, bound = (Claim.at_most, 0.3) if melted else (Claim.at_least, 0.6)
    return make(
        f"global |psi_6| at packing fraction {state.packing_fraction:.4g}, "
        f"of the start that is {'most' if melted else 'least'} ordered",
        extreme(state.order, melted), bound, 0.1,
        "liquid below 0.700, one orientation throughout above 0.720 ([Bernard 2011])",
        "the crystal has not melted" if melted else "the fluid has not frozen, or into several grains",
    )  # fmt: skip


def _liquid(states: Table) -> Iterator[Claim]:
    """Yield claims on pressures of liquid discs, for the published number in the published container. The
    virial series is too inaccurate here.
    """
    published = theory.literature("pressure", 2)
    references = {row.packing_fraction: row for row in published[published.container == "29 x 30"]}
    for state in states:
        eta = round(state.compared_packing_fraction, 9)
        if eta not in references:
            continue
        expected = Estimate(float(references[eta].value), float(references[eta].error))
        sides = zip(state.compared_pressure, state.compared_pressure_drift, strict=True)
        yield Claim(
            f"pressure of 870 discs at packing fraction {eta:g}, k_B T / sigma^2",
            average([with_drift(pressure, drift) for pressure, drift in sides]), expected,
            REQUIRED[eta < NEAR] * expected.value,
            "[Li 2022], event-chain programs, the same container",
            "contacts are missed or counted twice, or runs are shorter than their memory",
            allowance_source="its statement",
        )  # fmt: skip


def _crystal(states: Table) -> Iterator[Claim]:
    """Yield claims on the pressure of crystals of the published number, as certain as the literature."""
    eta, expected, allowance = CRYSTAL_OF_1024_DISCS
    for state in states[(np.abs(states.packing_fraction - eta) < 1e-4) & (states.count == 1024)]:
        yield Claim(
            f"pressure of the crystal of 1024 discs at packing fraction {eta:g}, k_B T / sigma^2",
            with_drift(state.pressure[0], state.pressure_drift[0]), Estimate(expected, allowance), allowance,
            "[Zollweg 1992], figure 1",
            "contacts are missed, a crystal is strained, or the other phase remains or grows",
            allowance_source="its statement",
        )  # fmt: skip


def _equilibrium(states: Table) -> Claim:
    """Return the claim on the number of differences that agree with equilibrium. The probability is an exact
    binomial one. A fluid that is compressed beyond the melting point of the ordered phase freezes with
    defects. They do not heal in any such run.
    """
    from scipy.special import bdtrc, ndtri

    melting = theory.coexistence_packing_fractions(2)[1]
    differences = states[states.packing_fraction <= melting].disagreement
    number = differences.size
    outliers = int((differences > EQUILIBRIUM_LIMIT).sum())
    chance = 1.0 - (1.0 - math.erfc(EQUILIBRIUM_LIMIT / math.sqrt(2.0))) ** DIFFERENCES
    deviation = float(-ndtri(bdtrc(outliers - 1, number, chance)))
    return Claim(
        f"packing fractions of {number} up to {melting:.3g} whose starts or halves differ by more "
        f"than {EQUILIBRIUM_LIMIT:g} standard errors",
        Estimate(outliers), number * chance, 0.0,
        "equilibrium does not depend on the start; some differ by chance (binomial)",
        "runs too short to become independent of their start",
        exact_deviation=max(deviation, 0.0),
    )  # fmt: skip


# Published values: number of discs, source, container and line style.
PUBLISHED = (
    (870, "Li 2022", "29 x 30", ":"),
    (65536, "Engel 2013", "square", "--"),
    (1048576, "Engel 2013", "square", "-"),
)


def draw(dataset: xr.Dataset) -> Figure:
    """Draw pressure with the plateau, psi_6, g(r), and three snapshots with structure factors."""
    pictures = Table(dataset, "shown")
    figure, (loop, order, shells, below) = style.new((2.4, 1.5), (2.0,), (1.65 * len(pictures),))
    sides = starts(dataset)
    _loop(loop, Table(dataset, "packing_fraction"), sides)
    draw_order(order, sides, 2)
    style.label_axes(order, y=r"$|\langle\psi_6\rangle|$", ylim=(0.0, 1.0))
    pairs = style.split(below, len(pictures), 2)
    for k, (picture, (snapshot, scattering)) in enumerate(zip(pictures, pairs, strict=True)):
        label = f"{picture.shown:.3g}"
        shells.plot(picture.distance, picture.g + 2.0 * k, color=style.COLOURS[k], label=label)
        _snapshot(snapshot, picture, label)
        _scattering(scattering, picture)
    end = pictures.distance.max()
    style.label_axes(shells, r"distance $r/\sigma$", "$g(r)$, shifted by 2", xlim=(0.0, end))
    shells.legend(ncols=len(pictures), loc="upper right", title=r"$\eta$")
    style.letters(loop, order, shells, pairs[0, 0])
    return figure


def _loop(axis: Axes, states: Table, sides: dict[str, Table]) -> None:
    expected, eta = theory.COEXISTENCE_PRESSURE[2], states.packing_fraction
    style.band(axis, 0.98 * expected, 1.02 * expected)
    style.level(axis, expected)
    draw_ends(axis, 2)
    fluid = np.linspace(eta.min(), 0.70, 100)
    crystal = np.linspace(theory.LOWEST_CRYSTAL[2], eta.max(), 100)
    for at, z, label, dashes in (
        (fluid, theory.compressibility_factor(fluid, 2), "virial series", "--"),
        (crystal, theory.alder_hoover_young_crystal(crystal, 2), "crystal (AHY)", "-."),
    ):
        axis.plot(at, at / (np.pi / 4.0) * z, color=style.GREY, linestyle=dashes, label=label)
    for start, side in sides.items():
        draw_points(axis, side, side.pressure, LOOKS[start], f"from the {start}")
        if np.isfinite(side.plateau.value):
            ends, level = [side.plateau_low, side.plateau_high], [side.plateau.value] * 2
            axis.plot(ends, level, color=style.COLOURS[LOOKS[start]], linewidth=0.8)
    known = theory.literature("pressure", 2)
    for number, source, container, dashes in PUBLISHED:
        same = (known.source == source) & (known.container == container) & (known["count"] == number)
        rows, label = known[same], f"{number:,} discs".replace(",", " ")
        axis.plot(rows.packing_fraction, rows.value, color="black", lw=0.8, linestyle=dashes, label=label)
    low, high = np.nanmin(states.pressure.value), np.nanmax(states.pressure.value)
    axis.set_ylim(low - 0.1 * (high - low), high + 0.25 * (high - low))
    style.label_axes(axis, y="pressure $P\\sigma^2/k_\\mathrm{B}T$", legend="lower right")


def _snapshot(axis: Axes, picture: Row, label: str) -> None:
    """Draw discs coloured by the orientation of their bonds, with a period of 60 degrees."""
    from matplotlib.collections import EllipseCollection

    x, y = picture.x, picture.y
    discs = EllipseCollection(
        1.0, 1.0, 0.0, units="x", offsets=np.stack([x, y], axis=1), offset_transform=axis.transData,
        array=np.mod(picture.angle / np.pi + 0.5, 2.0), cmap="twilight", linewidths=0,
    )  # fmt: skip
    discs.set_clim(0.0, 2.0)
    axis.add_collection(discs)
    axis.set(xlim=(x.min(), x.max()), ylim=(y.min(), y.max()), aspect="equal", xticks=[], yticks=[])
    axis.set_title(f"$\\eta={label}$", pad=2)


def _scattering(axis: Axes, picture: Row) -> None:
    """Draw S(k) in grey levels, black where it is large."""
    from matplotlib.colors import LogNorm

    waves, factor, norm = (picture.wave_x, picture.wave_y), picture.structure_factor.T, LogNorm(0.1, 100.0)
    image = axis.pcolormesh(*waves, factor, cmap="Greys", norm=norm, rasterized=True)
    image.set_edgecolor("face")
    axis.set(aspect="equal", xlabel="$k_x\\sigma$", xticks=[-10, 0, 10], yticks=[-10, 0, 10])


FIGURES = {"freezing_discs": Parts(SETTINGS, measure, claims, draw)}
