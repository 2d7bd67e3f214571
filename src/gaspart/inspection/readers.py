"""Readers of trajectories: AMBER and LAMMPS netCDF, GSD, and plain or extended XYZ.

`docs/files.md` describes how each field of these formats is used.
"""

from __future__ import annotations

import json
import os
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path

import numpy as np

from gaspart.errors import SceneError
from gaspart.files import open_regular
from gaspart.inspection.contents import Contents, Overrides, complete_frames, sort_by_id
from gaspart.inspection.frames import Frames
from gaspart.inspection.gsd_contents import read_gsd
from gaspart.inspection.netcdf_contents import is_own, read_netcdf
from gaspart.inspection.xyz_contents import read_xyz
from gaspart.scene.scene import Scene
from gaspart.state.given import state_at_time_zero, state_from_arrays
from gaspart.state.initial import assemble_state, drawn_velocities
from gaspart.state.insertion import per_particle
from gaspart.state.state import State
from gaspart.system import memory
from gaspart.trajectory.recipe import read_recipe

COPIES = 4
"""Memory needed to read a GSD or XYZ file, divided by the size of the file. The frames of netCDF files are
read in blocks.
"""
SUFFIXES = (".nc", ".gsd", ".xyz")
_READERS = {
    **dict.fromkeys((".nc", ".ncdf", ".ncrst", ".rst7", ".rst", ".partial"), read_netcdf),
    ".gsd": read_gsd,
    **dict.fromkeys((".xyz", ".extxyz"), read_xyz),
}


def read_frames(
    path: str | Path,
    radius: float | None = None,
    lengths: tuple[float, ...] | None = None,
    boundary: str | tuple[str, ...] | None = None,
    time_step: float | None = None,
    origin: str | tuple[float, ...] | None = None,
) -> Frames:
    """Read the frames of a trajectory; the arguments take precedence over the file. `radius`: radius of all
    particles. `lengths`: (d,), side lengths of the container. `boundary`: "periodic" (the default for files
    of other programs without a boundary), "wall", or one word per axis. `time_step`: simulated time of one
    step if the file counts steps (GSD), otherwise the time between frames. `origin`: (d,), lower corner of
    the container, or "centre" if the origin is its middle. Raises SceneError for a file that cannot be read,
    or for missing data.
    """
    path, overrides = Path(path), Overrides(radius, lengths, boundary, time_step, origin)
    with _reading(path):
        return complete_frames(_contents(path, overrides), overrides, str(path))


def is_open_run(path: str | Path) -> bool:
    """Return True for a gaspart trajectory with open faces, which `checks.judge_open` checks."""
    path = Path(path)
    with _reading(path):
        netcdf = _READERS.get(path.suffix.lower()) is read_netcdf
        return netcdf and is_own(path) and read_recipe(path).scene.is_open


def read_contents(path: Path, overrides: Overrides) -> Contents:
    """Read the contents of a file as in `read_frames`; raise SceneError."""
    with _reading(path):
        return _contents(path, overrides)


def _contents(path: Path, overrides: Overrides) -> Contents:
    reader = _READERS.get(path.suffix.lower())
    if reader is None:
        rule = f"must end in .yaml, {', '.join(SUFFIXES)}"
        if path.suffix.lower() in (".lammpstrj", ".dump", ".atom"):
            # https://docs.lammps.org/dump_netcdf.html and https://docs.lammps.org/rerun.html
            rule += "; LAMMPS with its package NETCDF converts it, if the script of the run has "
            rule += "`dump 1 all netcdf 1 dump.nc id x y z vx vy vz` and, in place of `run`, "
            rule += f"`rerun {path.name} dump x y z vx vy vz`"
        raise SceneError("file", str(path), rule)
    if reader is not read_netcdf:  # which reads frames one by one
        _require_memory(path)
    return reader(path, overrides)


@contextmanager
def _reading(path: Path) -> Iterator[None]:
    """Convert any error in reading a file to SceneError; values that are not finite are rejected later."""
    try:
        with np.errstate(all="ignore"):
            yield
    except SceneError:
        raise
    except (OSError, RuntimeError, ArithmeticError, ValueError, LookupError, TypeError, MemoryError) as error:
        reason = getattr(error, "strerror", None) or error
        raise SceneError("file", str(path), f"cannot be read: {reason}") from None


