"""Recipe of a trajectory: all settings that determine it, and their form in the file."""

from __future__ import annotations

import json
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from gaspart.engines import Engine, engine_from_dict, engine_to_dict
from gaspart.errors import SceneError
from gaspart.files import open_regular
from gaspart.keys.values import number
from gaspart.scene.boundaries import check_piston_end, refuse_sheared
from gaspart.scene.scene import Scene
from gaspart.state.given import state_at_time_zero, state_from_arrays
from gaspart.state.insertion import per_particle
from gaspart.state.optional_tallies import OptionalTally
from gaspart.state.random import stream
from gaspart.state.state import State
from gaspart.trajectory import amber, provenance
from gaspart.trajectory.correlator import Correlations, pair_names, pairs_of, sum_names
from gaspart.trajectory.opening import open_netcdf_file
from gaspart.trajectory.run_options import Contents, Until, scene_tallies, stored_contents, tally_axes
from gaspart.yaml_text import dump_yaml, parse_yaml

if TYPE_CHECKING:
    import netCDF4

MOST_REPLICAS = 10_000
ROUNDING = 1e-9
"""Largest relative deviation from an integer multiple that counts as rounding."""


def multiple(key: str, value: float, unit_key: str, unit: float) -> int:
    """Return the ratio of `value` to `unit`; SceneError unless it is a positive integer, up to rounding."""
    ratio = round(value / unit) if value / unit < 2**53 else 0
    if ratio < 1 or abs(value - ratio * unit) > ROUNDING * value:
        raise SceneError(key, value, f"must be a whole multiple of {unit_key}, {unit:g}")
    return ratio


