"""Options from the table, for fluids and observables with measured errors, noise and CPU times.

A row of the table replaces a pilot run. Its noise is per contact instead of per time, and its CPU time is for
the machine of the table. Looking up a row runs and compiles nothing.
"""

from __future__ import annotations

import math
from dataclasses import replace

from gaspart import theory
from gaspart.accuracy import table
from gaspart.accuracy.advisers import adviser_of, timed_as
from gaspart.accuracy.of_engine import Candidate
from gaspart.accuracy.option import Option, fluid_option, sort_by_cost
from gaspart.accuracy.target import Target
from gaspart.analysis.observables import OBSERVABLES, observables_with
from gaspart.engines import Engine
from gaspart.errors import SceneError
from gaspart.scene.facts import Gas, plain_gas
from gaspart.scene.scene import Scene
from gaspart.theory import bulk
from gaspart.theory.diffusion import ERPENBECK_WOOD_UNCERTAINTY

# Errors of a gas in equilibrium due to the kinetic equation and the time step, from theory.


def model_error(packing_fraction: float, dimension: int, equation: str, observable: str) -> float:
    """Return the absolute error of an observable due to the kinetic equation that an engine solves.
    `equation` is `Engine.equation`. The error is relative to hard spheres or discs. It is inf if the
    observable is undefined in either case, such as D of discs. The Boltzmann equation has a contact value of
    1 and no virial pressure. The Enskog model uses the contact value of Carnahan and Starling for spheres and
    of Henderson for discs. Neither equation includes the effect of correlated collisions on D [Erpenbeck
    1991]; the uncertainty of this effect is added.
    """
    if equation == bulk.EXACT:
        return 0.0
    gas = Gas(dimension, packing_fraction, 1, 1.0, 1.0)
    of = getattr(bulk, OBSERVABLES[observable].bulk)
    exact, own = of(gas, bulk.EXACT), of(gas, equation)
    if math.isnan(exact) or math.isnan(own):
        return math.inf
    remembers = OBSERVABLES[observable].memory and packing_fraction > 0.01
    return abs(own / exact - 1.0) + (ERPENBECK_WOOD_UNCERTAINTY if remembers else 0.0)


FEWEST = 64
"""Minimum number of particles of a gas for which the table applies, with an error of at most 1 % of Z - 1.

For smaller gases pilot runs are made.
"""


def fluid_of(scene: Scene) -> Gas:
    """Return the periodic fluid of a scene; SceneError if its errors were not measured."""
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
    """Return the gas of a scene and the target; SceneError if the table does not cover them."""
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
    """Return the cheapest option of each engine over all measured settings, the best first."""
    options = [
        _option(target, adviser_of(engine).at_step(target.scene, step, precision), accuracy, budget, step)
        for engine in engines
        for precision, step in table.steps(target.scene.dimension, timed_as(engine))
    ]
    best: dict[str, Option] = {}
    for option in sort_by_cost(
        [option for option in options if math.isfinite(option.speed) and option.bias < accuracy]
    ):
        best.setdefault(timed_as(option.engine), option)
    return list(best.values())


def _option(target: Target, engine: Engine, accuracy: float, budget: float | None, step: float) -> Option:
    """Return the option of an engine with a row of the table, whose unit `step` has."""
    gas = fluid_of(target.scene)
    each = table.seconds(gas.dimension, gas.packing_fraction, timed_as(engine), engine.precision, step)
    noise = table.noise(gas.dimension, gas.packing_fraction, target.observable)
    value = value_of(gas, target.observable)
    option = fluid_option(gas, _with_bounds(target, engine, gas, step), each, noise, accuracy, value)
    return option if budget is None else replace(option, most=budget / option.speed)


def _with_bounds(target: Target, engine: Engine, gas: Gas, step: float) -> Candidate:
    """Return the engine with measured or theoretical bounds on its errors, of equation, cells and steps."""
    observable, row = target.observable, (gas.dimension, gas.packing_fraction)
    if table.has_biases(timed_as(engine)):
        error = table.bias(*row, engine.precision, step, observable, timed_as(engine))
        return Candidate(engine, discretisation=error)
    model = model_error(gas.packing_fraction, gas.dimension, engine.equation, observable)
    kind = "paths" if OBSERVABLES[observable].memory else "rates"
    return Candidate(engine, model, engine.bias(target.scene, kind))


def value_of(gas: Gas, observable: str) -> float:
    """Compute the value of an observable from theory."""
    return float(getattr(bulk, OBSERVABLES[observable].bulk)(gas, bulk.EXACT))
