"""Point of a grid: its name, paths and seeds, and the objects that its settings describe.

Each object is made once.
"""

from __future__ import annotations

import hashlib
import json
import re
from contextlib import suppress
from dataclasses import asdict, dataclass
from functools import cached_property
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Protocol

from gaspart.engines import engine_from_dict, engine_to_dict
from gaspart.errors import SceneError, SimulationError
from gaspart.reproduction.points import engine, point_scene
from gaspart.reproduction.points import engine as schedule
from gaspart.scene.species import LATTICES

if TYPE_CHECKING:
    from gaspart.engines import Engine
    from gaspart.keys import Kind
    from gaspart.reproduction.points.engine import Schedule
    from gaspart.reproduction.points.point_scene import Extents
    from gaspart.scene.scene import Scene


TRAJECTORIES = "simulate"
"""Job whose result is a folder of trajectories, one for each replica."""
_JOBS = "gaspart.reproduction.jobs"
_LONGEST_NAME = 200  # of the 255 bytes of a file name; the rest is for suffixes and names of logs


class Job(Protocol):
    """Declarations of a job for planning. The function that does the work is separate."""

    RESULT: str
    """Description of the result of the job."""
    KEYS: dict[str, Kind]
    """Keys that have a meaning for this job, in addition to the keys for scene, engine and length."""

    def engines(self, point: Point) -> list[Engine]:
        """Return the engines whose kernels the job compiles; none if particles are only placed."""

    def arguments(self, point: Point) -> dict:
        """Return the arguments of the point's function."""


@dataclass(frozen=True)
class Point:
    """Point of a grid: a job of the workflow, with one output at ``path``. Properties that are computed from
    the settings raise SceneError if the settings contradict each other.
    """

    experiment: str
    name: str
    job: str
    settings: dict
    root: str
    config_seed: int

    @property
    def path(self) -> str:
        """Path of the result: a folder of trajectories (see TRAJECTORIES), or a netCDF file."""
        suffix = "" if self.job == TRAJECTORIES else ".nc"
        return f"{self.root}/{self.experiment}/{self.name}{suffix}"

    @property
    def replicas(self) -> int:
        """Number of independent runs of this point."""
        return self.settings.get("replicas", 1)

    def replica_path(self, replica: int) -> str:
        """Return the path of the trajectory of a replica; only for the job TRAJECTORIES."""
        return f"{self.path}/replica-{replica}.nc"

    @property
    def replica_paths(self) -> list[str]:
        """Paths of the trajectories of all replicas, in order."""
        return [self.replica_path(k) for k in range(self.replicas)]

    def seed(self, replica: int = 0) -> tuple[int, ...]:
        """Return four 32-bit words that depend only on names. The seeds do not depend on the position of the
        point in its grid.
        """
        text = f"{self.config_seed}/{self.experiment}/{self.name}/{replica}"
        digest = hashlib.sha256(text.encode()).digest()
        return tuple(int.from_bytes(digest[i : i + 4], "little") for i in range(0, 16, 4))

    @property
    def seeds(self) -> list[tuple[int, ...]]:
        """Seeds of all replicas."""
        return [self.seed(k) for k in range(self.replicas)]

    @cached_property
    def scene(self) -> Scene:
        """The simulated scene."""
        return point_scene.scene(self)

    @cached_property
    def extents(self) -> Extents:
        """Number of particles, largest radius and side lengths."""
        return point_scene.extents(self)

    @cached_property
    def engine(self) -> Engine:
        """Engine of the runs."""
        return engine.engine(self)

    @cached_property
    def engines(self) -> list[Engine]:
        """Engines that the job runs: ``engine``, or an engine for each value of the scan."""
        return engine.scan_engines(self)

    @cached_property
    def schedule(self) -> Schedule:
        """Duration and sampling of the runs."""
        return schedule.schedule(self)

    @cached_property
    def kind_of_job(self) -> Job:
        """Module of the job. The module is imported by name, so that measurements, which use points too, do
        not depend on any job.
        """
        return import_module(f"{_JOBS}.{self.job}")

    @property
    def modules(self) -> list[str]:
        """Modules that do the work of the job, by name."""
        named = getattr(self.kind_of_job, "modules", None)
        return [f"{_JOBS}.{self.job}", *(named(self) if named else ())]

    @cached_property
    def ending(self) -> dict:
        """End of runs with `until`, as fields of their recipes."""
        return import_module("gaspart.reproduction.points.point_keys").ending(self)

    @cached_property
    def arguments(self) -> dict:
        """Arguments of the job's function; the result depends on exactly these values."""
        return self.kind_of_job.arguments(self)

    @property
    def parameters(self) -> dict:
        """Arguments of the job as plain values."""
        return import_module(f"{_JOBS}.arguments").to_plain(self.arguments)

    def make_error(self, key: str, rule: str) -> SceneError:
        """Return the error that a setting violates a rule."""
        return SceneError(f"experiments.{self.experiment}.{key}", self.settings.get(key), rule)

    def to_dict(self) -> dict:
        """Return plain values without `root`, which depends on the location of the workflow."""
        return {key: value for key, value in asdict(self).items() if key != "root"}

    @classmethod
    def from_dict(cls, values: dict, path: str) -> Point:
        """Return the point from the values of `to_dict`; its result is at `path`."""
        return cls(**values, root=str(Path(path).parents[1]))


