"""Conventions of other programs for files of scenes, in a line of `info` and `export`.

Each statement stands in docs/tools.md or docs/conventions.md, which the referees repeat.
"""

from __future__ import annotations

from gaspart.scene.scene import Scene

_SLAB = "g(r) of discs is theirs times 2 r / L_z, that of a slab"


def conventions(scene: Scene, suffix: str) -> str:
    """Return a line on a scene's file in other programs; "" if they read it correctly.

    The suffix is .nc for a trajectory, or the suffix of an exported file.
    """
    state = {".nc": _of_trajectory, ".gsd": _of_gsd, ".xyz": _of_xyz, ".data": _of_data}[suffix]
    remarks = "; ".join(state(scene))
    return f"in other programs: {remarks}" if remarks else ""


def _as_periodic(scene: Scene) -> list[str]:
    """Describe the axes whose walls a format lacks."""
    axes = zip("xyz", scene.container.periodic, strict=False)
    walled = ", ".join(axis for axis, periodic in axes if not periodic)
    return [f"walls across {walled} are read as periodic"] if walled else []


def _of_trajectory(scene: Scene) -> list[str]:
    remarks = _as_periodic(scene)
    if scene.dimension == 2:
        remarks.append(_SLAB)
    if scene.is_open:
        remarks.append("rows of NaN are numbers that no particle has")
    if scene.has_piston:
        remarks.append("positions are in the cell after subtraction of cell_origin")
    return remarks


def _of_gsd(scene: Scene) -> list[str]:
    return [*_as_periodic(scene), "g(r) of freud is smaller by (N - 1) / N"]


def _of_xyz(scene: Scene) -> list[str]:
    remarks = ["velocities are the property velo in ASE and chemfiles"]
    if not all(scene.container.periodic):
        remarks.append("chemfiles has no pbc")
    return remarks + ([_SLAB] if scene.dimension == 2 else [])


def _of_data(scene: Scene) -> list[str]:
    periodic = (*scene.container.periodic, True)[:3]
    flat = ", dimension 2" if scene.dimension == 2 else ""
    remarks = [f"LAMMPS needs boundary {' '.join('p' if along else 'f' for along in periodic)}{flat}"]
    if not any(scene.container.periodic):
        remarks.append("its temp is larger by N / (N - 1)")
    return remarks
