"""The particles in a picture and their colours."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from gaspart.errors import SceneError
from gaspart.rendering.style import COLOURS
from gaspart.rendering.surfaces import DrawnSurface

COLOURINGS = ("speed", "species")
FASTEST = 2.0
"""The scale of speeds ends at this many root-mean-square speeds."""
FIXED = (0.62, 0.62, 0.62)
"""The colour of fixed particles among those that are coloured by speed."""


@dataclass(frozen=True)
class DrawnParticles:
    """positions (N, d), radii (N,), species (N,), speeds (N,); lengths (d,) of the container; walls
    (M, 2, d), the ends of the interior ones, of plates those of their sides; periodic, whether each axis is;
    masses (N,), if they are known; fixed (N,), whether each never moves, None if it is not known; parameters:
    short texts on the scene; surfaces: faces and walls with a look of their own.
    """

    positions: np.ndarray
    radii: np.ndarray
    species: np.ndarray
    speeds: np.ndarray
    lengths: np.ndarray
    walls: np.ndarray
    periodic: tuple[bool, ...] = (False, False, False)
    masses: np.ndarray | None = None
    fixed: np.ndarray | None = None
    parameters: tuple[str, ...] = ()
    surfaces: tuple[DrawnSurface, ...] = ()

    @property
    def dimension(self) -> int:
        """2 or 3."""
        return self.positions.shape[1]

    @property
    def reach(self) -> float:
        """How far particles may reach out of the container: the radius of the largest that does."""
        places, radii = self.positions, self.radii[:, None]
        out = (np.maximum(radii - places, places + radii - self.lengths) > 1e-9 * self.lengths).any(axis=1)
        return float(self.radii[out].max(initial=0.0))

    @property
    def root_mean_square_speed(self) -> float:
        """The root-mean-square speed of all particles; 0 if there are none."""
        return float(np.sqrt((self.speeds**2).mean())) if len(self.speeds) else 0.0


@dataclass(frozen=True)
class Legend:
    """What the colours of a picture mean: a title, colours (M, 3), and texts, one for each colour or for the
    two ends of a continuous scale."""

    title: str
    colours: np.ndarray
    texts: tuple[str, ...]

    @property
    def continuous(self) -> bool:
        """Whether the colours are those of a scale."""
        return len(self.texts) < len(self.colours)


def legend_of(
    particles: DrawnParticles, colour: str | np.ndarray, fastest: float | None = None
) -> Legend | None:
    """The legend of `colours_of`; None for given colours, and for one species."""
    if not isinstance(colour, str):
        return None
    if colour == "species":
        used = np.unique(particles.species)
        if len(used) < 2:
            return None
        title, texts = _differences(particles, used)
        return Legend(title, _palette()[used % len(COLOURS)], texts)
    end = _fastest(particles, fastest)
    return Legend("speed", _ramp(np.linspace(0.0, 1.0, 64)), ("0", f"{end:.3g}"))


def _differences(particles: DrawnParticles, used: np.ndarray) -> tuple[str, tuple[str, ...]]:
    """In what these species differ, and its value in each; their numbers where one has several values."""
    titles, columns = [], []
    for title, values in (("radius", particles.radii), ("mass", particles.masses)):
        if values is None:
            continue
        distinct = [np.unique(values[particles.species == kind]) for kind in used]
        if any(len(unique) > 1 for unique in distinct):
            return "species", tuple(map(str, used))
        if len({float(unique[0]) for unique in distinct}) > 1:
            titles.append(title)
            columns.append([f"{unique[0]:.3g}" for unique in distinct])
    if not titles:
        return "species", tuple(map(str, used))
    return ", ".join(titles), tuple(map(", ".join, zip(*columns, strict=True)))


def _palette() -> np.ndarray:
    from matplotlib.colors import to_rgb

    return np.array([to_rgb(name) for name in COLOURS])


def _ramp(parts: np.ndarray) -> np.ndarray:
    import matplotlib

    return matplotlib.colormaps["viridis"](parts)[:, :3]


def _fastest(particles: DrawnParticles, fastest: float | None) -> float:
    """The end of the scale of speeds."""
    return (FASTEST * particles.root_mean_square_speed if fastest is None else fastest) or 1.0


def colours_of(
    particles: DrawnParticles, colour: str | np.ndarray, fastest: float | None = None
) -> np.ndarray:
    """(N, 3) red, green and blue from 0 to 1.

    colour: "speed", dark at rest and bright from `fastest` on (without it, from `FASTEST` root-mean-square
    speeds on), of fixed particles grey; "species"; or an array (N, 3). Raises SceneError for anything else.
    """
    if isinstance(colour, str):
        if colour not in COLOURINGS:
            raise SceneError("colour", colour, f"must be one of {', '.join(COLOURINGS)}")
        if colour == "species":
            return _palette()[particles.species % len(COLOURS)]
        colours = _ramp(particles.speeds / _fastest(particles, fastest))
        if particles.fixed is not None:
            colours[particles.fixed] = FIXED
        return colours
    given = np.asarray(colour, dtype=float)
    if given.shape != (len(particles.radii), 3):
        raise SceneError(
            "colour", f"an array of shape {given.shape}", "must have three columns, and a row per particle"
        )
    return given
