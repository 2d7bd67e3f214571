"""Figures of the densest random packings."""

from __future__ import annotations

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

from gaspart.rendering import style
from gaspart.rendering.particles import DrawnParticles, colours_of
from gaspart.rendering.pictures import picture
from gaspart.reproduction.claims.table import concise
from gaspart.reproduction.table import Table

DOTS = 300
"""Pixels per inch of the pictures, equal to those in a saved figure."""
NAMES = {
    "centres_to_walls": "inserted,\ncentres up to the walls",
    "wall": "inserted,\ncompletely inside",
    "periodic": "inserted,\nperiodic",
    "compressed": "grown until jammed,\nperiodic",
}


def densest_fill(ds: xr.Dataset) -> Figure:
    """Draw the source's fill (first packing) and the compressed one (last), with densities."""
    figure, axes = style.new((3.4,), (3.4,))
    packings = Table(ds, "packing")
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
        axis.set_title(f"{NAMES[packing.rule]}\nη = {concise(packing.packing_fraction, packing.error)}")
    return figure
