"""Contents of a GSD file of the hoomd schema, https://gsd.readthedocs.io/en/stable/schema-hoomd.html."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from gaspart.errors import SceneError, optional
from gaspart.files import open_regular
from gaspart.inspection.contents import Contents, Overrides
from gaspart.system import descriptor_path

_TOPOLOGY = ("bonds", "angles", "dihedrals", "impropers", "constraints", "pairs")
_FIRST_ONLY = (
    "velocities are stored in frame 0 only; HOOMD stores all with GSD(..., dynamic=['property', 'momentum'])"
)
_PARTICLE = {
    **dict.fromkeys(("mass", "charge", "diameter"), ((), "f")),
    **dict.fromkeys(("position", "velocity", "moment_inertia"), ((3,), "f")),
    **dict.fromkeys(("orientation", "angmom"), ((4,), "f")),
    **dict.fromkeys(("typeid", "body"), ((), "iu")),
    "image": ((3,), "iu"),
}
"""Shape of each field for one particle, and the kinds of its numbers."""
_ROWS = {"particles": "position", **dict.fromkeys(_TOPOLOGY, "group")}
_MOST_ABSENT = 100_000
"""Number of particles or bonds for which the library may allocate memory without data in the file."""
_CONFIGURATION = {"box": ((6,), "f"), "dimensions": ((1,), "iu"), "step": ((1,), "iu")}
_SPHERE_RADIUS = "state/hpmc/sphere/radius"
"""Name of the radii of the types in files of HOOMD 2; other shapes have other names."""


def read_gsd(path: Path, overrides: Overrides) -> Contents:
    """Read all frames, or the last frame.

    A field that no frame contains is unknown, although the schema defines a default. The origin is the middle
    of the box. Raises SceneError for contents that cannot be checked. Errors of the library for unreadable
    files are passed on.
    """
    hoomd = optional("gsd.hoomd", "gsd", "GSD files")
    with open_regular(path) as opened_file, hoomd.open(descriptor_path(opened_file), "r") as file:
        first = max(len(file) - 1, 0) if overrides.last else 0
        for n in sorted({0, *range(first, len(file))}):
            _require_shapes(file.file, n, path)
        frames = list(file[first:])
        chunks = set(file.file.find_matching_chunk_names(""))
        moving = [n for n in range(len(file)) if file.file.chunk_exists(frame=n, name="particles/velocity")]
        old = _old_radii(file.file, chunks, path)
    if not frames:
        raise SceneError("file", str(path), "has no frames")
    _require_same_count([frame.particles.N for frame in frames], path)
    boxes = np.array([frame.configuration.box for frame in frames], dtype=float)
    dimensions = {int(frame.configuration.dimensions) for frame in frames}
    if len(dimensions) > 1:
        raise SceneError("file", str(path), "changes its number of dimensions (configuration/dimensions)")
    tilts = boxes[:, 3:4] if dimensions == {2} else boxes[:, 3:]
    if np.any(tilts != 0.0):
        tilted = boxes[np.argmax(np.any(tilts != 0.0, axis=1)), 3:].tolist()
        raise SceneError("configuration/box", tilted, "a tilted box cannot be checked", str(path))
    _refuse_bodies(frames, path)
    positions = np.array([frame.particles.position for frame in frames])
    extent = max(float(np.abs(positions).max(initial=0.0)), float(boxes.max()))
    stated = {name: f"particles/{name}" in chunks for name in ("velocity", "mass", "diameter")}
    if overrides.last:  # data missing in frame n are taken from frame 0, which has another time
        stated["velocity"] &= first in moving
    return Contents(
        positions=positions,
        velocities=np.array([frame.particles.velocity for frame in frames]) if stated["velocity"] else None,
        steps=np.array([float(frame.configuration.step) for frame in frames]),
        radii=_radii(frames, stated["diameter"], old, overrides, path),
        masses=np.array([frame.particles.mass for frame in frames]) if stated["mass"] else None,
        lengths=boxes[:, :3] if "configuration/box" in chunks else None,
        centred=True,
        flat=True if dimensions == {2} or not boxes[:, 2].any() else None,
        plain=not any(frame.particles.charge.any() for frame in frames)
        and not any(getattr(frame, name).N for frame in frames for name in _TOPOLOGY),
        resolution=float(np.finfo(positions.dtype).eps) * extent,
        velocities_from_first=_FIRST_ONLY if moving == [0] and len(frames) > 1 else None,
    )


def _require_shapes(file: Any, n: int, path: Path) -> None:
    """Raise SceneError if a chunk of a frame has another shape than the schema requires.

    The library reads such chunks as they are, and allocates memory for particles without chunks.
    """

    def read(name: str, frame: int = n) -> np.ndarray | None:
        return file.read_chunk(frame=frame, name=name) if file.chunk_exists(frame=frame, name=name) else None

    def count(group: str) -> int:
        """Return the number of particles or of bonds, which a later frame may take from frame 0."""
        for frame in (n, 0):
            stated = read(f"{group}/N", frame)
            if stated is not None and stated.shape == (1,):
                return int(stated[0])
        return 0

    particles = count("particles")
    right: dict[str, tuple[tuple[int, ...], str]] = {
        f"configuration/{name}": needed for name, needed in _CONFIGURATION.items()
    }
    right |= {f"particles/{name}": ((particles, *one), kinds) for name, (one, kinds) in _PARTICLE.items()}
    right |= {f"{group}/N": ((1,), "iu") for group in ("particles", *_TOPOLOGY)}
    for name, (shape, kinds) in right.items():
        found = read(name)
        if found is not None and (found.shape != shape or found.dtype.kind not in kinds):
            rule = f"has {name} of shape {found.shape} and type {found.dtype} in frame {n}, "
            rule += f"not {shape} and {'a floating-point number' if kinds == 'f' else 'an integer'}"
            raise SceneError("file", str(path), rule)
    for group in ("particles", *_TOPOLOGY):
        # the library writes no positions that are all 0
        if count(group) > _MOST_ABSENT and read(f"{group}/{_ROWS[group]}") is None:
            rule = f"has {count(group)} {group} in frame {n}, and no {group}/{_ROWS[group]}"
            raise SceneError("file", str(path), rule)


def _require_same_count(counts: list[int], path: Path) -> None:
    """Raise SceneError if the number of particles differs between frames."""
    for n, count in enumerate(counts):
        if count != counts[0]:
            rule = f"has {count} particles in frame {n} and {counts[0]} in frame 0"
            raise SceneError("file", str(path), f"{rule}: a changing number cannot be checked")


def _refuse_bodies(frames: list[Any], path: Path) -> None:
    """Raise SceneError for rigid bodies, whose particles may overlap one another."""
    for n, frame in enumerate(frames):
        if np.any(frame.particles.body >= 0):
            rule = f"has rigid bodies in frame {n} (particles/body), which cannot be checked"
            raise SceneError("file", str(path), rule)


def _old_radii(file: Any, chunks: set[str], path: Path) -> np.ndarray | None:
    """Return the radii (types,) of HOOMD 2 in the first frame, or None."""
    shapes = {name.split("/")[2] for name in chunks if name.startswith("state/hpmc/")}
    if shapes := shapes - {"integrate", "sphere"}:
        raise SceneError("file", str(path), f"has particles that are no spheres: {', '.join(sorted(shapes))}")
    return file.read_chunk(frame=0, name=_SPHERE_RADIUS) if _SPHERE_RADIUS in chunks else None


def _radii(
    frames: list[Any], diameters: bool, old: np.ndarray | None, overrides: Overrides, path: Path
) -> np.ndarray | None:
    """Return the radii (T, N), from the diameters or from the shapes of the types.

    The file is rejected if both exist and differ.
    """
    by_diameter = 0.5 * np.array([frame.particles.diameter for frame in frames], dtype=float)
    shapes = []
    for frame in frames:
        by_type = _of_shapes(frame.particles.type_shapes, path) if old is None else [float(x) for x in old]
        radii = np.array([by_type[n] if n < len(by_type) else np.nan for n in frame.particles.typeid])
        shapes.append(radii)
    by_shape = np.array(shapes)
    if not np.isfinite(by_shape).all():
        return by_diameter if diameters else None
    if overrides.radius is None and diameters and not np.allclose(by_shape, by_diameter, rtol=1e-6, atol=0.0):
        rule = "states other sizes in particles/diameter than in particles/type_shapes: give --radius"
        raise SceneError("file", str(path), rule)
    return by_shape


def _of_shapes(shapes: list[dict], path: Path) -> list[float]:
    """Return the radii of the types, NaN for types without radius; reject other shapes than spheres."""
    radii = []
    for shape in shapes:
        if not isinstance(shape, dict) or isinstance(shape.get("type"), list | dict):
            raise ValueError("particles/type_shapes must be a list of dictionaries")
        kind = shape.get("type")
        axes = {shape.get(axis) for axis in ("a", "b", "c")}
        if kind is None:
            radii.append(np.nan)
        elif kind in ("Sphere", "Disk"):
            radii.append(0.5 * float(shape["diameter"]))
        elif kind == "Ellipsoid" and len(axes) == 1 and None not in axes:
            radii.append(float(shape["a"]))
        else:
            rule = "has particles that are no spheres (particles/type_shapes): they cannot be checked"
            raise SceneError("type", kind, rule, str(path))
    return radii
