"""Engines: settings with which a scene can be started, and the resulting dynamics.

An engine is a frozen dataclass derived from `Engine`. Each field defines its type and its description
(`gaspart.keys`). The options of the command line, the keys of a config and the reference page are derived
from the fields. `register` makes an engine known by its name.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import MISSING, asdict, dataclass, fields
from typing import TYPE_CHECKING, Any, ClassVar, TypeVar

from gaspart.errors import SceneError
from gaspart.keys import from_mapping, validate
from gaspart.keys.values import one_of
from gaspart.scene.features import FEATURES

if TYPE_CHECKING:
    from gaspart.engines.dynamics import Dynamics
    from gaspart.scene.scene import Scene
    from gaspart.state.optional_tallies import OptionalTally
    from gaspart.state.state import State
    from gaspart.theory.conditions import Conditions


# Accuracy requests to engines, and their answers.


@dataclass(frozen=True)
class AccuracyRequest:
    """Observable of a steady scene, and its requested relative accuracy.

    The accuracy is a standard error with the bias.

    Attributes
    ----------
    conditions : local conditions of the scene
    face : wall of a pressure
    transported : whether transport coefficients govern the observable
    initial : state at time 0, None if only the errors of models are requested
    """

    observable: str
    accuracy: float
    conditions: Conditions
    face: str | None = None
    transported: bool = False
    initial: State | None = None

    @property
    def scene(self) -> Scene:
        """Scene of the conditions."""
        return self.conditions.scene


@dataclass(frozen=True)
class Candidate:
    """Engine with its settings for a scene, and bounds on its relative errors.

    Attributes
    ----------
    engine : engine with settings
    model : bound on the error of the equation that it solves
    discretisation : bound on the error due to steps and cells
    """

    engine: Engine
    model: float = 0.0
    discretisation: float = 0.0

    @property
    def bias(self) -> float:
        """Bound on the systematic error."""
        return self.model + self.discretisation


E = TypeVar("E", bound="type[Engine]")


@dataclass(frozen=True)
class Engine:
    """Settings of an engine.

    Attributes
    ----------
    name : name in files, configs and on the command line
    title : name in messages and captions
    records_events : whether its events can be recorded and counted
    counters : fields of `Tally` that only such an engine fills
    models : names of the `scene.features` that it models
    excludes : pairs of features that it does not model together
    neutral_settings : settings that change no bit of its results
    forbids_overlap : whether particles never overlap
    tallies : names of the optional tallies (`state.tally`) that it supports
    first_segment : work, in events or steps, of the first part of a run, after which the clock is read for
        the first time
    reference : True if the engine has no systematic error, so that other engines are compared with it
    timed_at : packing fraction and time step in the table of costs, used to transfer its times to another
    machine
    advised : settings that `engine: auto` of a config contains
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
        """Law of its particles: "exact" for hard particles, or the kinetic equation of its partners.

        The kinetic equation is "boltzmann" or "enskog". Collision partners are drawn according to it. A run
        is compared with the theory of this equation.
        """
        return "exact"

    @property
    def quantum(self) -> float | None:
        """Smallest time interval, of which all times are multiples; None without it."""
        return None

    def for_scene(self, scene: Scene, interval: float | None = None) -> Engine:
        """Return these settings completed for a scene.

        If `interval` is given, it becomes a multiple of the quantum. Raises SceneError.
        """
        return self

    def predictions(self, scene: Scene) -> dict[str, float]:
        """Return errors that are known beforehand, by name."""
        return {}

    def bias(self, scene: Scene, kind: str) -> float:
        """Bound the known relative error of a quantity due to the settings.

        kind : what the quantity depends on, "rates" of collisions, "paths" of particles, or "fluxes" of
            momentum and heat
        """
        return 0.0

    @classmethod
    def variants(cls) -> tuple[Engine, ...]:
        """Return the engines among which advice chooses: one for each model."""
        return (cls(),)

    def candidate(self, request: AccuracyRequest) -> Candidate:
        """Return the engine with settings that fit a request, and bounds on its errors.

        Raises SceneError if it is no candidate.
        """
        return Candidate(self)

    @property
    def timed_as(self) -> str:
        """Name in the table of costs (`gaspart.accuracy.table`)."""
        return self.name

    @property
    def precision(self) -> str:
        """Floating-point type of the state."""
        return "float64"

    def timed_step(self, scene: Scene) -> float:
        """Return the time step in its unit of the table of costs, 0 without steps."""
        return 0.0

    def at_step(self, scene: Scene, step: float, precision: str) -> Engine:
        """Return the engine with the settings of a row of the table of costs.

        step : time step in the unit of the table
        """
        return self

    def advised_settings(self) -> dict[str, Any]:
        """Return the settings `advised`, by name."""
        return {name: getattr(self, name) for name in self.advised}

    @property
    def limitations(self) -> str:
        """Features that it lacks, in words."""
        return "nothing"

    def describe(self) -> str:
        """Return its name with the settings that matter, in words."""
        return self.name

    def notes(self, scene: Scene, observable: str, paths: bool) -> dict[str, str]:
        """Return further remarks of advice on the engine, by title.

        paths : True if the observable depends on the paths of particles
        """
        return {}

    def cells_along(self, scene: Scene) -> int:
        """Return the largest number of cells along an axis, in which partners are drawn, or 0."""
        return 0

    def check_features(self, scene: Scene) -> None:
        """Raise SceneError for features of a scene that this engine does not model.

        The message names the engines that model them.
        """
        present = scene.features
        missing = [(name, "none") for name in FEATURES if name in present - self.models]
        together = [pair for pair in self.excludes if set(pair) <= present]
        missing += [(name, f"none together with {FEATURES[other].meaning}") for name, other in together]
        if missing:
            name, support = missing[0]
            others = (engine for engine in ENGINES.values() if name in engine.models)
            able = [
                f'"{engine.name}"'
                for engine in others
                if not any(set(pair) <= present for pair in engine.excludes) and engine.name != self.name
            ]
            raise FEATURES[name].refuse(
                scene, f"needs the {' or '.join(able)} engine; this one has {support}"
            )

    def draws(self, scene: Scene) -> bool:
        """Return True if random numbers are drawn after the start.

        Random numbers are used by the kinetic equation, by faces or by the thermostat. Without random
        numbers, all runs from one state are identical for all seeds.
        """
        return self.equation != "exact" or bool(scene.face_temperatures) or scene.thermostat is not None

    def variant(self, scene: Scene) -> str:
        """Return the name of its compiled kernels for a scene.

        The name does not contain the scene's features.
        """
        raise NotImplementedError

    def for_small_scene(self, scene: Scene) -> Engine:
        """Return settings with which a scene of few particles needs the same kernels as this scene."""
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
        """Prepare the engine for a scene in an initial state.

        Raises SceneError for features that the engine does not model.

        seed : seed of thermal walls and kicks
        tallies : optional tallies in addition to the counts of every run, each as `check_tally` allows
        """
        raise NotImplementedError


