"""Planted errors are caught, each by the cell that it names: a tenth of them in `make test`."""

from collections import Counter
from contextlib import contextmanager

import pytest
from battery import symmetries
from battery import table as battery_table
from battery.kinds_of_runs import CANONICAL
from exact import runs, table
from exact.choice import chosen, is_canonical
from exact.kinds import kinds
from exact.planting import NotPlanted, Plant, planted
from exact.plants import PLANTS as OF_ANALYSIS
from exact.plants_of_engines import ENGINE_PLANTS

from gaspart.analysis.observables import OBSERVABLES
from gaspart.errors import SimulationError

RIGHT = ("value", "tested", "refused", "unknown")
"""States of cells that are right: a theory beside an unknown value must agree with the run."""
PLANTS = [*OF_ANALYSIS, *ENGINE_PLANTS]


def of_canonical_kernels(plant):
    """Return True if `make test` compiles the kernels that show an error anyway."""
    if plant.battery:
        return ("event", plant.cell[1]) in CANONICAL
    scene, _, *engine = plant.cell
    return is_canonical(scene, *engine)


SHARE = 10
"""One of this number of errors is planted in `make test`."""


def battery_state(symmetry, scene, observable):
    """Return the state of a cell of the battery, under the event-driven engine."""
    symmetries.plain.cache_clear()
    try:
        for part in (symmetries.of_views, symmetries.in_units, symmetries.of_parts, symmetries.of_simulation):
            for cell in part("event", scene, [observable]):
                if cell.symmetry == symmetry:
                    return cell.state
    finally:
        symmetries.plain.cache_clear()
    raise AssertionError(f"{symmetry} is no symmetry of views, units, parts or simulations")


def state(plant):
    """Return the state of the cell that a plant names."""
    if plant.battery:
        return battery_state(*plant.cell)
    scene, observable, *engine = plant.cell
    try:
        return table.cell_of(observable, kinds()[scene], *engine).state
    except (SimulationError, ValueError):  # the run stops itself, or its numbers are none
        return "broken"


@contextmanager
def runs_again(plant):
    """Forget all runs before and after, if a planted error changes an engine."""
    caches = (runs.recorded, runs.refusal) if plant.module.startswith("engines") else ()
    for cache in caches:
        cache.cache_clear()
    yield
    for cache in caches:
        cache.cache_clear()


def check(plant):
    """Raise AssertionError unless the named cell is right without a planted error and wrong with it."""
    assert state(plant) in RIGHT, f"{plant.name}: its cell is not right without it"
    with planted(plant), runs_again(plant):
        assert state(plant) in ("wrong", "broken"), f"{plant.name} is not caught by {plant.cell}"


@pytest.mark.thorough
@pytest.mark.parametrize("plant", PLANTS, ids=[plant.name for plant in PLANTS])
def test_planted_errors_are_caught(plant):
    check(plant)


@pytest.mark.parametrize(
    "plant",
    chosen([*filter(of_canonical_kernels, PLANTS)], len(PLANTS) // SHARE),
    ids=lambda plant: plant.name,
)
def test_a_tenth_of_the_planted_errors_is_caught(plant):
    check(plant)


def test_all_pieces_of_source_are_there():
    for plant in PLANTS:
        with planted(plant):
            pass


def test_each_observable_has_two_planted_errors():
    found = Counter(plant.cell[2 if plant.battery else 1] for plant in PLANTS)
    assert len(PLANTS) >= 60
    assert {name for name in OBSERVABLES if found[name] < 2} == set()
    assert all(cell[0] in (*kinds(), *battery_table.SYMMETRIES) for cell in (plant.cell for plant in PLANTS))


def test_a_piece_that_is_gone_or_changes_nothing_is_an_error():
    for old, new in (
        ("no such piece", "x"),
        ('"""The rule of motion', '"""A rule of motion'),
    ):
        with pytest.raises(NotPlanted), planted(Plant("none", "analysis.flow", old, new, ("periodic", "Z"))):
            pass
