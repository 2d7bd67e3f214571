"""Engines: settings that a scene can be started with, and the dynamics that this gives.

An engine is a frozen dataclass derived from `Engine`, each field of which declares its kind and its meaning
(`gaspart.keys`): the options of the command line, the keys of a config and the reference page follow from
them.
`register` makes it known by its name.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import MISSING, asdict, dataclass, fields
from typing import TYPE_CHECKING, Any, ClassVar, Protocol, TypeVar

from gaspart.errors import SceneError
from gaspart.keys import from_mapping, validate
from gaspart.keys.values import one_of
from gaspart.scene.features import FEATURES

if TYPE_CHECKING:
    import numpy as np

    from gaspart.engines.dynamics import Dynamics
    from gaspart.scene.scene import Scene
    from gaspart.state.optional_tallies import OptionalTally
    from gaspart.state.state import State


# What an engine is asked for, an observable of a steady scene to an accuracy, and what it answers.


class Local(Protocol):
    """The local density and temperature of a steady scene, in layers (S,) across an axis, as
    `gaspart.accuracy.conditions` knows them, which states what each of these is."""

    @property
    def scene(self) -> Scene:
        """The scene."""

    @property
    def axis(self) -> int | None:
        """Across which it changes; None of an even gas."""

    @property
    def scale(self) -> float:
        """The shortest length along the axis over which it changes by the factor e."""

    @property
    def free(self) -> np.ndarray:
        """(d,) lengths that centres can reach."""

    @property
    def share(self) -> np.ndarray:
        """(S,) the part of all particles in each layer."""

    @property
    def crowding(self) -> np.ndarray:
        """(S,) the density over the mean one."""

    @property
    def temperature(self) -> np.ndarray:
        """(S,) k_B T."""

    @property
    def filled(self) -> np.ndarray:
        """(S,) packing fraction."""

    @property
    def contact(self) -> np.ndarray:
        """(S,) contact value of an infinite gas."""

    @property
    def contact_of_few(self) -> np.ndarray:
        """(S,) that of so many particles."""

    @property
    def virial(self) -> np.ndarray:
        """(S,) Z - 1."""

    @property
    def path(self) -> np.ndarray:
        """(S,) mean free path."""

    @property
    def speed(self) -> np.ndarray:
        """(S,) mean speed."""

    @property
    def contrast(self) -> float:
        """The shortest free path of an even gas over the shortest one here."""

    @property
    def surfaces(self) -> float:
        """The part of all contacts that lack a neighbour beyond a wall."""

    @property
    def memory(self) -> float:
        """|D / Enskog's - 1|, by correlated collisions."""

    def of_points(self, observable: str, face: str | None) -> float | None:
        """By how much the observable of points differs where theory knows the column of particles."""


@dataclass(frozen=True)
class Asked:
    """An observable of a steady scene, and its relative accuracy: a standard error with the bias.

    conditions: of the scene; face: of the pressure, the wall; transported: whether transport coefficients
    govern the observable; initial: the state at time 0, None where only the errors of models are asked for.
    """

    observable: str
    accuracy: float
    conditions: Local
    face: str | None = None
    transported: bool = False
    initial: State | None = None

    @property
    def scene(self) -> Scene:
        """That of the conditions."""
        return self.conditions.scene


@dataclass(frozen=True)
class Candidate:
    """An engine with its settings for a scene. model, discretisation: bounds on its relative errors, by the
    equation that it solves, and by steps and cells."""

    engine: Engine
    model: float = 0.0
    discretisation: float = 0.0

    @property
    def bias(self) -> float:
        """The bound on its systematic error."""
        return self.model + self.discretisation


E = TypeVar("E", bound="type[Engine]")


