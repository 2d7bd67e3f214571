"""Contents of a GSD file of the hoomd schema, https://gsd.readthedocs.io/en/stable/schema-hoomd.html."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from gaspart.errors import SceneError, optional
from gaspart.files import open_regular
from gaspart.inspection.contents import Contents, Overrides, require_same_count
from gaspart.system import descriptor_path

_TOPOLOGY = ("bonds", "angles", "dihedrals", "impropers", "constraints", "pairs")
_FIRST_ONLY = (
    "velocities are stored in frame 0 only; HOOMD stores all with GSD(..., dynamic=['property', 'momentum'])"
)


def read_gsd(path: Path, overrides: Overrides) -> Contents:
    """Read all frames, or the last, with the origin in the middle; a field that no frame has is unknown."""
    hoomd = optional("gsd.hoomd", "gsd", "GSD files")
    with open_regular(path) as opened_file, hoomd.open(descriptor_path(opened_file), "r") as file:
        first = max(len(file) - 1, 0) if overrides.last else 0
        frames = list(file[first:])
        chunks = set(file.file.find_matching_chunk_names(""))
        moving = [n for n in range(len(file)) if file.file.chunk_exists(frame=n, name="particles/velocity")]
    if not frames:
        raise SceneError("file", str(path), "has no frames")
    require_same_count([frame.particles.N for frame in frames], path)
    boxes = np.array([frame.configuration.box for frame in frames], dtype=float)
    dimensions = {int(frame.configuration.dimensions) for frame in frames}
    if len(dimensions) > 1:
        raise SceneError("file", str(path), "changes its number of dimensions (configuration/dimensions)")
    tilts = boxes[:, 3:4] if dimensions == {2} else boxes[:, 3:]
    if np.any(tilts != 0.0):
        tilted = boxes[np.argmax(np.any(tilts != 0.0, axis=1)), 3:].tolist()
        raise SceneError("configuration/box", tilted, "a tilted box cannot be checked", str(path))
    for n, frame in enumerate(frames):
        if np.any(frame.particles.body >= 0):  # their particles may overlap one another
            rule = f"has rigid bodies in frame {n} (particles/body), which cannot be checked"
            raise SceneError("file", str(path), rule)

    def stored(name: str) -> np.ndarray | None:
        if f"particles/{name}" not in chunks:
            return None
        return np.array([getattr(frame.particles, name) for frame in frames])

    positions, velocities, diameters = (
        np.array([frame.particles.position for frame in frames]),
        stored("velocity"),
        stored("diameter"),
    )
    if overrides.last and first not in moving:  # the library takes missing data from frame 0, of another time
        velocities = None
    extent = max(float(np.abs(positions).max(initial=0.0)), float(boxes.max()))
    return Contents(
        positions=positions,
        velocities=velocities,
        steps=np.array([float(frame.configuration.step) for frame in frames]),
        radii=_radii(frames, None if diameters is None else 0.5 * diameters.astype(float), overrides, path),
        masses=stored("mass"),
        lengths=boxes[:, :3] if "configuration/box" in chunks else None,
        centred=True,
        flat=True if dimensions == {2} or not boxes[:, 2].any() else None,
        plain=not any(frame.particles.charge.any() for frame in frames)
        and not any(getattr(frame, name).N for frame in frames for name in _TOPOLOGY),
        resolution=float(np.finfo(positions.dtype).eps) * extent,
        velocities_from_first=_FIRST_ONLY if moving == [0] and len(frames) > 1 else None,
    )


def _radii(
    frames: list[Any], by_diameter: np.ndarray | None, overrides: Overrides, path: Path
) -> np.ndarray | None:
    """Return the radii (T, N), from diameters or shapes of types; SceneError if both exist and differ."""
    shapes = []
    for frame in frames:
        by_type = [*(_radius_of(shape, path) for shape in frame.particles.type_shapes), np.nan]
        shapes.append([by_type[min(n, len(by_type) - 1)] for n in frame.particles.typeid])
    by_shape = np.array(shapes)
    if not np.isfinite(by_shape).all():
        return by_diameter
    if (
        overrides.radius is None
        and by_diameter is not None
        and not np.allclose(by_shape, by_diameter, 1e-6, 0.0)
    ):
        rule = "states other sizes in particles/diameter than in particles/type_shapes: give --radius"
        raise SceneError("file", str(path), rule)
    return by_shape


def _radius_of(shape: dict, path: Path) -> float:
    """Return the radius of a type, NaN without a shape; reject other shapes than spheres."""
    kind, axes = shape.get("type"), {shape.get(axis) for axis in ("a", "b", "c")}
    if kind is None:
        return np.nan
    if kind in ("Sphere", "Disk"):
        return 0.5 * float(shape["diameter"])
    if kind == "Ellipsoid" and len(axes) == 1 and None not in axes:
        return float(shape["a"])
    rule = "has particles that are no spheres (particles/type_shapes): they cannot be checked"
    raise SceneError("type", kind, rule, str(path))
