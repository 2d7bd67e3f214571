"""End of a run without a duration: required accuracies, and the conditions for them.

The test that ends the run is in `gaspart.accuracy.reached`.
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Self

from gaspart.analysis.observables import (
    OBSERVABLES,
    observable_name,
    observables_with,
    require_modelled,
    require_run,
    require_steady_value,
    walls_of,
)
from gaspart.engines import Engine
from gaspart.errors import SceneError
from gaspart.scene.scene import Scene
from gaspart.trajectory.correlator import Correlations
from gaspart.trajectory.run_options import Contents, Requirement, Until, required_contents


class Accuracy(Requirement):
    """Requested accuracy of an observable: its standard error divided by its absolute value.

    The run also stores an `ImpulseTally` under three conditions: the accuracy is required for the density, or
    for the pressure on walls across a single axis; the engine supports the tally; and the tally makes the run
    shorter.

    Parameters
    ----------
    observable : str
        Name of the observable, as in `gaspart measure`: Z, D, collision_rate, pressure, heat_flux,
        wall_shear, density, velocity or shear_viscosity.
    accuracy : float, [1]
        Requested relative standard error. The standard error includes the effect of correlations in time. For
        a profile, and for an observable with components that vanish, the error is relative to the root mean
        square of the components.
    start : float, [time], optional
        Frames before this time are discarded. Default: a quarter of the run.
    face : str, optional
        Name of the wall at which the observable must be accurate, such as "x low". Default: each of the
        walls.

    Raises
    ------
    SceneError
        If a value is invalid, or if the accuracy of the observable cannot end a run.

    See Also
    --------
    run : Run a scene until such accuracies are reached.
    reached_accuracy : Accuracies that a run has reached.

    Examples
    --------
    >>> import gaspart as gp
    >>> gp.Accuracy("pressure", 0.01, face="x low").name
    'pressure:x low'
    """

    def __post_init__(self) -> None:
        try:
            name = observable_name(self.observable)
        except SceneError as error:
            raise error.inside("until") from None
        able = observables_with(ends_runs=True)
        if name not in able:
            rule = f"does not end a run; use {', '.join(able)}, or give a duration and measure {name}"
            raise SceneError("until.observable", self.observable, rule)
        object.__setattr__(self, "observable", name)
        super().__post_init__()
        if self.face is not None and "face" not in OBSERVABLES[self.observable].along:
            raise SceneError("until.face", self.face, f"has no meaning for {self.observable}")

    @classmethod
    def from_name(cls, name: str, accuracy: float, start: float | None = None) -> Self:
        """Return the accuracy of an observable whose name may contain a face.

        Parameters
        ----------
        name : str
            Name of the observable, such as "Z"; to select a face, a colon and the face follow, as in
            "pressure:x low".
        accuracy : float, [1]
            Requested relative standard error.
        start : float, [time], optional
            Frames before this time are discarded. Default: a quarter of the run.

        Returns
        -------
        Accuracy
            The accuracy.

        Examples
        --------
        >>> import gaspart as gp
        >>> gp.Accuracy.from_name("pressure:x low", 0.01).face
        'x low'
        """
        observable, colon, face = name.partition(":")
        return cls(observable.strip(), accuracy, start, face if colon else None)


def contents_until(
    until: Until, scene: Scene, engine: Engine, contents: Contents, from_state: bool
) -> Contents:
    """Return the contents of a file, with displacements if a requested accuracy needs them. Raises SceneError
    for an accuracy that this run cannot measure or can never reach. `from_state`: True if the run starts from
    a prescribed state.
    """
    for requirement in until.accuracies:
        require_measurable(requirement, scene, engine, contents)
        _require_end(requirement, scene, until.at_most, from_state)
    needs = {OBSERVABLES[requirement.observable].needs for requirement in until.accuracies}
    displacements = contents.displacements or required_contents(needs)["displacements"]
    return replace(contents, displacements=displacements)


def require_measurable(requirement: Requirement, scene: Scene, engine: Engine, contents: Contents) -> None:
    """Raise SceneError for an accuracy of an observable that this run cannot measure. There are three
    possible reasons: the observable is not defined for the scene; runs of the engine do not determine the
    observable; or the data of the observable are not in the file.
    """
    walls = walls_of(requirement.observable, scene)
    try:
        require_run(requirement.observable, scene, contents.kept, contents.follow)
        require_steady_value(requirement.observable, scene)
        require_modelled(requirement.observable, scene, engine)
    except SceneError as error:
        raise SceneError("until", requirement.name, f"{error.key}: {error.rule}") from None
    if requirement.face not in (None, *walls):
        raise SceneError("until", requirement.name, f"must be one of the walls, {', '.join(walls)}")


def _require_end(requirement: Requirement, scene: Scene, at_most: float | None, from_state: bool) -> None:
    """Raise SceneError for a run that would never end. Either nothing ever happens in the scene, or the scene
    has no steady state and the run has no maximum length.
    """
    kinds = [kind for kind in scene.kinds if kind.count]
    if not kinds:
        return  # the recipe rejects this
    moving = from_state or any(kind.initial_temperature(scene.dimension) > 0.0 for kind in kinds)
    driven = scene.gravity or scene.thermostat or any(face.moves for face in scene.faces.values())
    if not moving and not driven:
        raise SceneError("until", requirement.name, "never becomes known: nothing moves")
    if scene.count == 1 and "face" not in OBSERVABLES[requirement.observable].along:
        raise SceneError("until", requirement.name, "never becomes known: a single particle meets no other")
    if at_most is None:
        try:
            from gaspart.accuracy.conditions import require_steady  # importing xarray takes 0.4 s

            require_steady(scene)
        except SceneError as error:
            rule = f"{error.key}: {error.rule}, or a longest one (at_most)"
            raise SceneError("until", requirement.name, rule) from None


def require_reachable(requirement: Requirement, scene: Scene, replicas: int) -> None:
    """Raise SceneError for an accuracy that the mean of replicas never reaches. The initial energy differs
    between replicas, because each replica has its own seed. This scatter limits the accuracy of the mean.
    """
    if replicas == 1:
        return
    from gaspart.accuracy.scatter import start_scatter  # this loads the analysis, which few runs need
    from gaspart.accuracy.target import Target

    starts = start_scatter(Target(scene, requirement.observable, requirement.face))
    if starts.value / math.sqrt(replicas) < requirement.accuracy:
        return
    enough = math.ceil(2.0 * (starts.value / requirement.accuracy) ** 2)
    rule = (
        f"the energies of the starts alone scatter the mean of {replicas} replicas by "
        f"{100.0 * starts.value / math.sqrt(replicas):.2g} %: {starts.remedy}; {enough} replicas would "
        "suffice, or give a longest duration (at_most)"
    )
    raise SceneError("until", f"{requirement.name}={requirement.accuracy:g}", rule)


def default_sample_interval(scene: Scene, engine: Engine, correlations: Correlations | None) -> float:
    """Return the default time between frames, to two digits. The interval is the mean time between two
    collisions of a particle. Without collisions it is the mean time in which a particle crosses the
    container. It is rounded to a multiple of the engine's steps and of the samples of correlations.
    """
    from gaspart.accuracy.scales import scales, two_digits

    shortest = scales(scene).event_time
    if not math.isfinite(shortest):
        raise SceneError("sample_interval", None, "must be given: nothing moves at the start")
    interval = two_digits(shortest)
    unit = correlations.interval if correlations else engine.quantum
    if unit is None:
        return interval
    return max(1, round(interval / unit)) * unit
