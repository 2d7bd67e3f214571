"""The particles in a picture, from a simulation, a state or a frame of a trajectory, and their colours."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from typing import TYPE_CHECKING, TypeAlias

import numpy as np

from gaspart.errors import SceneError
from gaspart.rendering.style import COLOURS
from gaspart.scene.scene import Scene
from gaspart.scene.validation import count_of
from gaspart.scene.walls import Plate, Wall
from gaspart.state.state import State
from gaspart.yaml_text import parse_yaml

if TYPE_CHECKING:
    import xarray as xr

    from gaspart.simulation.simulation import Simulation

Source: TypeAlias = "str | Path | xr.Dataset | Simulation | State"
"""What pictures are made of: a trajectory, by its path or open, a simulation or a state."""

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


@contextmanager
def opened(source: Source) -> Iterator[xr.Dataset | Simulation | State]:
    """A source whose trajectory is open; one that was given as a path is closed at the end."""
    if isinstance(source, str | Path):
        from gaspart.trajectory.run import open_trajectory

        with open_trajectory(source) as trajectory:
            yield trajectory
    else:
        yield source


def particles_of(source: State | Simulation | xr.Dataset, frame: int = -1) -> DrawnParticles:
    """The particles of a simulation or a `State` now, or of a frame (counted from the end if negative) of an
    open trajectory.

    Raises SceneError for a missing frame. A state has no interior walls and no periodic axes.
    """
    from gaspart.simulation.simulation import Simulation

    if isinstance(source, Simulation):
        return _of_state(source.state, source.scene)
    if isinstance(source, State):
        return _of_state(source, None)
    frames = source.sizes["frame"]
    if not -frames <= count_of("frame", frame, least=-frames) < frames:
        raise SceneError("frame", frame, f"the trajectory has {frames}, counted from 0")
    shown = source.isel(frame=frame)
    positions = shown["coordinates"].values.astype(float)
    velocities = shown["velocities"].values.astype(float)
    scene = Scene.from_dict(parse_yaml(source.attrs["scene"]))
    return DrawnParticles(
        positions=positions,
        radii=source["radius"].values,
        species=source["type"].values,
        speeds=np.sqrt((velocities**2).sum(axis=1)),
        lengths=shown["cell_lengths"].values[: positions.shape[1]],
        walls=_sides(scene.walls, scene.dimension),
        periodic=scene.container.periodic,
    )


def _of_state(state: State, scene: Scene | None) -> DrawnParticles:
    walls = _sides(scene.walls if scene else (), state.dimension)
    periodic = scene.container.periodic if scene else (False,) * state.dimension
    return DrawnParticles(
        state.positions, state.radii, state.species, state.speeds, state.lengths, walls, periodic
    )


def _sides(walls: Iterable[Wall | Plate], dimension: int) -> np.ndarray:
    """(M, 2, d) the segments, and the four sides of each plate."""
    found: list[tuple] = []
    for wall in walls:
        if isinstance(wall, Wall):
            found.append((wall.start, wall.end))
        else:
            corner, one, other, far = wall.corners.values()
            found += pairwise((corner, one, far, other, corner))
    return np.array(found, dtype=float).reshape(-1, 2, dimension)


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