@dataclass(frozen=True)
class Engine:
    """Settings of an engine.

    name: by which files, configs and the command line know it; title: in messages and captions;
    records_events: whether its events can be recorded and counted; counters: fields of `Tally` that only
    such an engine fills; neutral_settings: settings that change no bit of its results; forbids_overlap:
    whether particles never overlap; tallies: names of the `state.optional_tallies` that it can make; models:
    names of the `scene.features` that it models, and excludes: pairs of them that it does not model together;
    first_segment: the work, in events or steps, that a run begins with between two looks at the clock;
    reference: whether it has no systematic error, so that others are compared with it; timed_at: packing
    fraction and time step, as in the table of costs, by which its times are carried over to another machine;
    advised: settings that `engine: auto` of a config states.
    """

    name: ClassVar[str]
    title: ClassVar[str]
    records_events: ClassVar[bool] = False
    counters: ClassVar[tuple[str, ...]] = ()
    models: ClassVar[frozenset[str]] = frozenset()
    excludes: ClassVar[tuple[tuple[str, str], ...]] = ()
    neutral_settings: ClassVar[tuple[str, ...]] = ()
    forbids_overlap: ClassVar[bool] = True
    tallies: ClassVar[frozenset[str]] = frozenset()
    first_segment: ClassVar[int] = 1
    reference: ClassVar[bool] = False
    timed_at: ClassVar[tuple[float, float]] = (0.1, 0.0)
    advised: ClassVar[tuple[str, ...]] = ()

    def __post_init__(self) -> None:
        validate(self)

    @property
    def equation(self) -> str:
        """The law of its particles: "exact" if they meet where they touch, or "boltzmann" or "enskog", the
        kinetic equation by which partners are drawn. A run is compared with the theory of this equation."""
        return "exact"

    @property
    def quantum(self) -> float | None:
        """The time of which all times that it reaches are multiples; None if it stops at any time."""
        return None

    def resolved(self, scene: Scene, interval: float | None = None) -> Engine:
        """These settings with those that were left to the scene, so that `interval`, if any, is a multiple of
        its quantum. Raises SceneError."""
        return self

    def predictions(self, scene: Scene) -> dict[str, float]:
        """Errors that are known beforehand, by name."""
        return {}

    def bias(self, scene: Scene, kind: str) -> float:
        """Bound on the relative error, where it is known, that its settings make in a quantity by what this
        depends on: "rates" of collisions, "paths" of particles, or "fluxes" of momentum and heat."""
        return 0.0

    @classmethod
    def offered(cls) -> tuple[Engine, ...]:
        """Those among which advice chooses: one for each of its models."""
        return (cls(),)

    def candidate(self, asked: Asked) -> Candidate:
        """With the settings that fit what is asked, and bounds on their errors. Raises SceneError where it is
        no candidate."""
        return Candidate(self)

    @property
    def timed_as(self) -> str:
        """Its name in the table of costs (`gaspart.accuracy.table`)."""
        return self.name

    @property
    def precision(self) -> str:
        """The floating-point type of its state."""
        return "float64"

    def timed_step(self, scene: Scene) -> float:
        """Its time step in the unit that the table of costs has for it, 0 without steps."""
        return 0.0

    def at_step(self, scene: Scene, step: float, precision: str) -> Engine:
        """With the settings of a row of the table: a time step in that unit, and a precision."""
        return self

    def advised_settings(self) -> dict[str, Any]:
        """Those of `advised`, by name."""
        return {name: getattr(self, name) for name in self.advised}

    @property
    def limitations(self) -> str:
        """What it does not have, in words."""
        return "nothing"

    def describe(self) -> str:
        """Its name with the settings that matter, in words."""
        return self.name

    def notes(self, scene: Scene, observable: str, paths: bool) -> dict[str, str]:
        """What advice says of it besides, by title; paths: whether an observable depends on those of
        particles."""
        return {}

    def cells_along(self, scene: Scene) -> int:
        """The number of cells along an axis, the most, in which partners are drawn; 0 if none are drawn."""
        return 0

    def check_features(self, scene: Scene) -> None:
        """Raise SceneError for features of a scene that this engine does not model, with those that do."""
        present = scene.features
        missing = [(name, "none") for name in FEATURES if name in present - self.models]
        together = [pair for pair in self.excludes if set(pair) <= present]
        missing += [(name, f"none together with {FEATURES[other].meaning}") for name, other in together]
        if missing:
            name, what = missing[0]
            others = (engine for engine in ENGINES.values() if name in engine.models)
            able = [
                f'"{engine.name}"'
                for engine in others
                if not any(set(pair) <= present for pair in engine.excludes) and engine.name != self.name
            ]
            raise FEATURES[name].refuse(scene, f"needs the {' or '.join(able)} engine; this one has {what}")

    def draws(self, scene: Scene) -> bool:
        """Whether random numbers are drawn after the start: by its equation, faces or the thermostat. Where
        none are, runs from one state are one run, whatever their seeds."""
        return self.equation != "exact" or bool(scene.face_temperatures) or scene.thermostat is not None

    def variant(self, scene: Scene) -> str:
        """The name of its compiled kernels for a scene, beside the scene's features."""
        raise NotImplementedError

    def for_small_scene(self, scene: Scene) -> Engine:
        """Settings with which the scene with only a few particles needs the same kernels."""
        return self

    def check_tally(self, tally: OptionalTally, scene: Scene) -> None:
        """Raise SceneError if this engine cannot make an optional tally of a scene."""
        if tally.name not in self.tallies:
            able = " or ".join(
                f'"{engine.name}"' for engine in ENGINES.values() if tally.name in engine.tallies
            )
            raise SceneError(tally.name, True, f"needs the {able} engine")
        tally.check(scene)

    def start(
        self,
        scene: Scene,
        state: State,
        seed: int | tuple[int, ...] = 0,
        tallies: Sequence[OptionalTally] = (),
    ) -> Dynamics:
        """Set the engine up for a scene in a given state; `seed` is that of thermal walls and kicks.

        tallies: those that are made beside what every run counts, each as `check_tally` allows. Raises
        SceneError for what the engine does not model.
        """
        raise NotImplementedError


