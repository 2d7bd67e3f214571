"""Figures of the densest random packings."""

from __future__ import annotations

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

from gaspart.rendering import style
from gaspart.rendering.particles import DrawnParticles, colours_of
from gaspart.rendering.pictures import picture
from gaspart.reproduction.claims.captions import concise

DOTS = 300
"""Pixels per inch of the pictures, as those of a saved figure."""
NAMES = {
    "centres_to_walls": "inserted,\ncentres up to the walls",
    "wall": "inserted,\ncompletely inside",
    "periodic": "inserted,\nperiodic",
    "compressed": "grown until jammed,\nperiodic",
}


def densest_fill(ds: xr.Dataset) -> Figure:
    """The source's fill (first packing) and the compressed one (last), with their packing fractions."""
    figure, axes = style.new((3.4,), (3.4,))
    shown = [0, ds.sizes["packing"] - 1]
    for axis, k in zip(axes, shown, strict=True):
        one = ds.isel(packing=k)
        places = one["position"].values
        places = places[np.isfinite(places).all(axis=1)]
        count = len(places)
        particles = DrawnParticles(
            positions=places,
            radii=np.full(count, float(one["radius"])),
            species=np.zeros(count, dtype=int),
            speeds=np.zeros(count),
            lengths=one["length"].values,
            walls=np.zeros((0, 2, 2)),
        )
        side = round(DOTS * style.PAGE / 3)
        axis.imshow(picture(particles, (side, side), colours_of(particles, "species")))
        axis.set_axis_off()
        fraction, error = float(one["packing_fraction"]), float(one["error"])
        style.letter(axis, f"({'ab'[shown.index(k)]})")
        axis.set_title(f"{NAMES[str(one['rule'].values)]}\nη = {concise(fraction, error)}")
    return figure
