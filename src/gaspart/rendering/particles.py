"""The particles in a picture and their colours."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from gaspart.errors import SceneError
from gaspart.rendering.style import COLOURS

COLOURINGS = ("speed", "species")
FASTEST = 2.0
"""The scale of speeds ends at this many root-mean-square speeds."""


@dataclass(frozen=True)
class DrawnParticles:
    """positions (N, d), radii (N,), species (N,), speeds (N,); lengths (d,) of the container; walls
    (M, 2, d), the ends of the interior ones, of plates those of their sides; periodic, whether each axis is.
    """

    positions: np.ndarray
    radii: np.ndarray
    species: np.ndarray
    speeds: np.ndarray
    lengths: np.ndarray
    walls: np.ndarray
    periodic: tuple[bool, ...] = (False, False, False)

    @property
    def dimension(self) -> int:
        """2 or 3."""
        return self.positions.shape[1]

    @property
    def root_mean_square_speed(self) -> float:
        """Of all particles; 0 if there are none."""
        return float(np.sqrt((self.speeds**2).mean())) if len(self.speeds) else 0.0


def colours_of(
    particles: DrawnParticles, colour: str | np.ndarray, fastest: float | None = None
) -> np.ndarray:
    """(N, 3) red, green and blue from 0 to 1.

    colour: "speed", dark at rest and bright from `fastest` on (without it, from `FASTEST` root-mean-square
    speeds on); "species"; or an array (N, 3). Raises SceneError for anything else.
    """
    if isinstance(colour, str):
        if colour not in COLOURINGS:
            raise SceneError("colour", colour, f"must be one of {', '.join(COLOURINGS)}")
        if colour == "species":
            from matplotlib.colors import to_rgb

            palette = np.array([to_rgb(name) for name in COLOURS])
            return palette[particles.species % len(palette)]
        import matplotlib

        end = FASTEST * particles.root_mean_square_speed if fastest is None else fastest
        return matplotlib.colormaps["viridis"](particles.speeds / (end or 1.0))[:, :3]
    given = np.asarray(colour, dtype=float)
    if given.shape != (len(particles.radii), 3):
        raise SceneError(
            "colour", f"an array of shape {given.shape}", "must have three columns, and a row per particle"
        )
    return given
