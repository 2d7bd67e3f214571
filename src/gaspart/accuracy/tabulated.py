"""Options from the table, for fluids and observables whose errors, noise and times were measured.

A row of the table is a stored pilot: its noise is given per contact instead of per time, and its CPU time is
for the machine of the table. Nothing is run or compiled for a look-up.
"""

from __future__ import annotations

import math
from dataclasses import replace

from gaspart import theory
from gaspart.accuracy import table
from gaspart.accuracy.option import Option, fluid_option, sort_by_cost
from gaspart.accuracy.target import Target
from gaspart.analysis import bulk
from gaspart.analysis.observables import OBSERVABLES, observables_with
from gaspart.engines import Engine
from gaspart.engines.engine import Candidate
from gaspart.errors import SceneError
from gaspart.scene.gas import Gas, plain_gas
from gaspart.scene.scene import Scene

# Errors of equations and of steps in a gas in equilibrium, by theory.


def model_error(packing_fraction: float, dimension: int, equation: str, observable: str) -> float:
    """Return the |error| of an observable due to the equation that an engine solves.

    The equation is `Engine.equation`. The error is relative to hard spheres or discs. It is inf if one of the
    two has no value, like D of discs. The Boltzmann equation has a contact value of 1, and no virial. The
    Enskog model uses the contact value of Carnahan and Starling, in two dimensions the value of Henderson. In
    neither does D have the memory of correlated collisions [Erpenbeck 1991], whose uncertainty is added.
    """
    if equation == bulk.EXACT:
        return 0.0
    gas = Gas(dimension, packing_fraction, 1, 1.0, 1.0)
    of = getattr(bulk, OBSERVABLES[observable].bulk)
    exact, own = of(gas, bulk.EXACT), of(gas, equation)
    if math.isnan(exact) or math.isnan(own):
        return math.inf
    remembers = OBSERVABLES[observable].memory and packing_fraction > 0.01
    return abs(own / exact - 1.0) + (theory.ERPENBECK_WOOD_UNCERTAINTY if remembers else 0.0)


FEWEST = 64
"""Minimum number of particles of a gas to which the table applies, to 1 % of Z - 1.

Smaller gases have pilots of their own.
"""


def fluid_of(scene: Scene) -> Gas:
    """Return the gas of a scene, a fluid in a periodic container.

    Raises SceneError for a scene whose errors were not measured.
    """
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


def tabulated_target(scene: Scene, observable: str) -> tuple[Gas, Target]:
    """Return the gas of a scene, and the target to measure.

    Raises SceneError for a scene, and an observable, that the table does not cover.
    """
    if observable not in observables_with(tabulated=True):
        raise SceneError(
            "observable", observable, f"must be one of {', '.join(observables_with(tabulated=True))}"
        )
    return fluid_of(scene), Target.from_name(scene, observable)


def is_tabulated(scene: Scene, observable: str) -> bool:
    """Return True if errors and costs of an observable of a scene are in the table."""
    try:
        tabulated_target(scene, observable)
    except SceneError:
        return False
    return True


def options_of(target: Target, engines: list[Engine], accuracy: float, budget: float | None) -> list[Option]:
    """Return the cheapest option of each engine, of all settings that were measured, the best first."""
    options = [
        _option(target, engine.at_step(target.scene, step, precision), accuracy, budget, step)
        for engine in engines
        for precision, step in table.steps(target.scene.dimension, engine.timed_as)
    ]
    best: dict[str, Option] = {}
    for option in sort_by_cost(
        [option for option in options if math.isfinite(option.speed) and option.bias < accuracy]
    ):
        best.setdefault(option.engine.timed_as, option)
    return list(best.values())


def _option(target: Target, engine: Engine, accuracy: float, budget: float | None, step: float) -> Option:
    """Return the option of an engine with the settings of a row of the table.

    `step` is in the unit of the table.
    """
    gas = fluid_of(target.scene)
    each = table.seconds(gas.dimension, gas.packing_fraction, engine.timed_as, engine.precision, step)
    noise = table.noise(gas.dimension, gas.packing_fraction, target.observable)
    value = value_of(gas, target.observable)
    option = fluid_option(gas, _with_bounds(target, engine, gas, step), each, noise, accuracy, value)
    return option if budget is None else replace(option, most=budget / option.speed)


def _with_bounds(target: Target, engine: Engine, gas: Gas, step: float) -> Candidate:
    """Return the engine with bounds of its errors, measured or by theory.

    From theory these are the errors of its equation, and the errors of its cells and steps as computed by the
    engine.
    """
    observable, row = target.observable, (gas.dimension, gas.packing_fraction)
    if table.has_biases(engine.timed_as):
        error = table.bias(*row, engine.precision, step, observable, engine.timed_as)
        return Candidate(engine, discretisation=error)
    model = model_error(gas.packing_fraction, gas.dimension, engine.equation, observable)
    kind = "paths" if OBSERVABLES[observable].memory else "rates"
    return Candidate(engine, model, engine.bias(target.scene, kind))


def value_of(gas: Gas, observable: str) -> float:
    """Compute an observable by theory."""
    return float(getattr(bulk, OBSERVABLES[observable].bulk)(gas, bulk.EXACT))
