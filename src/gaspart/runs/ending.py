"""What ends a run that has no duration: the accuracy of its observables, and what no run can reach.

The rule by which it ends is in `gaspart.accuracy.reached`.
"""

from __future__ import annotations

import math
from typing import Self

from gaspart.accuracy.steady import require_steady
from gaspart.analysis.observables import (
    OBSERVABLES,
    having,
    known,
    require_modelled,
    require_run,
    require_steady_value,
    walls_of,
)
from gaspart.engines import Engine
from gaspart.errors import SceneError
from gaspart.scene.scene import Scene
from gaspart.trajectory.correlator import Correlations
from gaspart.trajectory.until import Requirement


class Accuracy(Requirement):
    """The accuracy that a run is to reach: standard error / |value| of an observable.

    observable: Z, D, collision_rate, pressure, heat_flux, wall_shear, density, velocity or shear_viscosity,
    as `gaspart measure` names them; accuracy: relative, of one standard error that includes correlations; of
    those with components that vanish, and of a profile, relative to their root mean square; start: the time
    from which frames count, by default a quarter of the run; face: of one of the walls (`x low`), by default
    each of them. A run until the density, or the pressure on walls across one axis, is accurate keeps
    impulses, where its engine can and they serve. Raises SceneError for other values.
    """

    def __post_init__(self) -> None:
        try:
            name = known(self.observable)
        except SceneError as error:
            raise error.inside("until") from None
        able = having(ends_runs=True)
        if name not in able:
            rule = f"ends no run: those that do are {', '.join(able)}; give a duration, and measure {name}"
            raise SceneError("until.observable", self.observable, rule)
        object.__setattr__(self, "observable", name)
        super().__post_init__()
        if self.face is not None and "face" not in OBSERVABLES[self.observable].along:
            raise SceneError("until.face", self.face, f"has no meaning for {self.observable}")

    @classmethod
    def named(cls, name: str, accuracy: float, start: float | None = None) -> Self:
        """From its `name`, as on the command line and in a config: `Z`, or `pressure:x low`."""
        observable, colon, face = name.partition(":")
        return cls(observable.strip(), accuracy, start, face if colon else None)


def require_measurable(
    asked: Requirement,
    scene: Scene,
    engine: Engine,
    follow: int | None = None,
    correlations: Correlations | None = None,
) -> None:
    """Raise SceneError for an observable that a scene does not have, however long the run, of which a run by
    an engine says nothing, or for which this run does not keep what it needs."""
    walls = walls_of(asked.observable, scene)
    kept = ("fluxes",) if correlations is not None and correlations.stress else ()
    try:
        require_run(asked.observable, scene, kept, follow)
        require_steady_value(asked.observable, scene)
        require_modelled(asked.observable, scene, engine)
    except SceneError as error:
        raise SceneError("until", asked.name, f"{error.key}: {error.rule}") from None
    if asked.face not in (None, *walls):
        raise SceneError("until", asked.name, f"the walls are {', '.join(walls)}")


def require_end(asked: Requirement, scene: Scene, at_most: float | None, given: bool) -> None:
    """Raise SceneError for a run in which nothing ever happens, and, without a longest duration, for one that
    comes to no steady state. given: whether it starts from a given state."""
    kinds = [kind for kind in scene.kinds if kind.count]
    if not kinds:
        return  # which the recipe refuses
    moving = given or any(kind.initial_temperature(scene.dimension) > 0.0 for kind in kinds)
    driven = scene.gravity or scene.thermostat or any(face.moves for face in scene.faces.values())
    if not moving and not driven:
        raise SceneError("until", asked.name, "never becomes known: nothing moves")
    if scene.count == 1 and "face" not in OBSERVABLES[asked.observable].along:
        raise SceneError("until", asked.name, "never becomes known: a single particle meets no other")
    if at_most is None:
        try:
            require_steady(scene)
        except SceneError as error:
            rule = f"{error.key}: {error.rule}, or a longest one (at_most)"
            raise SceneError("until", asked.name, rule) from None


def require_reachable(asked: Requirement, scene: Scene, replicas: int) -> None:
    """Raise SceneError for an accuracy that the mean of replicas, each of its seed, never reaches, since the
    energies of their starts scatter."""
    if replicas == 1:
        return
    from gaspart.accuracy.scatter import start_scatter  # loads the analysis, which few runs need
    from gaspart.accuracy.target import Target

    starts = start_scatter(Target(scene, asked.observable, asked.face))
    if starts.value / math.sqrt(replicas) < asked.accuracy:
        return
    enough = math.ceil(2.0 * (starts.value / asked.accuracy) ** 2)
    rule = (
        f"the energies of the starts alone scatter the mean of {replicas} replicas by "
        f"{100.0 * starts.value / math.sqrt(replicas):.2g} %: {starts.remedy}; {enough} replicas would "
        "suffice, or give a longest duration (at_most)"
    )
    raise SceneError("until", f"{asked.name}={asked.accuracy:g}", rule)


def default_sample_interval(scene: Scene, engine: Engine, correlations: Correlations | None) -> float:
    """The mean time between two collisions of a particle, or else to cross the container, to two digits, as a
    multiple of the engine's steps and the samples of correlations. Raises SceneError if nothing moves."""
    from gaspart.accuracy.scales import scales, two_digits

    shortest = scales(scene).event_time
    if not math.isfinite(shortest):
        raise SceneError("sample_interval", None, "must be given: nothing moves at the start")
    interval = two_digits(shortest)
    unit = correlations.interval if correlations else engine.quantum
    if unit is None:
        return interval
    return max(1, round(interval / unit)) * unit
