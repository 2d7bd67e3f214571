"""The engine, settings and run length that give a required accuracy at the lowest cost.

The result of a run of n contacts of two particles is off by at most |bias| + 1.96 sqrt(noise / n) in 95 % of
all runs, bias being that of time steps, or of the model and the cells of DSMC. For each setting the n follows
that makes this the wanted accuracy, and from it the cost; the cheapest setting is advised.
"""

from __future__ import annotations

import math
import os
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from typing import TypeAlias

from gaspart import theory
from gaspart.accuracy import speed, table
from gaspart.accuracy.models import cell_loss, model_error, step_error
from gaspart.accuracy.steady import temperature_scatter
from gaspart.accuracy.table import EQUILIBRATION, LEAST, MODELS, QUANTILE
from gaspart.analysis import finite
from gaspart.analysis.observables import OBSERVABLES, having, require_modelled
from gaspart.engines import DSMC, Engine, EventDriven, TimeStepped
from gaspart.errors import SceneError
from gaspart.keys.values import number
from gaspart.scene.gas import Gas, plain_gas
from gaspart.scene.scene import Scene
from gaspart.trajectory.recipe import Recipe

ACCURACIES = 1e-8, 1.0
"""The best relative accuracy that float64 sums and the table support, and the worst."""
FEWEST = 64
"""Particles of a gas that is like those of the table, to 1 % of Z - 1: fewer have pilots of their own."""
SpeedOf: TypeAlias = Callable[[int, str, str, int], float]
"""A function as `gaspart.accuracy.speed.factor`."""
_PER_EQUILIBRATION = 10.0  # smallest ratio of a replica's length to its equilibration
_FRAMES = 1000
_WORTH = 3.0  # how many times as cheap the best engine may be by the table, so that another is timed
_BULK = 4.0  # the finite size of a gas should cost no more than this part of the accuracy


@dataclass(frozen=True)
class Setting:
    """One engine with its settings. name: in the table; bias: bound on its systematic error; contacts: to be
    measured, in all replicas; seconds: of processor time, equilibration included; half_width: of the 95 %
    interval, relative."""

    engine: Engine
    name: str
    bias: float
    contacts: float
    seconds: float
    half_width: float


@dataclass(frozen=True)
class Advice:
    """The setting to take, the best one of each other kind, and what follows for the run.

    collisions_per_particle: measured, in each replica; duration: the same in the scene's time; finite_size:
    relative difference from the infinite gas; bulk_count: particles for which that is a quarter of the
    accuracy. Both NaN where there is no theory. scatter: relative standard deviation of D and of the
    collision rate from run to run, if velocities are drawn from a temperature and have it only on average.
    """

    scene: Scene
    gas: Gas
    observable: str
    accuracy: float
    setting: Setting
    others: tuple[Setting, ...]
    replicas: int
    collisions_per_particle: float
    finite_size: float
    bulk_count: float
    scatter: float

    @property
    def duration(self) -> float:
        """Measured length of each replica, in the scene's time."""
        return self.collisions_per_particle / float(theory.collision_rate(**self.gas.parameters))

    @property
    def recipe(self) -> Recipe:
        """One replica, equilibration included, with a frame for each collision of a particle or fewer."""
        interval = (
            self.duration / self.collisions_per_particle * max(1.0, self.collisions_per_particle / _FRAMES)
        )
        quantum = self.setting.engine.resolved(self.scene).quantum
        interval = (
            float(f"{interval:.2g}") if quantum is None else max(1, round(interval / quantum)) * quantum
        )
        part = self.duration * (1.0 + EQUILIBRATION / self.collisions_per_particle) / interval
        paths = OBSERVABLES[self.observable].needs == "paths"
        length = math.ceil(part) * interval
        return Recipe(self.scene, self.setting.engine, 1, length, interval, displacements=paths)

    @property
    def within_budget(self) -> bool:
        """Whether the setting reaches the accuracy within the budget."""
        return self.setting.half_width <= self.accuracy * (1.0 + 1e-9)


