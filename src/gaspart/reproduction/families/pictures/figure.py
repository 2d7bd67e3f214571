"""Rendered pictures of scenes."""

from __future__ import annotations

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from gaspart.rendering import style
from gaspart.rendering.particles import FASTEST, DrawnParticles, colours_of
from gaspart.rendering.pictures import picture
from gaspart.reproduction.table import Table

DOTS = 300
"""Resolution of the pictures in pixels per inch, the same as in a saved figure."""
HEIGHT = 0.75
"""Height of a picture divided by its width."""
HIGHEST = 4.2
"""Maximum height of a picture, in inches."""


def gas_render(dataset: xr.Dataset) -> Figure:
    """Draw the gas, coloured by speed."""
    from matplotlib.cm import ScalarMappable
    from matplotlib.colors import Normalize

    spheres = Table(dataset, "particle")
    figure, axis = _draw_picture(spheres, "speed", bar=0.5)
    fastest = FASTEST * float(np.sqrt((spheres.speed**2).mean()))
    scale = ScalarMappable(Normalize(0.0, fastest), cmap="viridis")
    bar = figure.colorbar(
        scale, ax=axis, orientation="horizontal", fraction=0.05, pad=0.02, aspect=40, extend="max"
    )
    bar.set_label("speed / initial speed")
    return figure


def brownian_render(dataset: xr.Dataset) -> Figure:
    """Draw the large sphere and its gas, coloured by species."""
    return _draw_picture(Table(dataset, "particle"), "species")[0]


def _draw_picture(spheres: Table, colour: str, bar: float = 0.0) -> tuple[Figure, Axes]:
    """Return a figure filled by a picture of the spheres.

    `bar` is the height, in inches, of the empty space below the picture.
    """
    particles = DrawnParticles(
        positions=spheres.position,
        radii=spheres.radius,
        species=spheres.species,
        speeds=spheres.speed,
        lengths=spheres.length,
        walls=np.zeros((0, 2, 2)),
    )
    height = min(HIGHEST, HEIGHT * style.width())
    size = (round(DOTS * height / HEIGHT), round(DOTS * height))
    figure, (axis,) = style.new((height + bar,))
    axis.imshow(picture(particles, size, colours_of(particles, colour)))
    axis.set_axis_off()
    return figure, axis
