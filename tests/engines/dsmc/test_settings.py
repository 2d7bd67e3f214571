"""What the DSMC engine chooses, warns of and refuses."""

import math
import warnings
from dataclasses import replace

import numpy as np
import pytest
from scenes import gas

import gaspart as gp
from gaspart import theory
from gaspart.engines.dsmc.cells import Medium
from gaspart.theory.rates import Rates, rates

BOX = gp.Container((10.0, 10.0, 10.0))
FEW = gp.Species(20, 0.1, temperature=1.0)


@pytest.mark.parametrize("dimension", [2, 3])
def test_rates_are_those_of_theory(dimension):
    scene = gas(dimension, 20000, 0.01)
    found = rates(scene, dense=True)
    assert found.path == pytest.approx(float(theory.mean_free_path(0.01, dimension)), rel=0.02)
    assert found.speed == pytest.approx(float(theory.mean_speed(dimension)), rel=0.02)


SLIDING = {"z_low": gp.Thermal(1.0), "z_high": gp.Thermal(1.0, velocity=(0.5, 0.0, 0.0))}


def plates(radius=0.178, faces=SLIDING, **more):
    """A gas between plates, eleven mean free paths apart."""
    container = gp.Container((10.0, 10.0, 10.0), ("periodic", "periodic", "wall"))
    return gp.Scene(container, [gp.Species(2000, radius, temperature=1.0)], faces=faces, **more)


def of_scene(scene, **settings):
    """The engine's choice for a scene: the gas, the cells and the step."""
    return gp.DSMC(**settings)._chosen(scene)


@pytest.mark.parametrize("model", ["boltzmann", "enskog"])
def test_cells_are_layers_where_the_gas_varies_across_walls_alone(model):
    """Also in a channel and in equilibrium, but not where rolls or clusters can form."""
    hot = {**SLIDING, "z_low": gp.Thermal(2.0)}
    lossy = gp.Restitution(0.9)
    down, along = (0.0, 0.0, -0.1), (0.1, 0.0, 0.0)
    for scene in (plates(), plates(gravity=along), plates(faces={}), plates(faces={}, gravity=down)):
        assert of_scene(scene, model=model)[1][:2] == (1, 1)
    for scene in (plates(faces=hot, gravity=down), plates(faces={}, restitution=lossy)):
        assert min(of_scene(scene, model=model)[1]) > 1
    x, y, z = of_scene(gas(3, 2000, 0.01), model=model)[1]
    assert x == y == z > 1


@pytest.mark.parametrize(
    ("scene", "model"),
    [(plates(), "boltzmann"), (plates(), "enskog"), (gas(3, 20000, 0.001), "boltzmann")],
)
def test_no_other_cells_have_smaller_errors(scene, model):
    medium, cells, step = of_scene(scene, model=model)
    chosen = medium.errors(cells, step).total
    for number in range(1, 100):
        other = tuple(1 if n == 1 else number for n in cells)
        assert medium.errors(other, step).total > 0.98 * chosen


def test_the_predicted_error_is_that_of_the_literature():
    scene = gas(3, 1000, 0.001)
    speed = math.sqrt(8.0 / math.pi)
    medium = Medium("boltzmann", scene, Rates(1.0, speed, speed), 1000.0)
    side = scene.container.lengths[0]
    width = side / 4 / medium.gas_rates.path
    assert medium.errors((4,) * 3, 1e-9).width == pytest.approx(16.0 / (45.0 * math.pi) * width**2)
    moved = math.sqrt(2.0) * 0.5 / medium.gas_rates.path
    assert medium.errors((4,) * 3, 0.5).step == pytest.approx(16.0 / (75.0 * math.pi) * moved**2)


def test_coarse_settings_are_warned_of_with_those_that_have_less_error():
    scene = gas(3, 20000, 0.001)
    with pytest.warns(UserWarning, match=r"time_step = 100 is .* mean free times .* with a step of "):
        gp.Simulation(scene, gp.DSMC(time_step=100.0))
    with pytest.warns(UserWarning, match=r"cells .* mean free paths wide, .* with cells_per_side = \(\d+"):
        gp.Simulation(scene, gp.DSMC(cells_per_side=1))
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        gp.Simulation(scene, gp.DSMC())


def test_right_cells_are_not_warned_of():
    """A third of a mean free path across the gap, and one cell along it; cubes are worse."""
    scene = plates(radius=0.1)
    assert not gp.DSMC(cells_per_side=(1, 1, 34)).remarks(scene)
    (line,) = gp.DSMC(cells_per_side=3).remarks(scene)
    assert line.startswith("cells ") and "with cells_per_side = (1, 1, " in line


def test_a_start_that_layers_do_not_resolve_is_stated():
    """A wave of the velocity along x; the start of the scene has none."""
    scene = plates(radius=0.05)
    start = gp.Simulation(scene, gp.DSMC(), 1).state
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        gp.Simulation(scene, gp.DSMC(), 2, initial=start)
    velocities = start.velocities.copy()
    velocities[:, 1] += np.sin(2.0 * math.pi * start.positions[:, 0] / 10.0)
    wave = replace(start, velocities=velocities)
    with pytest.warns(UserWarning, match="the initial state, which varies along x: give the cells"):
        gp.Simulation(scene, gp.DSMC(), 2, initial=wave)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        gp.Simulation(scene, gp.DSMC(cells_per_side=(9, 1, 20)), 2, initial=wave)


def test_what_the_boltzmann_model_neglects_is_stated():
    """At a packing fraction of 0.15 a third of the collisions; nothing in a dilute gas."""
    (line, *_) = gp.DSMC().remarks(gas(3, 1000, 0.15))
    lost = 1.0 - 1.0 / float(theory.contact_value(0.15, 3))
    assert f"a collision rate {100.0 * lost:.2g} %" in line and "model = enskog" in line
    assert not gp.DSMC(model="enskog").remarks(gas(3, 1000, 0.15))
    assert not gp.DSMC(cells_per_side=8).remarks(gas(3, 20000, 0.001))


def test_sizes_that_are_too_different_are_refused_with_an_alternative():
    scene = gp.Scene(BOX, [FEW, gp.Species(2, 1.0, temperature=1.0)])
    with pytest.raises(gp.SceneError, match='^radius = [^\n]*"step"[^\n]*$'):
        gp.Simulation(scene, gp.DSMC(time_step=0.1))


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


def test_an_empty_scene_and_one_particle():
    for count in (0, 1):
        scene = gp.Scene(BOX, [gp.Species(count, 0.1, temperature=1.0)])
        sim = gp.Simulation(scene, gp.DSMC(time_step=0.5))
        sim.advance(duration=20.0)
        assert sim.tally.collisions == 0
        assert sim.tally.steps == 40