ENGINES: dict[str, type[Engine]] = {}
"""All engines, by name."""


def register(engine: E) -> E:
    """Make an engine known by its name."""
    ENGINES[engine.name] = engine
    return engine


def reference_engine() -> Engine:
    """The engine without a systematic error, with its default settings."""
    return next(engine for engine in ENGINES.values() if engine.reference)()


def chosen(engine: Engine | str | None) -> Engine:
    """The engine that a user gives: by its name with default settings, or None for the reference. Raises
    SceneError for other things, and for an engine that needs settings."""
    if engine is None:
        return reference_engine()
    if isinstance(engine, str):
        return engine_from_dict({"name": engine})
    if not isinstance(engine, Engine):
        raise SceneError("engine", engine, f"must be an engine: {constructors()}")
    return engine


def offered() -> list[Engine]:
    """The engines among which advice chooses, the reference first."""
    return sorted(
        (one for engine in ENGINES.values() for one in engine.offered()), key=lambda one: not one.reference
    )


def required(engine: type[Engine]) -> list[str]:
    """The settings that have no default."""
    return [item.name for item in fields(engine) if item.default is MISSING]


def constructors() -> str:
    """The calls that make an engine of each kind, with the settings that have no default, for messages."""
    *others, last = (f"{engine.__name__}({', '.join(required(engine))})" for engine in ENGINES.values())
    return f"{', '.join(others)} or {last}"


def engine_from_dict(mapping: dict) -> Engine:
    """The engine described by {"name": name, setting: value, ...}. Raises SceneError."""
    if not isinstance(mapping, dict):
        raise SceneError("engine", mapping, "must be a mapping with a name")
    settings = dict(mapping)
    name = one_of("engine.name", settings.pop("name", None), ENGINES)
    return from_mapping(ENGINES[name], settings, "engine")


def engine_to_dict(engine: Engine) -> dict:
    """The mapping that `engine_from_dict` accepts."""
    return {
        "name": engine.name,
        **{key: value for key, value in asdict(engine).items() if value is not None},
    }
