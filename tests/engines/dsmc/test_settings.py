"""What the DSMC engine chooses, warns of and refuses."""

import math
import warnings

import pytest
from scenes import gas

import gaspart as gp
from gaspart import theory
from gaspart.engines.dsmc.defaults import Rates, cells_for, predicted_error, rates

BOX = gp.Container((10.0, 10.0, 10.0))
FEW = gp.Species(20, 0.1, temperature=1.0)


@pytest.mark.parametrize("dimension", [2, 3])
def test_rates_are_those_of_theory(dimension):
    scene = gas(dimension, 20000, 0.01)
    found = rates(scene, dense=True)
    assert found.path == pytest.approx(float(theory.mean_free_path(0.01, dimension)), rel=0.02)
    assert found.speed == pytest.approx(float(theory.mean_speed(dimension)), rel=0.02)


def test_cells_are_a_third_of_a_path_or_hold_sixteen_or_eight():
    for side, count, path, cells in (
        (3.0, 10_000, 1.0, 9),  # a third of a path
        (30.0, 300_000, 10.0, 26),  # 16 in a cell
        (30.0, 20_000, 1.0, 13),  # 8 in a cell
    ):
        container = gp.Container((side,) * 3, "periodic")
        scene = gp.Scene(container, [gp.Species(count, 0.001)])
        assert cells_for(gp.DSMC(), scene, Rates(1.0 / path, 1.0, path)) == (cells,) * 3


def test_the_predicted_error_is_that_of_the_literature():
    scene = gas(3, 1000, 0.001)
    found = Rates(1.0, math.sqrt(8.0 / math.pi), math.sqrt(8.0 / math.pi))
    side = scene.container.lengths[0]
    cells = 4
    width = side / cells / found.path
    expected = 16.0 / (45.0 * math.pi) * width**2
    assert predicted_error((cells,) * 3, 1e-9, scene, found) == pytest.approx(expected)
    moved = math.sqrt(2.0) * 0.5 / found.path
    expected += 16.0 / (75.0 * math.pi) * moved**2
    assert predicted_error((cells,) * 3, 0.5, scene, found) == pytest.approx(expected)


def test_coarse_settings_are_warned_of_with_those_that_would_do():
    scene = gas(3, 20000, 0.001)
    with pytest.warns(UserWarning, match=r"time_step = 100 is .* mean free times .* a step of .* would do"):
        gp.Simulation(scene, gp.DSMC(time_step=100.0))
    with pytest.warns(
        UserWarning, match=r"cells_per_side = \(1, 1, 1\) gives .* mean free paths .* would do"
    ):
        gp.Simulation(scene, gp.DSMC(cells_per_side=1))
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        gp.Simulation(scene, gp.DSMC())


@pytest.mark.parametrize(
    ("key", "scene", "alternative"),
    [
        ("faces.x_low", gp.Scene(BOX, [FEW], faces={"x_low": gp.Well(1.0, 0.1)}), '"step"'),
        ("faces.x_low", gp.Scene(BOX, [FEW], faces={"x_low": gp.Sticky(1.0)}), '"step"'),
        ("faces.x_low", gp.Scene(BOX, [FEW], faces={"x_low": gp.Vibrating(0.1, 1.0)}), '"event"'),
        ("faces.x_low", gp.Scene(BOX, [FEW], faces={"x_low": gp.Piston(10.0, 1.0)}), '"event"'),
        ("fixed", gp.Scene(BOX, [FEW, gp.Species(2, 0.1, fixed=True)]), '"step"'),
        ("radius", gp.Scene(BOX, [FEW, gp.Species(2, 1.0, temperature=1.0)]), '"step"'),
        (
            "restitution.contact_duration",
            gp.Scene(BOX, [FEW], restitution=gp.Restitution(0.9, contact_duration=0.1)),
            '"event"',
        ),
        (
            "walls",
            gp.Scene(gp.Container((9.0, 9.0)), [FEW], walls=[gp.Wall((2.0, 2.0), (4.0, 4.0))]),
            '"event"',
        ),
    ],
)
def test_what_it_does_not_model_is_refused_with_an_alternative(key, scene, alternative):
    with pytest.raises(gp.SceneError) as refused:
        gp.Simulation(scene, gp.DSMC(time_step=0.1))
    assert refused.value.key == key
    assert alternative in refused.value.rule
    assert "\n" not in str(refused.value)


@pytest.mark.parametrize(
    ("settings", "key"),
    [
        ({"time_step": 0.0}, "time_step"),
        ({"time_step": math.nan}, "time_step"),
        ({"cells_per_side": 0}, "cells_per_side"),
        ({"cells_per_side": (2, 0, 1)}, "cells_per_side"),
        ({"cells_per_side": 2**30}, "cells_per_side"),
        ({"model": "navier"}, "model"),
        ({"threads": 0}, "threads"),
    ],
)
def test_impossible_settings_are_refused(settings, key):
    with pytest.raises(gp.SceneError) as refused:
        gp.DSMC(**settings)
    assert refused.value.key == key


def test_settings_are_refused_that_do_not_fit_the_scene():
    scene = gp.Scene(BOX, [FEW])
    with pytest.raises(gp.SceneError, match="for each of 3 axes"):
        gp.Simulation(scene, gp.DSMC(cells_per_side=(2, 2)))
    still = gp.Scene(BOX, [gp.Species(5, 0.1)])
    with pytest.raises(gp.SceneError, match="start at rest"):
        gp.Simulation(still, gp.DSMC())
    sim = gp.Simulation(scene, gp.DSMC())
    for limits in ({"max_events": 3}, {"duration": 1.0, "max_work": 3}):
        with pytest.raises(gp.SceneError, match='"event"'):
            sim.advance(**limits)


def test_an_engine_is_a_mapping_and_back():
    engine = gp.engine_from_dict({"name": "dsmc", "cells_per_side": [2, 3, 4], "model": "enskog"})
    assert engine == gp.DSMC(cells_per_side=(2, 3, 4), model="enskog")
    assert gp.engine_from_dict(gp.engine_to_dict(engine)) == engine


def test_an_empty_scene_and_one_particle():
    for count in (0, 1):
        scene = gp.Scene(BOX, [gp.Species(count, 0.1, temperature=1.0)])
        sim = gp.Simulation(scene, gp.DSMC(time_step=0.5))
        sim.advance(duration=20.0)
        assert sim.tally.collisions == 0
        assert sim.tally.steps == 40