def _require_memory(path: Path) -> None:
    """Raise SceneError for a file whose frames exceed the memory."""
    with open_regular(path) as file:
        size = os.fstat(file.fileno()).st_size
    available, required = memory(), COPIES * size
    if available is not None and required > available:
        rule = f"needs {required / 1e9:.3g} GB of memory for all frames; "
        rule += f"this machine has {available / 1e9:.3g} GB"
        raise SceneError("file", str(path), rule)


# Last frame of a GSD or XYZ file of another program, as the initial state of a scene.


STARTS = (".gsd", ".xyz", ".extxyz", ".json")
"""Suffixes of the files that `read_state` reads."""
_SAME = 1e-6
"""Relative deviation of a size or a mass that is attributed to rounding, as in `contents`."""


def read_state(path: str | Path, scene: Scene, seed: int | tuple[int, ...] = 0) -> State:
    r"""Return the initial state of a scene from a GSD or XYZ file, or from a file of `gaspart play`.

    The state is the last frame of the file.

    The particles of the file are sorted by their ids, if there are any. This order should be the order of the
    scene. If radii and masses then differ from the scene, particles are assigned by their radii and masses.

    Parameters
    ----------
    path : str or Path
        GSD file, XYZ file, or .json file that a page of `gaspart play` has saved.
    scene : Scene
        The scene, which defines the radii, the masses and the container.
    seed : int or tuple of int, default 0
        If the last frame has no velocities, those of the scene with this seed are drawn, with a warning.

    Returns
    -------
    State
        State at time 0 with the positions and velocities of the frame, in the precision of the file. In a
        sheared scene the velocities are relative to the flow. Spins are 0.

    Raises
    ------
    SceneError
        If the file has another number of particles, other sizes or masses, or another container; if
        `gaspart check` cannot read it; or if `Simulation` rejects the state.

    Examples
    --------
    >>> import gaspart as gp
    >>> from pathlib import Path
    >>> scene = gp.Scene(gp.Container((9.0, 9.0)), [gp.Species(1, 0.2, temperature=1.0)])
    >>> columns = "Properties=species:S:1:pos:R:3:velo:R:3"
    >>> lines = ["1", f'Lattice="9 0 0 0 9 0 0 0 1" {columns}', "A 4 5 0 1 0 0", ""]
    >>> _ = Path("start.xyz").write_text("\n".join(lines))
    >>> gp.read_state("start.xyz", scene).positions.tolist()
    [[4.0, 5.0]]
    """
    path = Path(path)
    if path.suffix not in STARTS:
        raise SceneError("file", str(path), f"must end in {', '.join(STARTS)}")
    if path.suffix == ".json":
        return _state_of_page(path, scene)
    contents = read_contents(path, Overrides(last=True))
    count = contents.positions.shape[1]
    if count != scene.count:
        raise SceneError("file", str(path), f"has {count} particles, and the scene {scene.count}")
    sort_by_id(contents, str(path))
    _check_container(contents, scene, path)
    order = _order(contents, scene, path)
    positions = _in_dimensions("positions", contents.positions[-1], scene, path)[order]
    if contents.velocities is None:
        rule = "has no velocities in its last frame: they are drawn as the scene states them"
        warnings.warn(f"gaspart: {path} {rule}", stacklevel=2)
        velocities = drawn_velocities(scene, seed)
    else:
        velocities = _in_dimensions("velocities", contents.velocities[-1], scene, path)[order]
    turning = (scene.count,) if scene.dimension == 2 else (scene.count, 3)
    state = assemble_state(scene, positions - _origin(contents, scene), velocities, np.zeros(turning))
    plain = replace(state, piston=None, piston_face=None, displaced=None, shear_rate=None)
    try:
        return state_at_time_zero(scene, plain)
    except SceneError as error:
        raise SceneError(error.key, error.value, error.rule, str(path)) from None