@dataclass(frozen=True)
class Recipe(Contents):
    """Everything that determines a trajectory: scene, engine, seed, length and `Contents`."""

    scene: Scene
    engine: Engine
    seed: int | tuple[int, ...]
    duration: float | None
    sample_interval: float
    until: Until | None = None
    initial: State | None = field(default=None, compare=False, repr=False)
    replica: tuple[int, int] | None = None

    def __post_init__(self) -> None:
        stream(self.seed)  # raises SceneError for an invalid seed
        for key in ("sample_interval",) if self.until else ("duration", "sample_interval"):
            value = number(key, getattr(self, key), "must be positive", above=0.0)
            object.__setattr__(self, key, value)
        if self.replica is not None and not _is_numbered(self.seed, *self.replica):
            raise SceneError("replica", self.replica, "must be one of several, with its number in its seed")
        if self.scene.count == 0:
            raise SceneError("scene", "no particles", "a run needs at least one particle")
        super().__post_init__()
        self.check_scene(self.scene, self.until is not None)
        finest = self.correlations.interval if self.correlations else self.sample_interval
        object.__setattr__(self, "engine", self.engine.for_scene(self.scene, finest))
        if self.engine.quantum:
            multiple("sample_interval", self.sample_interval, "time_step", self.engine.quantum)
        if self.frames > amber.MOST_FRAMES:
            rule = "makes more frames than a file can hold"
            raise SceneError("sample_interval", self.sample_interval, rule)
        if self.initial is not None:
            object.__setattr__(self, "initial", state_at_time_zero(self.scene, self.initial))
        if self.duration is not None:
            piston = self.initial.piston if self.initial else None
            check_piston_end(self.scene, "duration", self.duration, None if piston is None else piston[0])
        for tally in self.asked:
            self.engine.check_tally(tally, self.scene)
        if self.correlations:
            self._check_correlations(self.correlations)
        if self.pairs:
            pairs_of(self.scene)
            if not self.engine.records_events:
                raise SceneError("pairs", True, 'collisions of pairs are counted by the "event" engine')

    def _check_correlations(self, correlations: Correlations) -> None:
        """Raise SceneError for correlations that are impossible in this run."""
        if not correlations.stress:
            refuse_sheared(self.scene, "carries particles along: correlations need stress")
        interval = "correlations.interval", correlations.interval
        if self.engine.quantum:
            multiple(*interval, "time_step", self.engine.quantum)
        if correlations.start > 0.0:
            multiple("correlations.start", correlations.start, *interval)
        samples = (self.frames - 1) * self.samples_per_frame - correlations.first
        if correlations.lags > samples:
            rule = f"must be at most {max(0, samples)}, the number of intervals "
            rule += f"of {correlations.interval:g} from {correlations.start:g} on"
            raise SceneError("correlations.lags", correlations.lags, rule)

    @property
    def samples_per_frame(self) -> int:
        """Number of samples per frame interval: 1, unless correlations need more samples."""
        if self.correlations is None:
            return 1
        return multiple(
            "sample_interval", self.sample_interval, "correlations.interval", self.correlations.interval
        )

    @property
    def frames(self) -> int:
        """Number of frames with that at time 0, the maximum for a run that ends at an accuracy."""
        if self.until:
            return self.until.most_frames(self.sample_interval) or amber.MOST_FRAMES
        assert self.duration is not None
        return multiple("duration", self.duration, "sample_interval", self.sample_interval) + 1

    @property
    def longest(self) -> float:
        """Duration of the run; for a run that ends at an accuracy, the maximum duration."""
        return (self.frames - 1) * self.sample_interval if self.duration is None else self.duration

    @property
    def stored_count(self) -> int:
        """Number of particles in the file."""
        return self.scene.capacity if self.follow is None else self.follow

    @property
    def asked(self) -> tuple[OptionalTally, ...]:
        """Optional tallies that the simulation must make."""
        tallies = self.correlations.tallies if self.correlations else ()
        return tuple(dict.fromkeys((*self.tallies, *tallies)))

    @property
    def tallied(self) -> tuple[OptionalTally, ...]:
        """All optional tallies in the frames, including the tallies of the scene."""
        able = (tally for tally in scene_tallies(self.scene) if tally.name in self.engine.tallies)
        return (*able, *self.asked)

    @property
    def layout(self) -> amber.Layout:
        """Variables of a frame."""
        scene, walls = self.scene, len(self.scene.walls)
        names = {
            "spins": scene.rough and not self.keep,
            "vibrations": scene.vibrates and not self.keep,
            "displacements": self.displacements,
            "piston": scene.has_piston,
            "pair_collisions": self.pairs,
        }
        extra = [name for name, present in names.items() if present]
        sums: list[str] = []
        axes: dict[str, int] = {}
        for tally in self.tallied:
            axes |= tally_axes(tally, scene)
        if self.correlations:
            sums = sum_names(self.correlations, self.displacements)
            axes["lag"] = self.correlations.lags + 1
        if self.pairs:
            axes["pair"] = len(pair_names(scene))
        counters = amber.counters(self.engine, self.tallied)
        count, dimension = self.stored_count, scene.dimension
        return amber.Layout(count, dimension, extra, walls, counters, sums, axes, self.keep)

    def require_all(self, path: Path) -> None:
        """Raise SceneError unless the trajectory at `path` has positions and velocities."""
        if self.keep is not None:
            raise SceneError("keep", self.keep, f"{path} holds nothing else of its particles")

    def attributes(self) -> dict[str, Any]:
        seed = [int(part) for part in self.seed] if isinstance(self.seed, (tuple, list)) else int(self.seed)
        return {
            "scene": dump_yaml(self.scene.to_dict()),
            "engine": json.dumps(engine_to_dict(self.engine)),
            "seed": json.dumps(seed),
            **{f"predicted_{key}": value for key, value in self.engine.predictions(self.scene).items()},
            **self._length(),
            "sample_interval": self.sample_interval,
            "displacements": np.int32(self.displacements),  # also if the value is False
            **super().attributes(),
            **dict(zip(("replica", "replicas"), map(np.int32, self.replica or ()), strict=False)),
        }

    def _length(self) -> dict:
        """Return the attributes of the file that describe the end of the run."""
        if self.until is None:
            return {"duration": self.duration}
        longest = self.until.at_most
        return {"until": self.until.to_json()} | ({} if longest is None else {"at_most": longest})

    def _initial(self) -> dict[str, np.ndarray]:
        """Return the variables of the prescribed initial state, if there is one."""
        if self.initial is None:
            return {}
        absent = set() if self.scene.rough else {"initial_spins"}
        parts = {name: getattr(self.initial, _part(name)) for name in amber.INITIAL if name not in absent}
        return {name: np.array(part) for name, part in parts.items() if part is not None}

    def header(self, revision: str) -> bytes:
        """Return the bytes before the first frame of a file of this program at a git `revision`, or ""."""
        from gaspart.kernels.compile.sources import source_digest

        scene, versions = self.scene, provenance.versions()
        groups = [len(scene.species)] * len(scene.particles) + list(range(len(scene.species)))
        counts = [1] * len(scene.particles) + [kind.count for kind in scene.species]
        each = {name: per_particle(scene, name) for name in ("radius", "mass")}
        particles = {  # includes particles that may enter later; these are identical
            name: np.resize(values, scene.capacity)[: self.stored_count]
            for name, values in {**each, "type": np.repeat(groups, counts)}.items()
        }
        attributes = {
            "Conventions": "AMBER",
            "ConventionVersion": "1.0",
            "program": "gaspart",
            "programVersion": versions["gaspart_version"],
            "title": f"{scene.count} hard {'discs' if scene.dimension == 2 else 'spheres'}"
            + (" at the start" if scene.is_open else ""),
            "note": amber.NOTE,
            "boundary": " ".join("periodic" if along else "wall" for along in scene.container.periodic),
            **self.attributes(),
            **versions,
            "kernels": source_digest(),
            **({"git_revision": revision} if revision else {}),
        }
        return self.layout.header(attributes, particles, self._initial())


