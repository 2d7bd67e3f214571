"""Trajectories: written while the run goes on, continued after a kill, read by everybody's tools.

A run writes `path.partial`, and now and then `path.checkpoint.npz`, from which it can go on to the same bits.
When whole the file is renamed to `path`. Nothing in it depends on when or where it was made.
"""

from __future__ import annotations

import fcntl
import json
import os
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from gaspart import amber, provenance
from gaspart.checkpoint import read_checkpoint, write_checkpoint
from gaspart.engines import EventDriven, TimeStepped, engine_from_dict, engine_to_dict
from gaspart.errors import SceneError, SimulationError
from gaspart.files import dump_yaml, parse_yaml
from gaspart.random import stream
from gaspart.scene import Scene, number
from gaspart.simulation import Simulation

ROUNDING = 1e-9
"""Relative deviation from a whole multiple that is put down to rounding."""

Progress = Callable[[float, float, int], None]

_STRETCH = 0.5  # seconds of work between two looks at the clock, about
_FIRST_STRETCH = {"event": 256, "step": 1}  # events, steps


def partial_path(path: Path) -> Path:
    """Where a trajectory is while it is being written."""
    return path.with_name(path.name + ".partial")


def checkpoint_path(path: Path) -> Path:
    """Where the float64 state of an unfinished trajectory is."""
    return path.with_name(path.name + ".checkpoint.npz")


def multiple(key: str, value: float, unit_key: str, unit: float) -> int:
    """`value` / `unit`, which must be a whole number of at least 1 to within rounding, or a SceneError."""
    ratio = round(value / unit) if value / unit < 2**53 else 0
    if ratio < 1 or abs(value - ratio * unit) > ROUNDING * value:
        raise SceneError(key, value, f"must be a whole multiple of {unit_key}, {unit:g}")
    return ratio


@dataclass(frozen=True)
class Recipe:
    """All that a trajectory follows from. Raises SceneError for what cannot be run.

    duration and sample_interval are in the scene's time; duration is a whole multiple of sample_interval,
    and that, for the time-stepped engine, of time_step.
    """

    scene: Scene
    engine: EventDriven | TimeStepped
    seed: int | tuple[int, ...]
    duration: float
    sample_interval: float
    displacements: bool = False

    def __post_init__(self):
        stream(self.seed)  # complains of a seed that is none
        for key in ("duration", "sample_interval"):
            value = number(key, getattr(self, key), "must be positive", above=0.0)
            object.__setattr__(self, key, value)
        if self.scene.count == 0:
            raise SceneError("scene", "no bodies", "a run needs at least one body")
        if isinstance(self.engine, TimeStepped):
            multiple("sample_interval", self.sample_interval, "time_step", self.engine.time_step)
        if multiple("duration", self.duration, "sample_interval", self.sample_interval) >= amber.MOST_FRAMES:
            raise SceneError(
                "sample_interval", self.sample_interval, "makes more frames than a file can hold"
            )

    @property
    def frames(self) -> int:
        """Frames of the whole trajectory, the one at time 0 among them."""
        return multiple("duration", self.duration, "sample_interval", self.sample_interval) + 1

    @property
    def layout(self) -> amber.Layout:
        """What a frame consists of."""
        scene = self.scene
        return amber.Layout(scene.count, scene.dimension, self.displacements, len(scene.walls))

    def attributes(self) -> dict:
        """The recipe as the file's attributes; `recipe` reads it back."""
        seed = [int(part) for part in self.seed] if isinstance(self.seed, (tuple, list)) else int(self.seed)
        return {
            "scene": dump_yaml(self.scene.to_dict()),
            "engine": json.dumps(engine_to_dict(self.engine)),
            "seed": json.dumps(seed),
            "duration": self.duration,
            "sample_interval": self.sample_interval,
            "displacements": np.int32(self.displacements),
        }

    def header(self, revision: str) -> bytes:
        """The file before its first frame, as made by the present program at a git revision ("": none)."""
        from gaspart.kernel import source_digest

        scene, versions = self.scene, provenance.versions()
        groups = [(len(scene.species), body.radius, 1) for body in scene.bodies]
        groups += [(n, kind.radius, kind.count) for n, kind in enumerate(scene.species)]
        types, radii, counts = (np.array(column) for column in zip(*groups, strict=True))
        attributes = {
            "Conventions": "AMBER",
            "ConventionVersion": "1.0",
            "program": "gaspart",
            "programVersion": versions["gaspart_version"],
            "title": f"{scene.count} hard {'discs' if scene.dimension == 2 else 'spheres'}",
            "note": amber.NOTE,
            **self.attributes(),
            **versions,
            "kernels": source_digest(),
            **({"git_revision": revision} if revision else {}),
        }
        return self.layout.header(attributes, np.repeat(radii, counts), np.repeat(types, counts))