def name_of(varying: dict, where: str) -> str:
    """Return the name of a point for a file system: its varying keys and their values. Raises SceneError for
    a value that a file name cannot contain, and for a name that is too long. The error names the key below
    ``where``.
    """
    parts = [f"{_text(key, where)}={_text(value, f'{where}.{key}')}" for key, value in varying.items()]
    name = ",".join(parts) or "single"
    if len(name) > _LONGEST_NAME:
        raise SceneError(where, name, f"the name of a point may have {_LONGEST_NAME} characters")
    return name


def _text(value: object, where: str) -> str:
    if isinstance(value, (list, tuple)):
        return "x".join(_text(item, where) for item in value)
    text = str(value).lower() if isinstance(value, bool) or value is None else str(value)
    if not re.fullmatch(r"[A-Za-z0-9_.+-]+", text):
        raise SceneError(where, value, "a value that names a point may hold letters, digits and _ . + - only")
    return text


# Name of the compiled kernels that a point needs, and a tiny run that compiles them.


_FEW = 8  # number of particles and walls of each kind in a tiny run
_LAW = {"restitution", "roughness"}  # keys that the kernels combine to one collision law
_NUMBERS = {"centres_to_walls", "polydispersity"}  # keys that change no kernel


def variant(point: Point) -> str:
    """Return a text that identifies the compiled kernels of a point. The text has engine, search or
    precision, dimension, and a digest of the features of its scene. Kernels are compiled for features, not
    for numbers.
    """
    scene = point.scene
    parts = ["fill", "random", f"{scene.dimension}d"]
    if engines := point.kind_of_job.engines(point):
        engine = engines[0]  # names that differ only in numbers
        parts = [engine.name, engine.variant(scene), f"{scene.dimension}d"]
    present = sorted(compiled_features(scene))
    if point.settings.get("stress"):
        present.append("stress")
    if point.settings.get("pairs"):
        present.append("events")
    if present:
        parts.append(hashlib.sha256(" ".join(present).encode()).hexdigest()[:8])
    return "-".join(parts)


def compiled_features(scene: Scene) -> set[str]:
    """Return the names of features that change the kernels of a scene. These names include features that
    every engine models but compiles only if a scene has them.
    """
    names = scene.features - _NUMBERS - {"contact_duration"}
    if names & _LAW:
        names = (names - _LAW) | {"law"}
    extra = {
        "contact_duration": scene.contact_duration > 0.0,  # the default under gravity
        "masses": len({kind.mass for kind in scene.kinds}) > 1,
        "dragged": scene.drags_faces,
        "compressed": any(kind.arrangement == "compressed" for kind in scene.species),
        "oversized": _has_oversized(scene),
    }
    return set(names) | {name for name, present in extra.items() if present}


def _has_oversized(scene: Scene) -> bool:
    """Return True if a particle is too large for the boxes of the other particles."""
    if scene.largest_radius == scene.smallest_radius:
        return False
    from gaspart.state.boxes import largest_in_boxes

    return largest_in_boxes(scene) < scene.largest_radius


def compile_task(point: Point) -> str:
    """Return the task of `compile_kernels` for a point, as JSON. The task consists of the engine, the scene,
    and two flags: one for the tally of stress, one for the record of events. The scene is reduced to a few
    particles if these have all of its features.
    """
    from gaspart.scene.scene import Scene

    full, engine = point.scene, None
    scene = {key: value[:_FEW] if isinstance(value, list) else value for key, value in full.to_dict().items()}
    for kind in scene.get("species", ()):
        kind["count"] = min(kind["count"], _FEW)
        if kind["arrangement"] in LATTICES:  # these need fewer kernels
            kind["arrangement"] = "random"
    if compiled_features(Scene.from_dict(scene)) != compiled_features(full):
        scene = full.to_dict()
    if engines := point.kind_of_job.engines(point):
        engine = engine_to_dict(engines[0].for_small_scene(full))
    options = {"stress": "stress", "events": "pairs"}  # field of the task, by a key of the point
    extra = {name: True for name, key in options.items() if point.settings.get(key)}
    return json.dumps({"scene": scene, "engine": engine, **extra})


def compile_kernels(job: str) -> None:
    """Compile and cache all kernels of a `compile_task` by a tiny run."""
    from gaspart.scene.scene import Scene
    from gaspart.simulation import Simulation
    from gaspart.state.initial import initial_state

    task = json.loads(job)
    scene = Scene.from_dict(task["scene"])
    if task["engine"] is None:
        initial_state(scene, seed=1)
        return
    engine = engine_from_dict(task["engine"]).for_scene(scene)
    simulation = Simulation(scene, engine, 1, task.get("stress", False))
    if task.get("events"):
        simulation.record_events = True
    step = engine.quantum
    limits: dict = {"duration": 4 * step} if step else {"duration": 1.0, "max_work": 1000}
    with suppress(SimulationError):  # the run collapsed; everything has been compiled before
        simulation.advance(**limits)
        simulation.restore(simulation.checkpoint())
        simulation.advance(**limits)