def _is_numbered(seed: int | tuple[int, ...], replica: int, replicas: int) -> bool:
    numbered = isinstance(seed, tuple) and len(seed) > 1 and seed[-1] == replica
    return numbered and 1 <= replica <= replicas <= MOST_REPLICAS


def read_recipe(path: str | Path) -> Recipe:
    """Read the recipe of a finished or unfinished trajectory. Raises SceneError if it has no recipe."""
    path = Path(path)
    with open_netcdf_file(path) as file:
        return stored_recipe(file, path)


def stored_recipe(file: netCDF4.Dataset, path: Path) -> Recipe:
    """Return the recipe of the open trajectory at `path`; SceneError without one."""
    stored = file.__dict__
    try:
        scene = Scene.from_dict(parse_yaml(stored["scene"], f"{path}, attribute scene"), str(path))
        seed = json.loads(stored["seed"])
        recipe = Recipe(
            scene=scene,
            engine=engine_from_dict(json.loads(stored["engine"])),
            seed=tuple(seed) if isinstance(seed, list) else seed,
            duration=None if "until" in stored else float(stored["duration"]),
            sample_interval=float(stored["sample_interval"]),
            until=Until.from_json(stored["until"], stored.get("at_most")) if "until" in stored else None,
            initial=_stored_initial(file, scene),
            replica=(int(stored["replica"]), int(stored["replicas"])) if "replica" in stored else None,
            **stored_contents(stored),
        )
        _require_variables(file, recipe)
        return recipe
    except SceneError:
        raise
    except (KeyError, TypeError, ValueError) as error:  # a forged header could have this
        raise SceneError("file", str(path), f"has a header that cannot be used: {error}") from None


_ALWAYS = (
    *("time", "cell_lengths", "kinetic_energy", "coordinates", "velocities", "checksum"),
    *("collisions", "virial_sum", "worst_contact", "dissipated_energy", "wall_energy", "thermostat_energy"),
)
"""Variables of `Layout` that files of all versions have, if their runs have them."""


def _require_variables(file: netCDF4.Dataset, recipe: Recipe) -> None:
    """Raise ValueError unless an open trajectory has the variables of its recipe, with their dimensions."""
    layout = recipe.layout
    needed = {name: ("frame", *layout.variables[name][1]) for name in _ALWAYS if name in layout.variables}
    needed |= dict.fromkeys(("radius", "type"), ("atom",))
    for name, dimensions in needed.items():
        if name not in file.variables or file[name].dimensions != dimensions:
            raise ValueError(f"it does not have {name} of dimensions {', '.join(dimensions)}")
        sizes = layout.sizes | {"frame": len(file.dimensions["frame"])}
        if file[name].shape != tuple(sizes[dimension] for dimension in dimensions):
            raise ValueError(f"{name} has the shape {file[name].shape}, which is not that of its scene")


def _stored_initial(file: netCDF4.Dataset, scene: Scene) -> State | None:
    """Return the prescribed initial state of an open trajectory, or None."""
    if amber.INITIAL[0] not in file.variables:
        return None
    parts = {_part(name): np.array(file[name][:]) for name in amber.INITIAL if name in file.variables}
    return state_from_arrays(scene, **parts)


def _part(name: str) -> str:
    """Return the name of the part of a State that a variable of `amber.INITIAL` stores."""
    return name.removeprefix("initial_")


def stored_revision(path: Path) -> str:
    """Return the git revision at which a trajectory was begun; "" without a revision."""
    with open_netcdf_file(path) as file:
        return getattr(file, "git_revision", "")


def begun_as(path: Path, recipe: Recipe) -> bool:
    """Return True if this program began a file with this recipe, at any git revision."""
    try:
        header = recipe.header(stored_revision(path))
    except SceneError:
        return False
    with open_regular(path) as file:
        return amber.same_header(file, header)