ENGINES: dict[str, type[Engine]] = {}
"""All engines, by name."""


def register(engine: E) -> E:
    """Register an engine by its name."""
    ENGINES[engine.name] = engine
    return engine


def reference_engine() -> Engine:
    """Return the engine without a systematic error, with its default settings."""
    return next(engine for engine in ENGINES.values() if engine.reference)()


def resolve_engine(engine: Engine | str | None) -> Engine:
    """Return the engine that a user gives, or the reference engine for None.

    A name gives the engine with default settings. Raises SceneError for other values, and for an engine that
    needs settings.
    """
    if engine is None:
        return reference_engine()
    if isinstance(engine, str):
        return engine_from_dict({"name": engine})
    if not isinstance(engine, Engine):
        raise SceneError("engine", engine, f"must be an engine: {constructors()}")
    return engine


def candidate_engines() -> list[Engine]:
    """Return the engines among which advice chooses, the reference first."""
    return sorted(
        (variant for engine in ENGINES.values() for variant in engine.variants()),
        key=lambda variant: not variant.reference,
    )


def required_settings(engine: type[Engine]) -> list[str]:
    """Return the names of the settings without default."""
    return [item.name for item in fields(engine) if item.default is MISSING]


def constructors() -> str:
    """Return the calls that make an engine of each kind, for messages.

    They include the settings that have no default.
    """
    *others, last = (
        f"{engine.__name__}({', '.join(required_settings(engine))})" for engine in ENGINES.values()
    )
    return f"{', '.join(others)} or {last}"


def engine_from_dict(mapping: dict) -> Engine:
    """Return the engine that a mapping describes.

    Parameters
    ----------
    mapping : dict
        Name and settings: ``{"name": name, setting: value, ...}``.

    Returns
    -------
    Engine
        The engine.

    Raises
    ------
    SceneError
        If the mapping is invalid.

    Examples
    --------
    >>> import gaspart as gp
    >>> gp.engine_from_dict({"name": "step", "time_step": 0.01}).passes
    4
    """
    if not isinstance(mapping, dict):
        raise SceneError("engine", mapping, "must be a mapping with a name")
    settings = dict(mapping)
    name = one_of("engine.name", settings.pop("name", None), ENGINES)
    return from_mapping(ENGINES[name], settings, "engine")


def engine_to_dict(engine: Engine) -> dict:
    """Return the mapping that `engine_from_dict` accepts.

    Parameters
    ----------
    engine : Engine
        The engine.

    Returns
    -------
    dict
        Name and settings, without settings of value None.

    Examples
    --------
    >>> import gaspart as gp
    >>> gp.engine_to_dict(gp.DSMC(time_step=0.5))
    {'name': 'dsmc', 'time_step': 0.5, 'model': 'boltzmann', 'threads': 1}
    """
    return {
        "name": engine.name,
        **{key: value for key, value in asdict(engine).items() if value is not None},
    }
