"""Rendered pictures of scenes: the gas, and a large sphere in its gas."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np
import xarray as xr

from gaspart import theory
from gaspart.analysis.statistics import means_of
from gaspart.rendering import style
from gaspart.rendering.particles import FASTEST, DrawnParticles, colours_of
from gaspart.rendering.pictures import picture
from gaspart.rendering.style import Axes, Figure
from gaspart.reproduction.claims import Claim, Estimate
from gaspart.reproduction.figure import Parts, runs
from gaspart.reproduction.points.point import Point
from gaspart.reproduction.table import Table, entries
from gaspart.scene.sizes import ball_volume

TITLE, CHAPTER = "Pictures", "Pictures and checks"


def measure(points: list[Point], settings: dict) -> xr.Dataset:
    """Return the last frame of the first replica, and counts over the last frames of all replicas. `resolved`
    is the number of overlaps that the time-stepped engine detected and removed in the step before each frame.
    The mean speed is of the last species, with the standard error over particles.
    """
    point = points[0]
    scene, lengths = point.scene, np.array(point.scene.container.lengths)
    frames, overlaps, collisions = [], 0, 0.0
    for run in runs(point):
        last = run.data[["coordinates", "velocities", "radius", "type"]].isel(frame=-1).load().astype(float)
        positions, radii = last["coordinates"].values, last["radius"].values
        overlaps += overlapping(positions, radii, lengths, scene.container.periodic)
        collisions += run.increments("collisions")[-1] / np.diff(run.time)[-1]
        frames.append(last)
    speeds = [np.sqrt((last["velocities"].values ** 2).sum(axis=1)) for last in frames]
    first, kind = frames[0], frames[0]["type"].values.astype(int)
    of_gas = np.concatenate([frame[kind == len(scene.species) - 1] for frame in speeds])
    step = point.settings["time_step"] if point.settings.get("engine") == "step" else 0.0
    return xr.Dataset(
        {
            "position": (("particle", "axis"), first["coordinates"].values, {"units": "length"}),
            "radius": ("particle", first["radius"].values, {"units": "length"}),
            "species": ("particle", kind),
            "speed": ("particle", speeds[0], {"units": "length/time"}),
            "length": ("axis", lengths, {"units": "length"}),
            "overlaps": float(overlaps),
            "resolved": step * collisions,
            **entries({"mean_speed": means_of(of_gas)}),
            "mean_square_speed": (of_gas**2).mean(),
        },
        attrs={"count": scene.count, "packing_fraction": scene.packing_fraction},
    )


ROUNDING = 1e-5  # largest overlap, in diameters, of frames in single precision


def overlapping(
    positions: np.ndarray, radii: np.ndarray, lengths: np.ndarray, periodic: Sequence[bool]
) -> int:
    """Count the pairs of particles (N, d) that overlap by more than rounding. Particles larger than twice the
    median radius are few. They are compared with all others.
    """
    from scipy.spatial import cKDTree

    box = np.where(periodic, lengths, 0.0)

    def deep(i: np.ndarray, j: np.ndarray) -> int:
        gap = np.abs(positions[i] - positions[j])
        gap = np.where(box > 0.0, np.minimum(gap, np.abs(box - gap)), gap)
        touch = radii[i] + radii[j] - 2.0 * ROUNDING * np.minimum(radii[i], radii[j])
        return int((np.sqrt((gap**2).sum(axis=-1)) < touch).sum())

    is_large = radii > 2.0 * np.median(radii)
    small, large = np.flatnonzero(~is_large), np.flatnonzero(is_large)
    wrapped = np.where(box > 0.0, positions % np.where(box > 0.0, box, 1.0), positions)
    tree = cKDTree(wrapped[small], boxsize=box)
    pairs = tree.query_pairs(2.0 * radii[small].max(), output_type="ndarray")
    number = deep(small[pairs[:, 0]], small[pairs[:, 1]])
    for n, i in enumerate(large):
        others = np.concatenate([small, large[n + 1 :]])
        number += deep(np.full(len(others), i), others)
    return number


def gas_claims(dataset: xr.Dataset) -> Iterator[Claim]:
    """Yield the claims on number, density, overlaps after a step, and mean speed of the gas."""
    spheres = Table(dataset, "particle")
    yield _number(spheres)
    yield Claim.within(
        "packing fraction of the spheres drawn", Estimate(_drawn_fraction(spheres)), 0.001, 0.0005,
        "[source A]: about 0.1 %", "another radius or container than the source's", kind="reproduction",
    )  # fmt: skip
    expected = 2.0 * spheres.resolved**2 / spheres.count
    scatter = math.sqrt(max(expected, 1.0))
    yield Claim(
        "pairs that overlap at the end of a step", Estimate(spheres.overlaps, scatter), expected, scatter,
        f"almost none of the {spheres.resolved:.3g} found: a particle in two contacts (at most, Poisson)",
        "overlaps that a step finds and does not resolve",
    )  # fmt: skip
    yield Claim(
        "mean speed", spheres.mean_speed, theory.mean_speed(3, spheres.mean_square_speed / 3.0),
        0.02 * spheres.mean_speed.value, "Maxwell at the temperature <v^2>/3",
        "speeds that are not Maxwell's",
    )  # fmt: skip


def brownian_claims(dataset: xr.Dataset) -> Iterator[Claim]:
    """Yield the claims that all spheres are drawn in their size, and that none overlap."""
    spheres = Table(dataset, "particle")
    yield _number(spheres)
    yield Claim(
        "pairs that overlap", Estimate(spheres.overlaps), 0.0, 0.0, "hard spheres (exact)",
        "a particle that has entered another", kind="identity",
    )  # fmt: skip
    yield Claim(
        "packing fraction of the spheres drawn", Estimate(_drawn_fraction(spheres), 1e-12),
        spheres.packing_fraction, 1e-9, "the scene's", "a particle that is not drawn, or not in its size",
        kind="identity",
    )  # fmt: skip


def _number(spheres: Table) -> Claim:
    return Claim(
        "spheres drawn", Estimate(len(spheres)), spheres.count, 0.0, "the scene's number of particles",
        "a particle that is lost", kind="identity",
    )  # fmt: skip


def _drawn_fraction(spheres: Table) -> float:
    return float(ball_volume(3) * (spheres.radius**3).sum() / spheres.length.prod())


DOTS = 300  # pixels per inch, as in a saved figure
SHAPE, HIGHEST = 0.75, 4.2  # height of a picture over its width; its maximum in inches


def draw_gas(dataset: xr.Dataset) -> Figure:
    """Draw the gas, coloured by speed."""
    from matplotlib.cm import ScalarMappable
    from matplotlib.colors import Normalize

    spheres = Table(dataset, "particle")
    figure, axis = _draw_picture(spheres, "speed", bar=0.5)
    fastest = FASTEST * float(np.sqrt((spheres.speed**2).mean()))
    scale = ScalarMappable(Normalize(0.0, fastest), cmap="viridis")
    place: dict[str, Any] = {"orientation": "horizontal", "fraction": 0.05, "pad": 0.02, "aspect": 40}
    figure.colorbar(scale, ax=axis, extend="max", **place).set_label("speed / initial speed")
    return figure


def draw_brownian(dataset: xr.Dataset) -> Figure:
    """Draw the large sphere and its gas, coloured by species."""
    return _draw_picture(Table(dataset, "particle"), "species")[0]


def _draw_picture(spheres: Table, colour: str, bar: float = 0.0) -> tuple[Figure, Axes]:
    """Return a figure filled by a picture, above an empty space of height `bar`, in inches."""
    columns = spheres.position, spheres.radius, spheres.species, spheres.speed, spheres.length
    names = "positions", "radii", "species", "speeds", "lengths"
    particles = DrawnParticles(**dict(zip(names, columns, strict=True)), walls=np.zeros((0, 2, 2)))
    height = min(HIGHEST, SHAPE * style.width())
    figure, (axis,) = style.new((height + bar,))
    size = round(DOTS * height / SHAPE), round(DOTS * height)
    axis.imshow(picture(particles, size, colours_of(particles, colour)))
    axis.set_axis_off()
    return figure, axis


FIGURES = {
    "gas_render": Parts({}, measure, gas_claims, draw_gas),
    "brownian_render": Parts({}, measure, brownian_claims, draw_brownian),
}
