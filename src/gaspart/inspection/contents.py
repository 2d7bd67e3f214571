"""Particle data in the file of any program, and the frames that follow from them."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from gaspart.engines import Engine
from gaspart.errors import SceneError
from gaspart.inspection.conserved import continuous
from gaspart.inspection.frames import Frames, Rows, Vectors, map_frames
from gaspart.scene.container import Container
from gaspart.scene.scene import Scene

CENTRE = "centre"
"""Keyword for an origin in the middle of the container."""
_LARGEST = 1e30
"""Largest number of a file, whose square and single-precision value are finite."""
_FARTHEST = 2.0**40
"""Largest distance of a position from the container, in side lengths; rounding changes farther ones."""
_SAME = 1e-6
"""Relative change of a side length that is attributed to rounding."""


@dataclass
class Contents:
    """Fields of T frames of N particles, as read from a file; None if missing. Others are as in `Frames`.

    positions, velocities : (T, N, 2 or 3), as stored.
    steps : (T,), step numbers that --time-step multiplies.
    radii, masses : (N,) or (T, N).
    ids, species : (T, N), ids of particles, and species; both identify particles.
    lengths, origin : (T, 3), side lengths; 0 for walls at an unknown distance.
    boundary : (3,), boundary of each axis as a word.
    centred : True if the origin is in the middle of the container.
    flat : True if the particles move in two dimensions.
    time_resolution : resolution of a time in its data type.
    velocities_from_first : reason to doubt velocities that are the same in all frames as in frame 0.
    """

    positions: Vectors
    velocities: Vectors | None = None
    time: np.ndarray | None = None
    steps: np.ndarray | None = None
    radii: np.ndarray | None = None
    masses: np.ndarray | None = None
    ids: np.ndarray | None = None
    species: np.ndarray | None = None
    lengths: np.ndarray | None = None
    origin: np.ndarray | None = None
    boundary: tuple[str, ...] | None = None
    centred: bool = False
    flat: bool | None = None
    plain: bool = True
    isolated: bool = False
    part: bool = False
    sampled: bool = False
    engine: Engine | None = None
    scene: Scene | None = None
    counted: Path | None = None
    resolution: float = 0.0
    time_resolution: float = 0.0
    velocities_from_first: str | None = None
    no_velocities: str | None = None
    note: str = ""


@dataclass(frozen=True)
class Overrides:
    """Values of the user, before those of the file (`readers.read_frames`); `last`: the last,
    complete frame.
    """

    radius: float | None = None
    lengths: tuple[float, ...] | None = None
    boundary: str | tuple[str, ...] | None = None
    time_step: float | None = None
    origin: str | tuple[float, ...] | None = None
    last: bool = False


def complete_frames(contents: Contents, overrides: Overrides, path: str) -> Frames:
    """Complete the contents of a file with the values passed by the user; raise SceneError."""
    shape = contents.positions.shape
    if len(shape) != 3 or shape[0] < 1 or shape[1] < 1:
        raise SceneError("file", path, "needs at least one frame of at least one particle")
    _require_finite("positions", contents.positions, path)
    if contents.velocities is not None:
        _require_finite("velocities", contents.velocities, path)
    sort_by_id(contents, path)
    if contents.lengths is None and overrides.lengths is None:
        line = ", or write the sides as the second line" if path.endswith(".xyz") else ""
        raise SceneError("lengths", None, f"is not stated: give --lengths X,Y[,Z]{line}", path)
    radii = _per_frame(_radii(contents, overrides, path))
    d = _dimension(contents, overrides, 2.0 * float(radii.max()))
    sides, container = _container(contents, overrides, d, path)
    origin = _origin(contents, overrides, sides, path)
    masses = None if contents.masses is None else _per_frame(contents.masses)
    alike = masses is None or np.ptp(masses) == 0.0
    steady = len(sides) == 1 and len(radii) == 1
    frames = Frames(
        positions=_wrapped(contents.positions, origin, sides, container.periodic, path),
        lengths=sides[0],
        radii=radii[0],
        periodic=container.periodic,
        velocities=None
        if contents.velocities is None
        else map_frames(contents.velocities, lambda frame, n: frame[:, :d].astype(float), d),
        time=_times(contents, overrides, path),
        plain=contents.plain and steady and alike,
        isolated=contents.isolated and steady and alike,
        part=contents.part,
        sampled=contents.sampled,
        engine=contents.engine,
        counted=contents.counted if overrides.boundary is None else None,
        scene=contents.scene,
        resolution=min(contents.resolution, _LARGEST),
        masses=None if masses is None else masses[0],
        lengths_by_frame=sides if len(sides) > 1 else None,
        radii_by_frame=radii if len(radii) > 1 else None,
        no_velocities=contents.no_velocities or Frames.no_velocities,
        note=contents.note,
    )
    if contents.scene is not None:
        return frames
    return continuous(frames, contents.velocities_from_first, contents.ids is not None)


def _wrapped(
    positions: Vectors, origin: np.ndarray, sides: np.ndarray, periodic: tuple[bool, ...], path: str
) -> Rows:
    """Return positions (T, N, d) wrapped to [0, L) on periodic axes, one by one: numpy is slow over short
    axes.
    """

    def wrap(frame: np.ndarray, n: int) -> np.ndarray:
        low, size = origin[n % len(origin)], sides[n % len(sides)]
        wrapped = np.empty((len(frame), len(periodic)))
        for k, along in enumerate(periodic):
            x = frame[:, k].astype(float) - low[k]
            if along:
                x -= size[k] * np.floor(x / size[k])
                x[x >= size[k]] = 0.0  # -1e-17 rounds to L
            wrapped[:, k] = x
        return wrapped

    d = len(periodic)
    for n, frame in enumerate(positions):
        low, size = origin[n % len(origin)], sides[n % len(sides)]
        if (np.abs(frame[:, :d] - low) > _FARTHEST * size).any():
            rule = f"has a position that is more than {_FARTHEST:.0e} containers away, in frame {n}"
            raise SceneError("file", path, rule)
    return map_frames(positions, wrap, d)


def _origin(contents: Contents, overrides: Overrides, sides: np.ndarray, path: str) -> np.ndarray:
    """Return the lower corner of the container, (1, d) or (T, d)."""
    d = sides.shape[1]
    if overrides.origin == CENTRE or (overrides.origin is None and contents.centred):
        return -0.5 * sides
    if overrides.origin is not None:
        if isinstance(overrides.origin, str) or len(overrides.origin) < d:
            rule = f"must be {d} numbers, or the word {CENTRE}: the positions have {d} dimensions"
            raise SceneError("origin", overrides.origin, rule, path)
        return np.array([overrides.origin[:d]], dtype=float)
    return np.zeros((1, d)) if contents.origin is None else _per_frame(contents.origin)[:, :d]


def _require_finite(name: str, values: Vectors, path: str) -> None:
    """Raise SceneError if values are not finite or too large, and name the first such frame."""
    for n, frame in enumerate(values):
        if not (np.abs(frame) <= _LARGEST).all():
            rule = f"that are not finite, absent or above {_LARGEST:g}, in frame {n}"
            raise SceneError("file", path, f"has {name} {rule}")


def require_same_count(counts: list[int], path: Path) -> None:
    """Raise SceneError if the number of particles differs between frames."""
    for n, count in enumerate(counts):
        if count != counts[0]:
            rule = f"has {count} particles in frame {n} and {counts[0]} in frame 0"
            raise SceneError("file", str(path), f"{rule}: a changing number cannot be checked")


def sort_by_id(contents: Contents, path: str) -> None:
    """Sort the particles of every frame by their ids; reject frames with different ids."""
    if contents.ids is None:
        species = contents.species
        if species is not None and np.any(species != species[0]):
            frame = np.argmax(np.any(species != species[0], axis=1))
            rule = f"lists its particles in another order in frame {frame}, and has no ids to restore it"
            raise SceneError("file", path, rule)
        return
    order = np.argsort(contents.ids, axis=1, kind="stable")
    ids = np.take_along_axis(contents.ids, order, axis=1)
    if np.any(ids[:, 1:] == ids[:, :-1]):
        raise SceneError("file", path, "has two particles of the same id in a frame")
    if np.any(ids != ids[0]):
        frame = int(np.argmax(np.any(ids != ids[0], axis=1)))
        rule = f"has other particles in frame {frame} than in frame 0, by their ids"
        raise SceneError("file", path, f"{rule}: changing particles cannot be checked")
    for name in ("positions", "velocities"):
        if getattr(contents, name) is not None:
            setattr(contents, name, map_frames(getattr(contents, name), lambda frame, n: frame[order[n]]))
    for name in ("radii", "masses"):
        values = getattr(contents, name)
        if values is not None:
            values = np.broadcast_to(values, order.shape)
            setattr(contents, name, np.take_along_axis(values, order, axis=1))


def _dimension(contents: Contents, overrides: Overrides, diameter: float) -> int:
    """Return the number of dimensions, 2 or 3. If the file does not state the dimension, it follows from the
    motion along z. Particles that keep the same z are discs, unless the user passes three side lengths. In a
    single frame without velocities, particles are discs only if the container has no height or is less than
    two diameters high.
    """
    positions, velocities = contents.positions, contents.velocities
    if positions.shape[2] == 2:
        return 2
    if contents.flat is not None:
        return 2 if contents.flat else 3
    moves = velocities is not None and any(frame.any() for frame in velocities)
    moving = moves or any(np.any(frame != positions[0]) for frame in positions)
    along = velocities is not None and velocities.shape[2] == 3 and any(v[:, 2].any() for v in velocities)
    height = positions[0][0, 2]
    if (
        along
        or any((frame[:, 2] != height).any() for frame in positions)
        or (overrides.lengths is not None and len(overrides.lengths) == 3)
    ):
        return 3
    sides = overrides.lengths if contents.lengths is None else contents.lengths[0]
    low = sides is None or len(sides) < 3 or not sides[2] > 2.0 * diameter
    return 2 if moving or low else 3


def _container(contents: Contents, overrides: Overrides, d: int, path: str) -> tuple[np.ndarray, Container]:
    """Return the side lengths, (1, d) or (T, d) if they change, and the container of the first frame."""
    stated = None if contents.lengths is None else np.asarray(contents.lengths, dtype=float)[:, :d]
    if overrides.lengths is not None:
        if len(overrides.lengths) < d:
            rule = f"must be {d} sides: the positions have {d} dimensions"
            raise SceneError("lengths", overrides.lengths, rule, path)
        sides = np.array([overrides.lengths[:d]], dtype=float)
    else:
        assert stated is not None, "see `complete_frames`"
        sides = _per_frame(stated, _SAME)
    # a length of 0 means walls if it may mean that there are no periodic images; GSD always has images
    walls = np.zeros(d, dtype=bool)
    if stated is not None and not contents.centred:
        walls = (stated == 0.0).all(axis=0)
    right = ((sides > 0.0) & (sides <= _LARGEST)).all(axis=1)
    if not right.all():
        wrong = sides[np.argmin(right)]
        rule = "must be positive: give --lengths X,Y[,Z]"
        if walls.any():
            rule = "is 0 along an axis with walls, whose distance is not stated: give --lengths X,Y[,Z]"
        raise SceneError("lengths", wrong.tolist(), rule, path)
    boundary: str | tuple[str, ...] = tuple("wall" if wall else "periodic" for wall in walls)
    if contents.boundary is not None:
        boundary = contents.boundary[:d]
    if overrides.boundary is not None:
        boundary = overrides.boundary
    return sides, Container(tuple(float(x) for x in sides[0]), boundary)


def _radii(contents: Contents, overrides: Overrides, path: str) -> np.ndarray:
    """Return the radii, (N,) or (T, N)."""
    if overrides.radius is not None:
        return np.full(contents.positions.shape[1], overrides.radius)
    if contents.radii is None:
        column = ", or write radii as a fifth column" if path.endswith(".xyz") else ""
        raise SceneError("radius", None, f"is not stated: give --radius{column}", path)
    if not (np.asarray(contents.radii) > 0.0).all() or not (np.asarray(contents.radii) <= _LARGEST).all():
        least = float(np.nan_to_num(contents.radii, nan=-np.inf).min())
        raise SceneError("radius", least, "must be positive and finite: give --radius", path)
    return np.asarray(contents.radii, dtype=float)


def _times(contents: Contents, overrides: Overrides, path: str) -> np.ndarray | None:
    """Return the times (T,), or None if the file contains none. Equal times in all frames count as missing,
    because the field was never set. Times that are evenly spaced within their resolution are replaced by
    evenly spaced times.
    """
    frames = len(contents.positions)
    time, resolution = contents.time, contents.time_resolution
    if overrides.time_step is not None:
        never_set = contents.steps is None or (frames > 1 and np.ptp(contents.steps) == 0.0)
        steps = np.arange(frames) if never_set else contents.steps
        time, resolution = overrides.time_step * np.asarray(steps, dtype=float), 0.0
    if time is None or (frames > 1 and np.ptp(time) == 0.0):
        return None
    later = np.diff(time) > 0.0
    finite = np.abs(time) <= _LARGEST
    if not finite.all() or not later.all():
        frame = int(np.argmin(finite)) if later.all() else int(np.argmin(later)) + 1
        remedy = "" if overrides.time_step is not None else ": give --time-step"
        raise SceneError("file", path, f"has a time in frame {frame} that is not later than before{remedy}")
    even = np.linspace(time[0], time[-1], frames)
    return even if np.abs(time - even).max() <= resolution else time


def _per_frame(values: np.ndarray, tolerance: float = 0.0) -> np.ndarray:
    """Return (1, ...) if all frames have the same values, (T, n) or (n,), otherwise (T, ...)."""
    values = np.atleast_2d(values)
    if np.abs(values - values[:1]).max(initial=0.0) <= tolerance * np.abs(values).max(initial=0.0):
        return values[:1]
    return values
