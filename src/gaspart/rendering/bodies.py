"""What a picture shows: bodies at one time, from a state or a frame of a trajectory, and their colours."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from gaspart.errors import SceneError
from gaspart.figures.style import COLOURS
from gaspart.state import State
from gaspart.validation import count_of
from gaspart.yaml_text import parse_yaml

if TYPE_CHECKING:
    import xarray as xr

COLOURINGS = ("speed", "species")
FASTEST = 2.0
"""The scale of speeds ends at this many root-mean-square speeds."""


@dataclass(frozen=True)
class Bodies:
    """positions (N, d), radii (N,), species (N,), speeds (N,); lengths (d,) of the container; walls
    (M, 2, 2), the ends of the interior ones."""

    positions: np.ndarray
    radii: np.ndarray
    species: np.ndarray
    speeds: np.ndarray
    lengths: np.ndarray
    walls: np.ndarray

    @property
    def dimension(self) -> int:
        """2 or 3."""
        return self.positions.shape[1]

    @property
    def root_mean_square_speed(self) -> float:
        """Of all bodies; 0 if there are none."""
        return float(np.sqrt((self.speeds**2).mean())) if len(self.speeds) else 0.0


def bodies_of(source: State | xr.Dataset, frame: int = -1) -> Bodies:
    """The bodies of a `State`, or of a frame (counted from the end if negative) of an open trajectory.

    Raises SceneError for a frame that is not there. A state knows of no interior walls.
    """
    if isinstance(source, State):
        speeds = np.sqrt((source.velocities**2).sum(axis=1))
        walls = np.zeros((0, 2, 2))
        return Bodies(source.positions, source.radii, source.species, speeds, source.lengths, walls)
    frames = source.sizes["frame"]
    if not -frames <= count_of("frame", frame, least=-frames) < frames:
        raise SceneError("frame", frame, f"the trajectory has {frames}, counted from 0")
    shown = source.isel(frame=frame)
    positions = shown["coordinates"].values.astype(float)
    velocities = shown["velocities"].values.astype(float)
    walls = parse_yaml(source.attrs["scene"]).get("walls", ())
    return Bodies(
        positions=positions,
        radii=source["radius"].values,
        species=source["type"].values,
        speeds=np.sqrt((velocities**2).sum(axis=1)),
        lengths=shown["cell_lengths"].values[: positions.shape[1]],
        walls=np.array([[wall["start"], wall["end"]] for wall in walls]).reshape(-1, 2, 2),
    )


def colours_of(bodies: Bodies, colour: str | np.ndarray, fastest: float | None = None) -> np.ndarray:
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
            return palette[bodies.species % len(palette)]
        import matplotlib

        end = FASTEST * bodies.root_mean_square_speed if fastest is None else fastest
        return matplotlib.colormaps["viridis"](bodies.speeds / (end or 1.0))[:, :3]
    given = np.asarray(colour, dtype=float)
    if given.shape != (len(bodies.radii), 3):
        raise SceneError(
            "colour", f"an array of shape {given.shape}", "must have three columns, a row a body"
        )
    return given
