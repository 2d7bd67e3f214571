"""Engines: classes with the settings of a method of simulation.

An engine is a frozen dataclass derived from `Engine`. Each field defines its type and its description
(`gaspart.keys`). Command-line options, config keys and the reference page are derived from the fields.
`register` makes an engine available under its name.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import MISSING, asdict, dataclass, fields
from typing import TYPE_CHECKING, ClassVar, TypeVar

from gaspart.errors import SceneError
from gaspart.keys import from_mapping, validate
from gaspart.keys.values import one_of
from gaspart.scene.features import FEATURES

if TYPE_CHECKING:
    from gaspart.engines.dynamics import Dynamics
    from gaspart.scene.scene import Scene
    from gaspart.state.optional_tallies import OptionalTally
    from gaspart.state.state import State


E = TypeVar("E", bound="type[Engine]")


@dataclass(frozen=True)
class Engine:
    """Settings of an engine.

    Attributes
    ----------
    name : name in files, configs and on the command line
    title : name in messages and captions
    records_events : True if events of the engine can be recorded and counted
    counters : fields of `Tally` to which only this engine assigns values
    models : names of the `scene.features` that it supports
    excludes : pairs of features that it does not support together
    neutral_settings : settings that do not change the results
    forbids_overlap : True if particles never overlap
    tallies : names of the optional tallies (`state.tally`) that it supports
    first_segment : work, in events or steps, before the first check of the wall-clock time
    reference : True if the engine has no systematic error and is the reference for other engines
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

    def __post_init__(self) -> None:
        validate(self)

    @property
    def equation(self) -> str:
        """Dynamics that the engine simulates: "exact" for hard particles, or a kinetic equation. The kinetic
        equation is "boltzmann" or "enskog". Results of a run are compared with the theory for this equation.
        """
        return "exact"

    @property
    def quantum(self) -> float | None:
        """Time step; all times are multiples of it. None if the engine has no time steps."""
        return None

    def for_scene(self, scene: Scene, interval: float | None = None) -> Engine:
        """Return a copy in which default settings are replaced by values for a scene. If `interval` is
        passed, a time step that the engine chooses divides it into equal steps. Raises SceneError if the
        settings do not fit the scene.
        """
        return self

    def predictions(self, scene: Scene) -> dict[str, float]:
        """Return relative errors that are known before a run, by name."""
        return {}

    def remarks(self, scene: Scene) -> list[str]:
        """Return remarks about notable errors of settings and model; runs and measurements state them."""
        return []

    def bias(self, scene: Scene, kind: str) -> float:
        """Return an upper bound of the relative error of a quantity due to the settings. `kind`: kind of
        quantity: "rates" of collisions, "paths" of particles, "fluxes" of momentum and heat, or pressures on
        "walls".
        """
        return 0.0

    @property
    def precision(self) -> str:
        """Floating-point type of the state."""
        return "float64"

    def added_bulk_viscosity(self, scene: Scene) -> float:
        """Return the bulk viscosity of a dilute gas, which is due to cells alone."""
        return 0.0

    def cells_along(self, scene: Scene) -> int:
        """Return the largest number of DSMC cells along an axis; 0 for other engines."""
        return 0

    def check_features(self, scene: Scene) -> None:
        """Raise SceneError for unsupported features of a scene, with the engines that support them."""
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
        """Return True if a run uses random numbers after the start. Kinetic equations, thermal faces and the
        thermostat use random numbers. Without random numbers, all runs that start from the same state are
        identical, even if their seeds differ.
        """
        return self.equation != "exact" or bool(scene.face_temperatures) or scene.thermostat is not None

    def variant(self, scene: Scene) -> str:
        """Return the name of the compiled kernel variant, which does not depend on the scene's features."""
        raise NotImplementedError

    def for_small_scene(self, scene: Scene) -> Engine:
        """Return settings with which a small scene uses the same kernels as this scene."""
        return self

    def check_tally(self, tally: OptionalTally, scene: Scene) -> None:
        """Raise SceneError if this engine does not support an optional tally for a scene."""
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
        """Prepare the engine for a scene in an initial state. Raises SceneError for features that the engine
        does not support. `seed`: seed of thermal walls and kicks. `tallies`: optional tallies in addition to
        the counters of every run; `check_tally` must accept them.
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
    """Return the engine that an argument of a user means; the reference engine for None. The argument is an
    engine, or the name of an engine, which means default settings. Raises SceneError for other values, and
    for the name of an engine that has required settings.
    """
    if engine is None:
        return reference_engine()
    if isinstance(engine, str):
        if engine.endswith(".nc"):
            raise SceneError("engine", engine, "must be an engine; path= names the file")
        return engine_from_dict({"name": engine})
    if not isinstance(engine, Engine):
        raise SceneError("engine", engine, f"must be an engine: {constructors()}")
    return engine


def required_settings(engine: type[Engine]) -> list[str]:
    """Return the names of settings without a default."""
    return [item.name for item in fields(engine) if item.default is MISSING]


def constructors() -> str:
    """Return constructor calls of all engines, with settings that have no default, for messages."""
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
        Name and settings; settings with the value None are omitted.

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
