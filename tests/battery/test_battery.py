"""Each observable, under each engine, in each kind of scene, seen otherwise: the same, or as it declares.

`kinds_of_runs` has the runs, `symmetries` what is done with their files, `twins` what is done with their
start, `table` the page of the site."""

from collections import Counter
from itertools import product

import pytest
from battery import table
from battery.kinds_of_runs import CANONICAL, KINDS, KNOWN_BY_OTHERS, by_run, engines, recorded, runs
from battery.observed import MEANS, SAMPLED, SINGLE, WITHOUT_NAME, names

from gaspart.analysis.observables import observables_with
from gaspart.engines import ENGINES
from gaspart.inspection.energy import energy_line
from gaspart.scene.features import FEATURES

RUNS, NOT_MODELLED = runs()
ELSEWHERE = {
    "roughness": "tests/engines/test_metamorphic.py",
    "viscoelasticity": "tests/battery/test_bits.py",
    "contact_duration": "tests/battery/test_bits.py",
    "fixed": "tests/engines/test_metamorphic.py",
    "centres_to_walls": "tests/battery/test_bits.py",
    "well": "tests/battery/test_bits.py",
    "sticky": "tests/battery/test_bits.py",
    "vibrations": "tests/battery/test_bits.py",
}
"""Features of scenes that the battery has not, and the tests of their symmetries."""


@by_run(RUNS, without=KNOWN_BY_OTHERS)
def test_observables_change_as_they_state(engine, name):
    broken = [cell for cell in table.cells(engine, name) if cell.state == "broken"]
    assert not broken, "\n".join(
        f"{cell.observable}, {cell.symmetry}: {cell.text or f'{cell.deviation:.2g} {cell.unit}'}"
        for cell in broken
    )


@by_run(RUNS)
def test_runs_from_the_same_state_are_the_same(engine, name):
    broken = [pair for pair in table.pairs(engine, name) if pair.state == "broken"]
    assert not broken, "\n".join(f"{pair.symmetry}: {pair.text} {pair.deviation:.2g}" for pair in broken)


EXCHANGE = ("open", "walls", "gravity", "lees_edwards", "plates", "piston", "compressed", "vibrating")
EXCHANGE += ("thermostat", "parted", "warm", "ramp")
CONSERVING = [(engine, name) for engine, name in RUNS if name in EXCHANGE]


@by_run(CONSERVING)
def test_the_energy_less_what_was_exchanged_is_constant(engine, name):
    """The referee is a face or a contact that is forgotten: then it is not."""
    data, scene = recorded(engine, name)["frames"], KINDS[name].scene
    drift = float(energy_line(scene, data).split()[4])
    assert drift < 1e-10
    for counter in ("dissipated_energy", "wall_energy", "thermostat_energy"):
        if data[counter].values[-1].any():
            forgotten = data.assign({counter: 0.999 * data[counter]})
            assert float(energy_line(scene, forgotten).split()[4]) > 1e-6


def test_nothing_is_left_out():
    """Neither an observable, nor an engine, nor a feature of scenes, nor a symmetry."""
    assert {settings.name for settings in engines(1.0).values()} == set(ENGINES)
    present = {feature for kind in KINDS.values() for feature in kind.scene.features}
    assert present | set(ELSEWHERE) == set(FEATURES)
    assert set(RUNS) | set(NOT_MODELLED) == set(product(engines(1.0), KINDS))
    assert set(CANONICAL) <= set(RUNS)


@pytest.mark.thorough
def test_every_run_has_every_cell():
    everything = set(product(names(), table.SYMMETRIES))
    for engine, name in RUNS:
        counted = Counter((cell.observable, cell.symmetry) for cell in table.cells(engine, name))
        assert set(counted) == everything and set(counted.values()) == {1}, (engine, name)


@pytest.mark.thorough
def test_every_observable_is_tested_by_every_symmetry_somewhere():
    """A reason that holds everywhere would hide that a cell is never looked at."""
    tested = {
        (cell.observable, cell.symmetry)
        for run in RUNS
        for cell in table.cells(*run)
        if cell.state == "tested"
    }
    never = set(product(names(), table.SYMMETRIES)) - tested
    split = {
        (name, "one species")
        for name in (*observables_with(merged="split"), *observables_with(merged="lost"), "by_species")
    }
    kept = [name for name in names() if name.startswith("accumulated") or name in table.FLUXES]
    short = {("mutual_diffusion", "parts")}  # of so short a run there is none
    halves = {("pressure by impulses", "one species")}  # the run of two halves has no walls
    open_gas = {("number", "moving"), ("number", "one species")}  # open faces are at rest, of one species
    assert never == split | short | halves | open_gas | {(name, "simulation") for name in kept}


def test_exceptions_are_of_observables_that_exist():
    known = set(names())
    assert {name for name, _ in SAMPLED} | set(SINGLE) | set(MEANS) | set(WITHOUT_NAME) <= known