def recipe(path: str | Path) -> Recipe:
    """How a trajectory, finished or not, was made. Raises SceneError if the file does not say."""
    path = Path(path)
    with _opened(path) as file:
        stored = file.__dict__
    scene = Scene.from_dict(parse_yaml(stored["scene"], f"{path}, attribute scene"), str(path))
    seed = json.loads(stored["seed"])
    return Recipe(
        scene=scene,
        engine=engine_from_dict(json.loads(stored["engine"])),
        seed=tuple(seed) if isinstance(seed, list) else seed,
        duration=float(stored["duration"]),
        sample_interval=float(stored["sample_interval"]),
        displacements=bool(stored["displacements"]),
    )


@contextmanager
def _opened(path: Path):
    """A trajectory of ours as a netCDF4.Dataset, complete as far as it goes, or a SceneError."""
    import netCDF4

    try:
        size = path.stat().st_size
        with path.open("rb"):
            pass
    except OSError as error:
        raise SceneError("file", str(path), f"cannot be read: {error.strerror}") from None
    try:
        file = netCDF4.Dataset(path)
    except OSError as error:
        raise SceneError("file", str(path), f"is not a readable NetCDF file: {error.strerror}") from None
    with file:
        if getattr(file, "program", None) != "gaspart" or "frame_bytes" not in file.ncattrs():
            raise SceneError("file", str(path), "is not a trajectory written by gaspart")
        frames = len(file.dimensions["frame"])
        whole = int(file.header_bytes) + frames * int(file.frame_bytes)
        if size < whole:
            rule = f"is truncated: {size} bytes, where {frames} frames need {whole}"
            raise SceneError("file", str(path), rule)
        yield file


def open_trajectory(path: str | Path):
    """A trajectory, or the finished part of a `.partial` one, as an xarray.Dataset, read as it is used.

    Dimensions frame, atom, spatial (d) and face (2d); time (frame), radius and type (atom) are coordinates.
    Lengths and times are in the scene's units, counters cumulative since time 0. Attributes tell the scene
    (YAML), engine and seed (JSON), and what follows from the scene: count, dimension, packing_fraction,
    number_density. Close it, or use it in a `with` statement.

    Raises SceneError for a file that is unreadable, truncated, or not written by gaspart.
    """
    import xarray as xr

    path = Path(path)
    scene = recipe(path).scene
    data = xr.open_dataset(path, engine="netcdf4", decode_times=False)
    attributes = {**data.attrs, "count": scene.count, "dimension": scene.dimension}
    attributes |= {"packing_fraction": scene.packing_fraction, "number_density": scene.number_density}
    data = data.isel(spatial=slice(scene.dimension)).set_coords(["time", "radius", "type"])
    data = data.drop_vars(["cell_spatial", "cell_angular"])
    faces = amber.face_names(scene.dimension, len(scene.walls))
    data = data.assign_coords(spatial=list("xyz"[: scene.dimension]), face=faces)
    reduced = {"angstrom": "length", "picosecond": "time", "angstrom/picosecond": "length/time"}
    for variable in data.variables.values():
        if variable.attrs.get("units") in reduced:
            variable.attrs["units"] = reduced[variable.attrs["units"]]
    data.attrs = {key: value for key, value in attributes.items() if not key.endswith("_bytes")}
    return data


