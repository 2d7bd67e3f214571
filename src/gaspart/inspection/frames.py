"""The frames of any program's trajectory, in one form."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from gaspart.errors import SceneError
from gaspart.scene.container import Container
from gaspart.scene.geometry import ball_volume


@dataclass(frozen=True)
class Frames:
    """What can be judged of a trajectory of T frames of N particles.

    positions (T, N, d), on periodic axes inside the container [0, L]; velocities (T, N, d) and time (T,), or
    None where the file does not tell; radii (N,); periodic (d,) whether each axis is; plain: whether
    nothing but elastic contacts moves them, as far as the file knows; resolution: by how much a
    position may be off, as a length.
    """

    positions: np.ndarray
    lengths: np.ndarray
    radii: np.ndarray
    periodic: tuple[bool, ...]
    velocities: np.ndarray | None = None
    time: np.ndarray | None = None
    plain: bool = True
    resolution: float = 0.0

    @property
    def count(self) -> int:
        """N."""
        return self.positions.shape[1]

    @property
    def dimension(self) -> int:
        """2 or 3."""
        return self.positions.shape[2]

    @property
    def diameter(self) -> float | None:
        """That of all particles, or None if they differ."""
        return float(2.0 * self.radii[0]) if np.ptp(self.radii) == 0.0 else None

    @property
    def packing_fraction(self) -> float:
        """Volume (area) of all particles over that of the container."""
        return float(ball_volume(self.dimension) * (self.radii**self.dimension).sum() / np.prod(self.lengths))


def settled(
    found: dict, path: str, radius: float | None, lengths: tuple[float, ...] | None, boundary: str | None
) -> Frames:
    """Frames from what a reader found, and what the user says of it, which goes first.

    found: positions (T, N, 3) or (T, N, d), and perhaps their `origin` (d,), lengths, radii, velocities,
    time, boundary, plain, flat (two dimensions), resolution. Raises SceneError for what is missing or cannot
    be.
    """
    positions = np.asarray(found["positions"])
    if positions.ndim != 3 or positions.shape[0] < 1 or positions.shape[1] < 2:
        raise SceneError("file", path, "needs at least one frame of at least two bodies")
    if not np.isfinite(positions).all():
        raise SceneError("file", path, "has positions that are not finite")
    flat = found.get("flat", positions.shape[2] == 3 and np.ptp(positions[:, :, 2]) == 0.0)
    d = 2 if flat or positions.shape[2] == 2 else 3
    sides = found.get("lengths") if lengths is None else np.array(lengths)
    if sides is None or len(sides) < d or not (np.asarray(sides[:d]) > 0.0).all():
        raise SceneError("lengths", lengths, f"{path} does not tell them: give --lengths X,Y[,Z]")
    radii = found.get("radii") if radius is None else np.full(positions.shape[1], radius)
    if radii is None or not (np.asarray(radii) > 0.0).all():
        raise SceneError("radius", radius, f"{path} does not tell it: give --radius")
    container = Container(tuple(float(x) for x in sides[:d]), boundary or found.get("boundary", "periodic"))
    sides = np.array(container.lengths)
    places = positions[:, :, :d].astype(float) - np.asarray(found.get("origin", np.zeros(3)))[:d]
    wrapped = np.where(container.periodic, places - sides * np.floor(places / sides), places)
    wrapped = np.where((wrapped >= sides) & container.periodic, 0.0, wrapped)  # what rounding made of -1e-17
    velocities = found.get("velocities")
    precision = np.finfo(positions.dtype).eps if positions.dtype.kind == "f" else 0.0
    return Frames(
        positions=wrapped,
        lengths=sides,
        radii=np.asarray(radii, dtype=float),
        periodic=container.periodic,
        velocities=None if velocities is None else np.asarray(velocities)[:, :, :d].astype(float),
        time=found.get("time"),
        plain=found.get("plain", True),
        resolution=float(found.get("resolution", precision * max(np.abs(positions).max(), sides.max()))),
    )