@dataclass(frozen=True)
class _Wish:
    """What is to be reached: the arguments of `advise`, and the noise of the observable."""

    observable: str
    accuracy: float
    noise: float
    budget: float | None
    speed_of: SpeedOf


def fluid_of(scene: Scene) -> Gas:
    """The gas of a scene, a fluid in a periodic container. Raises SceneError for a scene whose errors were
    not measured."""
    if not scene.count:
        raise SceneError("count", 0, "advice is for a gas: the scene is empty")
    gas, container = plain_gas(scene), scene.container
    if gas.count < FEWEST:
        raise SceneError("count", gas.count, f"the table is of gases of {FEWEST} particles or more")
    if not gas.temperature > 0.0:
        raise SceneError("temperature", gas.temperature, "advice is for moving particles")
    if not all(container.periodic):
        rule = (
            "advice is for periodic containers: walls change Z, D and the rate; measure the pressure on them"
        )
        raise SceneError("container.boundary", container.boundary, rule)
    lowest = table.lowest(gas.dimension)
    if gas.packing_fraction < lowest:
        rule = f"advice is known from {lowest:g} on: more dilute gases were not measured"
        raise SceneError("packing_fraction", gas.packing_fraction, rule)
    highest = theory.HIGHEST_PACKING_FRACTION[gas.dimension]
    if gas.packing_fraction > highest:
        rule = f"advice is for fluids, up to {highest:g}"
        raise SceneError("packing_fraction", gas.packing_fraction, rule)
    return gas


def is_tabulated(scene: Scene, observable: str) -> bool:
    """Whether errors and costs of an observable of a scene are in the table."""
    try:
        fluid_of(scene)
    except SceneError:
        return False
    return observable in having(tabulated=True)


def advise(
    scene: Scene,
    observable: str,
    accuracy: float,
    budget: float | None = None,
    speed_of: SpeedOf = speed.factor,
) -> Advice:
    """The cheapest setting for a relative `accuracy` (95 % half-width) of an observable: Z, collision_rate or
    D.

    budget: processor time in seconds; if it does not suffice, the most accurate setting within it is advised.
    speed_of: this machine's time over the table's (see `gaspart.accuracy.speed`). An engine that is three
    times as expensive as another one by the table is not timed: it is taken to be as fast as the event-driven
    one.

    Raises SceneError for anything that the table does not cover.
    """
    if observable not in having(tabulated=True):
        raise SceneError("observable", observable, f"must be one of {', '.join(having(tabulated=True))}")
    low, high = ACCURACIES
    rule = f"must be from {low:g} to {high:g}"
    accuracy = number("accuracy", accuracy, rule, least=low, most=high)
    if budget is not None:
        budget = number("budget", budget, "must be positive", above=0.0)
    gas = fluid_of(scene)
    noise = table.noise(gas.dimension, gas.packing_fraction, observable)
    if not math.isfinite(noise):
        raise SceneError(
            "observable", observable, "discs have no diffusion coefficient: it grows with the size"
        )
    settings = _timed(scene, gas, _Wish(observable, accuracy, noise, budget, speed_of))
    best = min(settings, key=lambda made: (max(made.half_width, accuracy * (1.0 + 1e-9)), made.seconds))
    others = tuple(
        min(kind, key=lambda made: made.seconds)
        for kind in (
            [made for made in settings if made.name == name and made is not best]
            for name in ("event", "step", *MODELS)
        )
        if kind
    )
    per_particle = 2.0 * best.contacts / gas.count
    replicas = max(1, min(os.cpu_count() or 1, int(per_particle / (_PER_EQUILIBRATION * EQUILIBRATION))))
    finite_size, power = _finite_size(gas, observable)
    return Advice(
        scene,
        gas,
        observable,
        accuracy,
        best,
        others,
        replicas,
        per_particle / replicas,
        finite_size,
        gas.count * (abs(finite_size) * _BULK / accuracy) ** power,
        0.5 * temperature_scatter(scene),
    )


