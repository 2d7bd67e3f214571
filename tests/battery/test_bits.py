"""Bits that do not depend on how a run is made: each kind of scene by each way (`disturbed` has the rows).

A row's engines differ in their search, their partition or their threads. What differs with them is the work.
"""

from dataclasses import replace

import numpy as np
import pytest
from battery.disturbed import ROWS, of_battery
from battery.scaling import engine_in_units, scaled, scene_in_units, state_in_units, tally_in_units
from exact.planting import Plant, planted
from referee import WORK, check_alike, check_same, contents, restored

import gaspart as gp
from gaspart.engines import ENGINES

EVERY = ROWS | of_battery()
PIECES = 60
UNITS = {"mass": 2.0**20, "length": 2.0**-5, "time": 2.0**-10}
"""Old units in new ones: fifth powers of powers of two, which viscoelastic particles need."""

pytestmark = pytest.mark.filterwarnings("ignore:gaspart")  # of steps and cells that are too large


CANONICAL = {"discs", "everything", "stress, mixture", "steps, all faces", "dsmc", "event: piston"}
CANONICAL |= {
    "event: open",
    "event: mixture",
    "step: periodic",
    "dsmc boltzmann: periodic",
    "dsmc enskog: mixture",
}
"""Rows of which `make test` compiles the kernels of the first engine."""
COMPARED = CANONICAL - {"steps, all faces"} | {"steps, dense, periodic"}
"""Rows whose engines `make test` compares."""


def tiered(name, *values, canonical=CANONICAL):
    """The parameters of a row, which is thorough if it is not canonical."""
    return pytest.param(*values, id=name, marks=() if name in canonical else pytest.mark.thorough)


def rows(chosen, canonical=CANONICAL):
    """The rows of a test."""
    found = [tiered(name, row, canonical=canonical) for name, row in EVERY.items() if chosen(row)]
    return pytest.mark.parametrize("row", found)


@rows(lambda row: len(row.engines) > 1, COMPARED)
def test_searches_and_threads_change_no_bit(row):
    """Nor does it if one goes on with what another has begun."""
    begun, *others = (row.simulation(engine, record=True) for engine in row.engines)
    whole = row.simulation(record=True)
    for sim in (whole, *others):
        sim.advance(until=row.until)
    for sim in others:
        check_same(whole, sim, WORK)
        if sim.record_events:
            check_alike(whole.events, sim.events)
    for n, engine in enumerate(row.engines[1:], start=1):
        begun.advance(until=row.until * n / len(row.engines))
        again = row.simulation(engine, record=True)
        again.restore(begun.checkpoint())
        check_same(begun, again, WORK)
        begun = again
    begun.advance(until=row.until)
    check_same(whole, begun, WORK)


@rows(lambda row: True)
def test_splits_and_checkpoints_change_no_bit(row):
    """A run is restored at each stop; another goes in small pieces, and is looked at, after each of
    two. The tally begins anew at the first stop."""
    first, *ends = row.ends
    whole, parts = row.simulation(), row.simulation()
    in_pieces(whole, first)
    parts.advance(until=first)
    for sim in (whole, parts):
        sim.reset_tally()
    for end in ends:
        parts = restored(parts)
        parts.advance(until=end)
    in_pieces(whole, ends[-1])
    for sim in (parts, restored(parts)):
        check_same(whole, sim)
        sim.check_invariants()
    for name in row.sees.split():
        assert np.any(getattr(whole.tally, name)), name


LOST = {
    "spins": "rough spheres",
    "contact_latest": "a column that rests",
    "contact_island": "a column that rests",
    "draws": "hot and cold",
    "wall_draws": "a warm wall",
    "scheduled_number": "kicked spheres",
    "scheduled_next": "kicked",
    "piston": "event: piston",
    "vibrations": "vibrating scatterers",
    "entry_next": "event: open",
    "present": "dsmc, open faces",
    "per_area": "two masses",
    "stress": "stress, mixture",
    "sums": "discs",
    "images": "discs",
    "held": "steps, all faces",
}
"""Array of a checkpoint -> a row that needs it."""


@pytest.mark.parametrize(("key", "name"), [tiered(name, key, name) for key, name in LOST.items()])
def test_an_array_that_a_checkpoint_loses_is_noticed(key, name):
    """The referee of the rows: with this error planted, they fail."""
    whole = "if key in required:"
    plant = Plant(key, "engines.dynamics", whole, f"{whole[:-1]} and key != {key!r}:", ())
    with planted(plant), pytest.raises((AssertionError, gp.SimulationError)):
        test_splits_and_checkpoints_change_no_bit(EVERY[name])


def in_pieces(sim, end):
    """Advance to a time in unequal pieces: of bounded work first, if the engine has it."""
    begin = sim.time
    for n in range(1, PIECES):
        if sim.engine.records_events:
            sim.advance(until=end, max_work=1 + n % 5)
        else:
            sim.advance(until=begin + (n / PIECES) ** 2 * (end - begin))
        assert len(sim.state.positions) == sim.state.count and sim.tally.time <= end
    sim.advance(until=end)


@rows(lambda row: row.until)
def test_units_of_powers_of_two_change_no_bit(row):
    """Larger ones and smaller ones in turn."""
    power = 1 if list(EVERY.values()).index(row) % 2 else -1
    units = {unit: factor**power for unit, factor in UNITS.items()}
    tallies = [replace(tally, **scaled(vars(tally), units)) for tally in row.tallies]
    one = row.simulation()
    other = row.simulation(
        engine_in_units(one.engine, units), scene=scene_in_units(row.scene, units), tallies=tallies
    )
    one.advance(until=row.until)
    other.advance(until=row.until * units["time"])
    state, tally = state_in_units(one.state, units), tally_in_units(one.tally, row.scene.dimension, units)
    check_alike(contents(state, tally), contents(other.state, other.tally))


@rows(lambda row: row.tallies)
def test_tallies_change_no_bit(row):
    bare, whole = row.simulation(tallies=()), row.simulation()
    for sim in (bare, whole):
        sim.advance(until=row.until)
    expected, found = contents(bare.state, bare.tally), contents(whole.state, whole.tally)
    added = {name for name, value in found.items() if value is not None and expected[name] is None}
    assert any(np.any(found[name]) for name in added)
    check_alike(expected, found | dict.fromkeys(added))


@rows(lambda row: True)
def test_a_file_has_the_scene(row, tmp_path):
    path = tmp_path / "scene.yaml"
    row.scene.to_file(path)
    assert gp.Scene.from_file(path) == row.scene


def test_each_feature_has_a_row():
    """Under each engine that models it."""
    for name, kind in ENGINES.items():
        scenes = [row.scene for row in EVERY.values() if row.engines[0].name == name]
        present = {feature for scene in scenes for feature in scene.features}
        assert present == set(kind.models), name