def _state_of_page(path: Path, scene: Scene) -> State:
    """Return the state in a file that a page of `gaspart play` has saved, with all bits."""
    with _reading(path), open_regular(path) as file:
        saved = json.loads(file.read())["state"]
        positions, velocities, spins = (
            np.array(saved[name], dtype=float) for name in ("positions", "velocities", "spins")
        )
        piston = None if saved["piston"] is None else np.array(saved["piston"], dtype=float)
    return state_from_arrays(scene, positions, velocities, spins, piston=piston)


def _in_dimensions(name: str, values: np.ndarray, scene: Scene, path: Path) -> np.ndarray:
    """Return values (N, d) from the values (N, 2 or 3) of a frame; reject others than of the scene."""
    d, stated = scene.dimension, values.shape[1]
    if stated < d:
        raise SceneError("file", str(path), f"has {name} in {stated} dimensions, and the scene has {d}")
    beyond = values[:, d:]
    if beyond.size and np.ptp(beyond) > 0.0:
        rule = f"has {name} that differ along z, and the scene has two dimensions"
        raise SceneError("file", str(path), rule)
    return values[:, :d].astype(float)


def _origin(contents: Contents, scene: Scene) -> np.ndarray:
    """Return the lower corner (d,) of the container, of which a file has the part up to the piston."""
    low, sides = np.zeros(scene.dimension), np.array(scene.container.lengths)
    for number, _ in scene.pistons if contents.lengths is not None else ():
        axis, high = divmod(number, 2)
        sides[axis] = np.asarray(contents.lengths)[-1, axis]
        low[axis] = 0.0 if high else scene.container.lengths[axis] - sides[axis]
    if contents.centred:
        return -0.5 * sides - low
    if contents.origin is None:
        return -low
    return np.atleast_2d(contents.origin)[-1, : scene.dimension] - low


def _check_container(contents: Contents, scene: Scene, path: Path) -> None:
    """Raise SceneError for other sides; between walls they may be unknown (0), at a piston shorter."""
    if contents.flat is not None and contents.flat != (scene.dimension == 2):
        has = "two" if contents.flat else "three"
        raise SceneError("file", str(path), f"has {has} dimensions, and the scene {scene.dimension}")
    if contents.lengths is None:
        return
    lengths = np.array(scene.container.lengths)
    stated = np.asarray(contents.lengths, dtype=float)[-1, : scene.dimension]
    movable = np.isin(np.arange(scene.dimension), [number // 2 for number, _ in scene.pistons])
    within = (stated == 0.0) | (movable & (stated < lengths)) | (np.abs(stated - lengths) <= _SAME * lengths)
    if not within.all():
        rule = f"must be the container of the scene, {scene.container.lengths}"
        raise SceneError("lengths", tuple(stated.tolist()), rule, str(path))


def _order(contents: Contents, scene: Scene, path: Path) -> np.ndarray:
    """Return the number (N,) in a file of each particle of the scene, by radii and masses."""
    pairs: list[tuple[str, np.ndarray, np.ndarray]] = []
    for name, stated in (("radius", contents.radii), ("mass", contents.masses)):
        if stated is not None:
            its = np.atleast_2d(np.asarray(stated, dtype=float))[-1]
            pairs.append((name, its, per_particle(scene, name).astype(float)))
    order = np.arange(scene.count)
    if not pairs or all(_alike(its, mine).all() for _, its, mine in pairs):
        return order
    order[np.lexsort([mine for _, _, mine in pairs[::-1]])] = np.lexsort([its for _, its, _ in pairs[::-1]])
    for name, its, mine in pairs:
        for n in np.flatnonzero(~_alike(its[order], mine)).tolist():
            rule = f"no particle of the file has the {name} of particle {n} of the scene, {mine[n]:g}"
            raise SceneError(name, float(its[order[n]]), rule, str(path))
    return order


def _alike(values: np.ndarray, expected: np.ndarray) -> np.ndarray:
    """Return True for each value (N,) that equals the expected value up to rounding."""
    return np.abs(values - expected) <= _SAME * expected
