"""Densest random packings, by insertion and by growth: packing fractions, and contacts per sphere."""

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
from gaspart.rendering.style import Figure
from gaspart.reproduction.claims import Claim
from gaspart.reproduction.figure import Parts
from gaspart.reproduction.points.point import Point
from gaspart.reproduction.table import Row, Table, table

TITLE, CHAPTER = "Random insertion", "Equation of state and structure"
# Largest gap, in diameters, between two particles of a jammed packing that count as touching. Contacts at the
# reduced pressure 10^6 have gaps of about 10^-6. Few other neighbours are as near as 10^-4.
TOUCH = 1e-4
BACKBONE = 4  # least contacts of a sphere that is held in place; other spheres rattle in their cages


def measure(points: list[Point], settings: dict) -> xr.Dataset:
    """Measure packing fraction and contacts per sphere; keep the first replica for the picture.

    Contacts are those of spheres that do not rattle, NaN for inserted spheres.
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
        "packing_fraction": fraction,
        "error": error,
        "freedom": max(1, fractions.size - 1),
        "contacts": _mean(np.array(touching)),
        "position": positions[0],
        "radius": float(radii[0]),
        "length": length,
    }


def _mean(values: np.ndarray) -> tuple[float, float]:
    error = values.std(ddof=1) / np.sqrt(len(values)) if len(values) > 1 else np.nan
    return float(values.mean()), float(error)


def contacts(positions: np.ndarray, radius: float, lengths: np.ndarray) -> float:
    """Count contacts per sphere in a periodic packing (N, 3), for spheres that do not rattle.

    Each of these spheres has at least four contacts with other such spheres. An isostatic packing has 6 - 6/N
    contacts per sphere.
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
    """Yield claims that growth ends denser than 0.60 with six contacts, and insertion below saturation."""
    for packing in Table(dataset, "packing"):
        fraction = Estimate(packing.packing_fraction, packing.error, packing.freedom)
        if packing.rule == "compressed":
            yield from _jammed(packing, fraction)
            continue
        side = packing.length[0] / (2.0 * packing.radius)
        yield Claim.at_most(
            f"packing fraction of random insertion, {packing.rule.replace('_', ' ')} (L/σ = {side:.3g}), "
            "over saturation",
            fraction / theory.insertion_saturation(3, side, packing.rule), 1.0, 0.02,
            "[Zhang 2013], with the wall excess of fill_failures", "overlaps are accepted",
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
    """Draw the source's fill (first packing) and the compressed packing (last), with densities."""
    figure, axes = style.new((3.4,), (3.4,))
    packings = Table(dataset, "packing")
    for letter, axis, packing in zip("ab", axes, (packings[0], packings[-1]), strict=True):
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


FIGURES = {"densest_fill": Parts({}, measure, claims, draw)}