def _timed(scene: Scene, gas: Gas, wish: _Wish) -> list[Setting]:
    """All settings that are accurate enough, with the times of this machine where these can matter."""
    known = _settings(scene, gas, replace(wish, speed_of=speed.as_measured))
    limit = _WORTH * min(one.seconds for one in known)
    timed = {(one.name, getattr(one.engine, "precision", "float64")) for one in known if one.seconds < limit}

    def speed_of(dimension: int, engine: str, precision: str, count: int) -> float:
        near = (engine, precision) if (engine, precision) in timed else ("event", "float64")
        return wish.speed_of(dimension, *near, count)

    return _settings(scene, gas, replace(wish, speed_of=speed_of))


def _settings(scene: Scene, gas: Gas, wish: _Wish) -> list[Setting]:
    """All that are accurate enough."""
    made = (_setting(scene, gas, wish, engine) for engine in _engines(scene, gas))
    return [one for one in made if one]


def _engines(scene: Scene, gas: Gas) -> Iterator[tuple[Engine, str, float]]:
    """(engine, precision, its time step in the unit that the table has for it) of all settings to compare."""
    yield EventDriven(), "float64", 0.0
    unit = gas.diameter / gas.thermal_speed
    for precision, step in table.steps(gas.dimension):
        yield TimeStepped(step * unit, precision=precision), precision, step
    for name, model in MODELS.items():
        own = DSMC(model=model).resolved(scene)
        for precision, part in table.steps(gas.dimension, name):
            yield own.with_step(part * (own.time_step or 0.0)), precision, part


def _setting(scene: Scene, gas: Gas, wish: _Wish, made: tuple[Engine, str, float]) -> Setting | None:
    """Cost and error of one setting; None if it is too inaccurate or was not measured."""
    engine, precision, step = made
    name, bias = engine.name, 0.0
    if isinstance(engine, DSMC):
        name = next(name for name, model in MODELS.items() if model == engine.model)
        bias = _error_of_model(scene, gas, wish.observable, engine)
    elif engine.name == "step":
        bias = table.bias(gas.dimension, gas.packing_fraction, precision, step, wish.observable)
    room = (wish.accuracy - bias) / QUANTILE
    each = table.seconds(gas.dimension, gas.packing_fraction, name, precision, step)
    if room <= 0.0 or not math.isfinite(each):
        return None
    each *= wish.speed_of(gas.dimension, name, precision, gas.count)
    equilibration = 0.5 * gas.count * EQUILIBRATION
    contacts = max(wish.noise / room**2, 0.5 * gas.count * LEAST)
    if wish.budget is not None:
        contacts = min(contacts, max(wish.budget / each - equilibration, 1.0))
    half_width = bias + QUANTILE * math.sqrt(wish.noise / contacts)
    return Setting(engine, name, bias, contacts, (contacts + equilibration) * each, half_width)


def _error_of_model(scene: Scene, gas: Gas, observable: str, engine: DSMC) -> float:
    """A bound on the error that the DSMC engine makes: by its model, by the cells, and of paths by the steps.
    inf for what its runs say nothing of."""
    try:
        require_modelled(observable, scene, engine)
    except SceneError:
        return math.inf
    bias = model_error(gas.packing_fraction, gas.dimension, engine.model, observable)
    bias += cell_loss(engine, scene)
    step = (engine.time_step or 0.0) * gas.thermal_speed / gas.diameter
    return bias + (step_error(gas.packing_fraction, step) if OBSERVABLES[observable].memory else 0.0)


def _finite_size(gas: Gas, observable: str) -> tuple[float, float]:
    """Relative difference from the infinite gas, to first order, in a periodic container, and the power of it
    that the number of particles grows with for a smaller one."""
    if gas.count < 2:
        return math.nan, 1.0
    found: tuple[float, float] = getattr(finite, OBSERVABLES[observable].bulk)(gas)
    return found