def run(
    scene: Scene,
    engine: EventDriven | TimeStepped,
    seed: int | tuple[int, ...],
    duration: float,
    sample_interval: float,
    path: str | Path,
    displacements: bool = False,
    checkpoint_seconds: float = 30.0,
    progress: Progress | None = None,
    overwrite: bool = False,
) -> Path:
    """Run a scene and write its trajectory to `path`; returns `path`.

    A frame at time 0 and at every sample_interval to the duration, which must be a whole multiple of it;
    with `displacements` also each body's float64 way since time 0, unwrapped. A run of the same recipe and
    program that was cut short is continued, and one that is whole is left as it is. Anything else at `path`,
    or half-finished beside it, is replaced only with `overwrite`.

    `progress(time, duration, collisions)` is called about twice a second.

    Raises SceneError for settings that cannot be, and for a file that cannot be written; SimulationError
    if the run breaks an invariant, with its state kept in `path.failed.npz`.
    """
    wanted = Recipe(scene, engine, seed, duration, sample_interval, displacements)
    return _carry_out(wanted, Path(path), checkpoint_seconds, progress, overwrite)


def resume(path: str | Path, checkpoint_seconds: float = 30.0, progress: Progress | None = None) -> Path:
    """Finish the run that left `path.partial`, from what it left alone; returns `path`.

    Raises SceneError if there is nothing to resume, or if another version of the program has begun it.
    """
    path = Path(path)
    partial = partial_path(path)
    if not partial.exists():
        rule = "is already whole" if path.exists() else f"there is no {partial.name} to go on from"
        raise SceneError("path", str(path), rule)
    wanted = recipe(partial)
    if not _same_run(partial, wanted):
        raise SceneError("path", str(path), "was begun by another version of gaspart, Python, numpy or numba")
    return _carry_out(wanted, path, checkpoint_seconds, progress, overwrite=False)


def _stored_revision(path: Path) -> str:
    with _opened(path) as file:
        return getattr(file, "git_revision", "")


def _same_run(path: Path, wanted: Recipe) -> bool:
    """Whether a file was begun with this recipe by this program (at whatever git revision)."""
    try:
        header = wanted.header(_stored_revision(path))
    except SceneError:
        return False
    with path.open("rb") as file:
        return amber.same_header(file, header)


def _carry_out(wanted: Recipe, path: Path, every: float, progress: Progress | None, overwrite: bool) -> Path:
    """Finish a trajectory, from wherever it is."""
    number("checkpoint_seconds", every, "must not be negative", least=0.0)
    partial, saved = partial_path(path), checkpoint_path(path)
    with _writing(path):
        for old in (path, partial):
            if not old.exists():
                continue
            same = _same_run(old, wanted)
            if same and old == path:
                saved.unlink(missing_ok=True)
                return path
            if not same and not overwrite:
                raise SceneError("path", str(old), "exists, and is not of this run; move it, or overwrite it")
        if not os.access(path.parent, os.W_OK | os.X_OK):
            raise SceneError(
                "path", str(path), "cannot be written: no such folder, or no permission to write there"
            )
        simulation = Simulation(wanted.scene, wanted.engine, wanted.seed)
        with _locked(partial) as file:
            _write_frames(wanted, simulation, file, path, every, progress)
        os.replace(partial, path)
        saved.unlink(missing_ok=True)
    return path


@contextmanager
def _writing(path: Path):
    """One line for a full disk, a folder that is read-only, and the like."""
    try:
        yield
    except OSError as error:
        rule = f"cannot be written: {error.strerror}; what was written so far is kept"
        raise SceneError("path", str(path), rule) from None


@contextmanager
def _locked(partial: Path):
    """The partial file, open to read and write, without a buffer, and to this process alone."""
    with open(os.open(partial, os.O_RDWR | os.O_CREAT, 0o666), "r+b", buffering=0) as file:
        try:
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
            ours = os.stat(partial).st_ino == os.fstat(file.fileno()).st_ino
        except (BlockingIOError, FileNotFoundError):
            ours = False
        if not ours:
            raise SceneError("path", str(partial), "is being written by another process")
        yield file


