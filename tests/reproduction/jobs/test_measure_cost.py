"""Counted work against exact numbers, and what a timing holds."""

import pytest
import xarray as xr
from numba import config

from gaspart.engines import DSMC, EventDriven, TimeStepped
from gaspart.errors import SceneError, SimulationError
from gaspart.reproduction.figures.box_count import expected_box_visits, expected_pair_tests
from gaspart.reproduction.jobs import measure_cost as cost
from gaspart.reproduction.jobs.measure_cost import measure_cost
from gaspart.reproduction.points.point import Point
from gaspart.scene.container import Container
from gaspart.scene.scene import Scene
from gaspart.scene.species import Species

GAS = Scene(Container((20.0,) * 3), species=(Species(400, 0.1, speed=1.0),))
DISCS = Scene(Container((30.0,) * 2), species=(Species(40, 0.5, speed=1.0),))


def measured(engines, scene=GAS, equilibration=0.0, interval=0.1, samples=2):
    return xr.Dataset(*measure_cost(scene, engines, (1, 2), equilibration, interval, samples))


def test_one_box_tests_each_pair_once():
    run = measured([TimeStepped(0.01, boxes_per_side=1, passes=1)])
    assert run.steps.values.tolist() == [10]
    assert run.pair_tests.values.tolist() == [10 * 400 * 399 // 2]
    assert run.box_visits.values.tolist() == [10 * 400]


def test_boxes_follow_the_uniform_density():
    sides = [2, 4, 8, 20]
    run = measured([TimeStepped(0.01, boxes_per_side=n, passes=1) for n in sides], samples=1)
    assert run.boxes.values.tolist() == [n**3 for n in sides]
    for n, part in enumerate(sides):
        mean, spread = expected_pair_tests(400, part, 3, 20.0, 0.1)
        assert run.pair_tests.values[n] / 10 == pytest.approx(mean, abs=4.0 * spread + 1e-9)
        visits = expected_box_visits(part, 3, 20.0, 0.1)
        assert run.box_visits.values[n] / 4000 == pytest.approx(visits, rel=0.05)


def test_every_partition_starts_from_the_same_state_and_is_timed_as_often():
    run = measured(
        [TimeStepped(0.01, boxes_per_side=n, passes=1) for n in (1, 10)], samples=3, equilibration=0.05
    )
    assert run.seconds.shape == (2, 3)
    assert (run.seconds > 0.0).all()
    assert run.collisions.values[0] == run.collisions.values[1]
    assert run.duration.values == pytest.approx(0.1)
    assert run.attrs["count"] == 400


def test_short_steps_do_not_start_from_what_long_ones_left():
    dense = Scene(Container((10.0,) * 3, "periodic"), species=(Species(570, 0.5, temperature=1.0),))
    steps = (0.2, 0.01)
    run = measured([TimeStepped(step) for step in steps], dense, equilibration=1.6, interval=0.4, samples=1)
    alone = measured([TimeStepped(0.01)], dense, equilibration=1.6, interval=0.4, samples=1)
    assert run.collisions.values[1] == alone.collisions.values[0]


def test_a_rival_is_timed_with_engines_of_its_own():
    """The same gas, searched in all boxes instead of those within reach: from the same state."""
    near = [TimeStepped(0.01, boxes_per_side=n, passes=1, near_boxes=True) for n in (4, 8)]
    wide = [TimeStepped(0.01, boxes_per_side=n, passes=1) for n in (4, 8)]
    run = xr.Dataset(*measure_cost(GAS, near, (1, 2), 0.05, 0.1, 2, rival={"scene": GAS, "engines": wide}))
    assert run.seconds.shape == (4, 2)
    assert run.boxes_per_side.values.tolist() == [4, 8, 4, 8]
    assert len(set(run.collisions.values.tolist())) == 1
    assert (run.box_visits.values[:2] < 0.3 * run.box_visits.values[2:]).all()
    assert run.pair_tests.values[2:].tolist() == measured(wide, equilibration=0.05).pair_tests.values.tolist()


def test_work_that_differs_between_repeats_is_an_error(monkeypatch):
    timed, counts = cost._time, iter([{"steps": 1}, {"steps": 2}])
    monkeypatch.setattr(cost, "_time", lambda *given: (timed(*given)[0], next(counts)))
    with pytest.raises(SimulationError, match="twice"):
        measured([TimeStepped(0.01, boxes_per_side=4)])


def test_parts_of_the_step_that_the_scene_gives():
    """Half the step, twice as many; an engine that has no step of its own takes the scene's."""
    gas = {"dimension": 3, "count": 200, "radius": 0.5, "packing_fraction": 0.01, "boundary": "periodic"}
    run = {
        "temperature": 1.0,
        "engine": "dsmc",
        "collisions_per_particle": 20,
        "equilibration": 1,
        "samples": 2,
    }
    scanned = Point("gas", "a", "measure_cost", gas | run | {"scan_step_parts": [1, 0.5]}, ".", 1)
    whole, half = (engine.time_step for engine in scanned.engines)
    assert whole == DSMC().for_scene(scanned.scene).time_step == 2.0 * half
    found = measure_cost(**scanned.arguments)
    steps = found.variables["steps"][1]
    assert steps[1] == pytest.approx(2 * steps[0], abs=2)
    assert found.attributes["engine"] == "dsmc" and found.attributes["model"] == "boltzmann"
    alone = measure_cost(**Point("gas", "a", "measure_cost", gas | run, ".", 1).arguments)
    assert alone.variables["steps"][1] == steps[:1]


@pytest.mark.thorough
def test_several_cores_have_the_bits_of_one_and_are_timed_by_the_wall():
    alone = {"scene": GAS, "engines": [TimeStepped(0.01)]}
    for engine, extras in (TimeStepped(0.01, threads=2), {}), (TimeStepped(0.01), {"copies": 2}):
        run = xr.Dataset(*measure_cost(GAS, [engine], (1, 2), 0.0, 0.1, 2, extras, alone))
        assert run.cores.values.tolist() == [2, 1]
        assert run.bits.values[0] == run.bits.values[1]
    longer = measured([TimeStepped(0.01)], interval=0.2)
    assert longer.bits.values[0] != run.bits.values[0]
    assert (longer.wall_seconds > 0.0).all()


def test_runs_that_need_more_cores_than_there_are_are_not_timed(monkeypatch):
    monkeypatch.setattr(config, "NUMBA_NUM_THREADS", 3)
    run = xr.Dataset(*measure_cost(DISCS, [EventDriven()], (1, 2), 0.0, 1.0, 5, {"copies": 4}))
    assert run.attrs["cores"] == 3 and run.cores.values.tolist() == [4]
    assert run.seconds.shape == (1, 1) and run.seconds.isnull().all() and run.wall_seconds.isnull().all()
    assert run.collisions.values[0] > 0


def test_runs_at_once_have_one_thread_each():
    gas = {"dimension": 3, "count": 20, "radius": 0.5, "packing_fraction": 0.01, "boundary": "periodic"}
    run = {"temperature": 1.0, "engine": "step", "time_step": 0.01, "steps": 1, "threads": 2, "copies": 2}
    with pytest.raises(SceneError, match="one thread each"):
        _ = Point("gas", "a", "measure_cost", gas | run, ".", 1).arguments


def test_runs_at_once_that_differ_are_an_error(monkeypatch):
    counts = iter([{"steps": 1}, {"steps": 2}])
    monkeypatch.setattr(cost, "_count", lambda dynamics: next(counts))
    with pytest.raises(SimulationError, match="at once"):
        measure_cost(DISCS, [EventDriven()], (1, 2), 0.0, 1.0, 1, {"copies": 2})
