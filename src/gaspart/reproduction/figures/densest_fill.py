"""Densest random packings, by insertion and by growth: packing fractions, contacts, and bounds."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
import xarray as xr

from gaspart import theory
from gaspart.analysis.estimate import Estimate, concise
from gaspart.rendering import style
from gaspart.rendering.particles import DrawnParticles, colours_of
from gaspart.rendering.pictures import picture
from gaspart.rendering.style import Axes, Figure
from gaspart.reproduction.claims import Claim
from gaspart.reproduction.figure import Parts
from gaspart.reproduction.jobs.pack import GROWTH
from gaspart.reproduction.points.point import Point
from gaspart.reproduction.table import Row, Table, table
from gaspart.scene.sizes import CLOSE_PACKING

TITLE, CHAPTER = "Random insertion", "Equation of state and structure"
# Largest gap, in diameters, between two particles of a jammed packing that count as touching. Contacts at the
# reduced pressure 10^6 have gaps of about 10^-6. Few other neighbours are as near as 10^-4.
TOUCH = 1e-4
RANDOM_CLOSE = 0.634  # largest packing fraction of random packings in the mean-field theory of [Song 2008]
SLOW = GROWTH / 32.0  # growth rate from which on spheres are expected to order
BACKBONE = 4  # least contacts of a sphere that is held in place; other spheres rattle in their cages


def measure(points: list[Point], settings: dict) -> xr.Dataset:
    """Measure packing fraction and contacts per sphere; keep the first replica for the picture. Contacts are
    those of spheres that do not rattle, NaN for inserted spheres.
    """
    inner = {"position": ("particle", "axis"), "length": ("axis",)}
    units = dict.fromkeys(("position", "radius", "length"), "length")
    return table("packing", points, _packing, inner=inner, units=units)


def _packing(point: Point) -> dict[str, Any]:
    dataset = xr.load_dataset(point.path)
    names = "packing_fraction", "position", "radius", "length"
    fractions, positions, radii, length = (dataset[name].values for name in names)
    rule = "centres_to_walls" if point.settings.get("centres_to_walls") else point.settings["boundary"]
    touching = [np.nan]
    if point.settings.get("arrangement") == "compressed":
        rule = "compressed"
        touching = [contacts(*packing, length) for packing in zip(positions, radii, strict=True)]
    fraction, error = _mean(fractions)
    return {
        "rule": rule,
        "growth": point.settings.get("growth_rate", GROWTH) if rule == "compressed" else np.nan,
        "packing_fraction": fraction,
        "error": error,
        "freedom": max(1, fractions.size - 1),
        "densest": float(fractions.max()),
        "replicas": fractions.size,
        "contacts": _mean(np.array(touching)),
        "position": positions[0],
        "radius": float(radii[0]),
        "length": length,
    }


def _mean(values: np.ndarray) -> tuple[float, float]:
    error = values.std(ddof=1) / np.sqrt(len(values)) if len(values) > 1 else np.nan
    return float(values.mean()), float(error)


def contacts(positions: np.ndarray, radius: float, lengths: np.ndarray) -> float:
    """Count contacts per sphere in a periodic packing (N, 3), for spheres that do not rattle. Each of these
    spheres has at least four contacts with other such spheres. An isostatic packing has 6 - 6/N contacts per
    sphere.
    """
    from scipy.spatial import cKDTree

    tree = cKDTree(positions % lengths, boxsize=lengths)
    pairs = tree.query_pairs(2.0 * radius * (1.0 + TOUCH), output_type="ndarray")
    held = np.ones(len(positions), dtype=bool)
    while True:
        pairs = pairs[held[pairs].all(axis=1)]
        degree = np.bincount(pairs.ravel(), minlength=len(positions))
        loose = held & (degree < BACKBONE)
        if not loose.any():
            return 2.0 * len(pairs) / max(1, int(held.sum()))
        held &= ~loose


def claims(dataset: xr.Dataset) -> Iterator[Claim]:
    """Yield claims on growth, fast and slow, and that insertion ends below saturation."""
    for packing in Table(dataset, "packing"):
        fraction = Estimate(packing.packing_fraction, packing.error, packing.freedom)
        if packing.rule == "compressed":
            yield from _grown(packing, fraction)
            continue
        side = packing.length[0] / (2.0 * packing.radius)
        yield Claim.at_most(
            f"packing fraction of random insertion, {packing.rule.replace('_', ' ')} (L/σ = {side:.3g}), "
            "over saturation",
            fraction / theory.insertion_saturation(3, side, packing.rule), 1.0, 0.02,
            "[Zhang 2013], with the wall excess of fill_failures", "overlaps are accepted",
        )  # fmt: skip


def _grown(packing: Row, fraction: Estimate) -> Iterator[Claim]:
    if packing.growth == GROWTH:
        yield from _jammed(packing, fraction)
    elif packing.growth <= SLOW:
        yield Claim.at_least(
            f"packing fraction of the densest of {packing.replicas} packings of spheres grown "
            f"{GROWTH / packing.growth:g} times more slowly, over {RANDOM_CLOSE:g}",
            Estimate(packing.densest / RANDOM_CLOSE), 1.02, 0.01,
            "[Lubachevsky 1990]: spheres that grow slowly order",
            "[Song 2008]'s bound for random packings holds however slowly spheres grow",
        )  # fmt: skip


def _jammed(packing: Row, fraction: Estimate) -> Iterator[Claim]:
    yield Claim.at_least(
        "packing fraction of spheres grown until they jam", fraction, 0.60, 5e-3,
        "[Lubachevsky 1990]: random packings end at 0.60 to 0.65",
        "contacts of growing spheres are wrong, or growth stops before they jam",
    )  # fmt: skip
    yield Claim.within(
        "contacts per sphere that does not rattle, in a jammed packing",
        Estimate(packing.contacts.value, packing.contacts.error, packing.freedom), 6.0, 0.5,
        "[Donev 2005]: isostatic, 2d contacts",
        "growth is too fast to find all contacts, or spheres crystallise",
        no_verdict="how many contacts a growth of finite speed leaves open, and how many gaps count as "
        "contacts, is not known to less than the band",
    )  # fmt: skip


DOTS = 300  # pixels per inch, as in a saved figure
CAPTIONS = {
    "centres_to_walls": "inserted,\ncentres up to the walls",
    "wall": "inserted,\ncompletely inside",
    "periodic": "inserted,\nperiodic",
    "compressed": "grown until jammed,\nperiodic",
}


def draw(dataset: xr.Dataset) -> Figure:
    """Draw the source's fill and a jammed packing, and packing fractions beside their bounds."""
    figure, axes = style.new((3.4,), (3.4,), (2.4,))
    packings = Table(dataset, "packing")
    grown = packings[packings.rule == "compressed"]
    _draw_bounds(axes.pop(), packings, grown)
    for letter, axis, packing in zip("ab", axes, (packings[0], grown[0]), strict=True):
        positions = packing.position[np.isfinite(packing.position).all(axis=1)]
        count = len(positions)
        particles = DrawnParticles(
            positions=positions,
            radii=np.full(count, packing.radius),
            species=np.zeros(count, dtype=int),
            speeds=np.zeros(count),
            lengths=packing.length,
            walls=np.zeros((0, 2, 2)),
        )
        side = round(DOTS * style.PAGE / 3)
        axis.imshow(picture(particles, (side, side), colours_of(particles, "species")))
        axis.set_axis_off()
        style.letter(axis, f"({letter})")
        axis.set_title(f"{CAPTIONS[packing.rule]}\nη = {concise(packing.packing_fraction, packing.error)}")
    return figure


def _draw_bounds(axis: Axes, packings: Table, grown: Table) -> None:
    """Draw packing fraction against growth rate, and the bounds that source A cites."""
    for value, dashes, label in (
        (CLOSE_PACKING[3], "-", "densest, 74 % (Hales)"),
        (RANDOM_CLOSE, "--", "random close, 63 % (Song)"),
    ):
        style.level(axis, value, ls=dashes, label=label)
    fractions = Estimate(grown.packing_fraction, grown.error)
    style.points(axis, grown.growth, fractions, label="grown until jammed")
    axis.plot(grown.growth, grown.densest, "_", color=style.COLOURS[0], label="densest of these")
    for inserted in packings.packing_fraction[packings.rule == "periodic"]:
        style.level(axis, inserted, ls=":", label="inserted, periodic")
    axis.set(xscale="log", xlim=(0.5 * SLOW, 2.0 * GROWTH))
    labels = "growth rate of the diameter / thermal speed", r"packing fraction $\eta$"
    style.label_axes(axis, *labels, ylim=(0.3, 0.8))
    axis.legend(loc="center right")
    style.letter(axis, "(c)")


FIGURES = {"densest_fill": Parts({}, measure, claims, draw, key=2)}