def _write_frames(wanted: Recipe, simulation: Simulation, file, path: Path, every: float, progress) -> None:
    """Write all frames that are still missing, and checkpoints on the way."""
    partial, saved = partial_path(path), checkpoint_path(path)
    continued = _same_run(partial, wanted)
    header = wanted.header(_stored_revision(partial) if continued else provenance.git_revision())
    layout = wanted.layout
    found = read_checkpoint(saved, header) if continued else None
    if found and found.frames <= amber.frame_count(file):
        simulation.restore(found.arrays)
        frames = amber.Frames(file, layout, header, kept=found.frames)
    else:
        frames = amber.Frames(file, layout, header)
    origin = simulation.initial_state.unwrapped
    last_saved = last_told = time.monotonic()

    def look_at_the_clock():
        nonlocal last_saved, last_told
        now = time.monotonic()
        if now - last_saved >= every:
            simulation.check_invariants()
            frames.sync()
            write_checkpoint(saved, header, frames.count, simulation.checkpoint())
            last_saved = time.monotonic()
        if progress and now - last_told >= _STRETCH:
            progress(simulation.time, wanted.duration, simulation.tally.collisions)
            last_told = now

    stretch = _Stretch(_FIRST_STRETCH[wanted.engine.name])
    try:
        while frames.count < wanted.frames:
            for _ in _approach(simulation, wanted, frames.count, stretch):
                look_at_the_clock()
            simulation.check_invariants()
            frames.append(_frame(simulation, origin))
            look_at_the_clock()
    except SimulationError as error:
        failed = path.with_name(path.name + ".failed.npz")
        write_checkpoint(failed, header, frames.count, simulation.checkpoint())
        raise SimulationError(
            f"{error}; its state is kept in {failed}, the frames before in {partial}"
        ) from None
    frames.sync()


class _Stretch:
    """How many events or steps to do at a time, so that they take about `_STRETCH` seconds."""

    def __init__(self, size: int):
        self.size = size
        self._begun = time.monotonic()

    def begin(self) -> None:
        self._begun = time.monotonic()

    def end(self) -> None:
        took = time.monotonic() - self._begun
        if took < _STRETCH / 2:
            self.size *= 2
        elif took > _STRETCH * 2:
            self.size = max(1, self.size // 2)


def _approach(simulation: Simulation, wanted: Recipe, frame: int, stretch: _Stretch) -> Iterator[None]:
    """Advance to the time of a frame, n x sample_interval, by stretches; they change no bit of the result."""
    if isinstance(wanted.engine, TimeStepped):
        step = wanted.engine.time_step
        goal = frame * multiple("sample_interval", wanted.sample_interval, "time_step", step)
        while (done := simulation.tally.steps) < goal:
            stretch.begin()
            # half a step more than wanted, lest rounding cost a step
            simulation.advance(until=(min(goal, done + stretch.size) + 0.5) * step)
            yield stretch.end()
        return
    until = frame * wanted.sample_interval
    while simulation.time < until:
        stretch.begin()
        simulation.advance(until=until, max_events=stretch.size)
        yield stretch.end()
    simulation.advance(until=until)  # events at this very time that a stretch may have left


def _frame(simulation: Simulation, origin: np.ndarray) -> dict[str, np.ndarray | float]:
    """The present state and counters, as the variables of a frame."""
    state, tally = simulation.state, simulation.tally
    lengths = np.full(3, 2.0 * simulation.scene.largest_radius)  # in 2D the cell is one diameter thick
    lengths[: state.dimension] = state.lengths
    return {
        "time": state.time,
        "cell_lengths": lengths,
        "cell_angles": np.full(3, 90.0),
        "kinetic_energy": state.kinetic_energy,
        **{name: getattr(tally, name) for name in amber.COUNTERS},
        "coordinates": state.positions,
        "velocities": state.velocities,
        "displacements": state.unwrapped - origin,
    }
