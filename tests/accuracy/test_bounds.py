"""Bounds on the errors of DSMC where the gas is uneven, is confined, or has few particles."""

import math
from dataclasses import replace

import numpy as np
import pytest

import gaspart as gp
from gaspart import theory
from gaspart.accuracy.advisers import timed_as
from gaspart.accuracy.conditions import measured_conditions
from gaspart.accuracy.of_dsmc import boltzmann_error, cell_error, enskog_error, require_resolved
from gaspart.accuracy.option import candidates, make_request
from gaspart.accuracy.target import Target
from gaspart.state.initial import initial_state
from gaspart.theory.columns import gravity_column
from gaspart.theory.conditions import even_conditions, known_conditions
from gaspart.theory.gravity import ideal_mean_height

SLIT = ("periodic", "periodic", "wall")


def gas(count, fraction, boundary="periodic", dimension=3, lengths=None, **more):
    side = (count * theory.particle_volume(dimension) / fraction) ** (1.0 / dimension)
    species = gp.Species(count, 0.5, temperature=1.0, exact_temperature=True)
    return gp.Scene(gp.Container(lengths or (side,) * dimension, boundary), [species], **more)


def slit(count, fraction, width):
    side = math.sqrt(count * theory.particle_volume(3) / (fraction * width))
    return gas(count, fraction, SLIT, lengths=(side, side, float(width)))


def dense_floor():
    """200 spheres that lie in the lowest fortieth of their container."""
    region = ((0.0, 0.0, 0.0), (14.0, 14.0, 8.0))
    species = gp.Species(200, 0.5, temperature=1.0, exact_temperature=True, region=region)
    return gp.Scene(gp.Container((14.0, 14.0, 300.0), SLIT), [species], gravity=(0.0, 0.0, -0.25))


def conditions_of(scene):
    return known_conditions(scene, initial_state(scene, 0))


def asked(conditions, observable):
    return make_request(Target(conditions.scene, observable), 0.1, conditions)


def averages(scene, engine, collisions, seeds=4):
    """(mean, error) of the collision rate and of the pressure on the last two walls, over some seeds."""
    rate, found = float(theory.collision_rate(scene.packing_fraction, scene.dimension)), []
    area = math.prod(scene.container.lengths[:-1])
    for seed in range(seeds):
        simulation = gp.Simulation(scene, engine, seed)
        simulation.advance(duration=20.0 / rate)
        simulation.reset_tally()
        simulation.advance(duration=collisions / rate)
        tally = simulation.tally
        thrust = float(np.sum(np.asarray(tally.wall_impulse)[-2:])) / (2.0 * area * tally.time)
        found.append((2.0 * tally.collisions / (scene.count * tally.time), thrust))
    return np.mean(found, axis=0), np.std(found, axis=0, ddof=1) / math.sqrt(seeds)


def compared(scene, engine, collisions):
    """By how much an engine's rate and pressure exceed the exact ones, relatively, and its error."""
    (exact, by_chance), (found, its) = (
        averages(scene, one, collisions) for one in (gp.EventDriven(), engine)
    )
    exact = np.where(exact > 0.0, exact, 1.0)  # of a scene without walls
    return found / exact - 1.0, np.hypot(by_chance, its) / exact


@pytest.mark.parametrize(("dimension", "many", "more"), [(3, 2.5, 3.0), (2, 1.564, 0.872)])
def test_few_particles_collide_more_often(dimension, many, more):
    """To first order in the packing fraction; two exactly, by 4 eta / (1 - 4 eta) of spheres."""
    for count in (2, 5, 20, 1000):
        found = conditions_of(gas(count, 1e-4, dimension=dimension)).contact_of_few[0] - 1.0
        assert found == pytest.approx((many + more / count) * 1e-4, rel=2e-3)
    pair = even_conditions(gas(2, 0.05, dimension=dimension), 1.0)
    assert pair.contact_of_few[0] == pytest.approx(1.0 / (1.0 - 0.05 * 2.0 ** (dimension - 1)))


def test_two_spheres_collide_as_often_as_their_bound_says():
    """Their relative speed is that of their energy, and each is kept from a sphere of the volume."""
    scene = gas(2, 0.02)
    volume = scene.container.volume
    simulation = gp.Simulation(scene, gp.EventDriven(), 1)
    simulation.advance(duration=2e5)
    points = math.pi * math.sqrt(6.0) / volume  # collisions of a particle per time, without extent
    collisions = int(simulation.tally.collisions)
    excess = collisions / simulation.tally.time / points - 1.0
    error = (1.0 + excess) / math.sqrt(collisions)
    assert boltzmann_error(asked(even_conditions(scene, 1.0), "collision_rate")) == pytest.approx(
        excess, abs=3.0 * error
    )
    assert error < 0.1 * excess


@pytest.mark.parametrize(("dimension", "missed"), [(3, 2.0 / 3.0), (2, 1.0 / 4.0)])
def test_time_steps_err_by_twice_the_contacts_that_they_miss(dimension, missed):
    """A dilute gas misses (v_th dt / sigma)^2 times 2/3 or 1/4 of its contacts. One pass misses four times as
    many, and so does a wall at four times the temperature. Advice has the same bound."""
    scene = gas(50, 1e-6, dimension=dimension)
    engine = gp.TimeStepped(0.1)
    assert engine.bias(scene, "rates") == pytest.approx(2.0 * missed * 0.01, rel=1e-12)
    once = replace(engine, passes=1)
    assert once.bias(scene, "fluxes") == pytest.approx(8.0 * missed * 0.01, rel=1e-12)
    hot = replace(scene, container=gp.Container(scene.container.lengths), faces={"x_low": gp.Thermal(4.0)})
    assert engine.bias(hot, "rates") == pytest.approx(8.0 * missed * 0.01, rel=1e-12)
    target = Target(scene, "collision_rate")
    able, _ = candidates(target, 0.01, target.conditions)
    (stepped,) = (one for one in able if one.engine.name == "step")
    assert stepped.discretisation == pytest.approx(stepped.engine.bias(scene, "rates"), rel=1e-9)


@pytest.mark.parametrize(
    ("fraction", "width"), [(0.01, 5), pytest.param(0.001, 3, marks=pytest.mark.thorough)]
)
def test_points_between_walls_collide_too_often(fraction, width):
    """Of neighbours at a wall there are fewer: in a dilute gas by half a diameter over the width."""
    scene = slit(200, fraction, width)
    difference, error = compared(scene, gp.DSMC(), 400)
    bound = boltzmann_error(asked(conditions_of(scene), "collision_rate"))
    assert float(theory.contact_value(1.5 * fraction, 3)) - 1.0 < difference[0] - 3.0 * error[0]
    assert difference[0] - 3.0 * error[0] < bound < 2.0 * difference[0] and error[0] < 0.03


@pytest.mark.parametrize("fraction", [0.1, 0.2])
def test_the_enskog_model_in_a_narrow_slit(fraction):
    """It presses less on the walls: by 5 % at a packing fraction of 0.2, and by 13 % at 0.1, as it has few
    cells between them."""
    scene = slit(300, fraction, 4)
    engine = gp.DSMC(model="enskog")
    cells = engine.for_scene(scene).cells_per_side
    difference, error = compared(scene, engine, 100)
    found = conditions_of(scene)
    bounds = [enskog_error(asked(found, name), cells) for name in ("collision_rate", "pressure")]
    assert (np.abs(difference) - 3.0 * error < bounds).all()
    assert (np.abs(difference) > 0.01 + 3.0 * error).any()  # which the bound of an even gas was
    assert bounds[0] < 0.4


def test_a_column_has_the_temperature_of_its_energy():
    """3/2 N T + N <m g z>, of points by theory's mean height; a real gas lies higher and is colder."""
    scene = gas(400, 0.02, SLIT, lengths=(10.0, 10.0, 104.7), gravity=(0.0, 0.0, -0.1))
    column, state = gravity_column(scene), initial_state(scene, 0)
    energy = column.energy_of(state)
    real, ideal = (column.of_energy(energy, points) for points in (False, True))
    mean = ideal_mean_height(103.7, 0.1 / ideal.temperature)
    assert 400.0 * (1.5 * ideal.temperature + 0.1 * mean) == pytest.approx(energy, rel=2e-3)
    assert real.energy == pytest.approx(energy, rel=1e-6) and real.temperature < ideal.temperature
    weight = 400 * 0.1 / 100.0
    assert real.pressure(False) - real.pressure(True) == pytest.approx(weight, rel=2e-3)


def test_cells_that_are_longer_than_a_column_is_high_are_refused():
    """The Enskog model then gives a twelfth of the collisions, and the Boltzmann model a third."""
    target = Target(dense_floor(), "collision_rate")
    able, refused = candidates(target, 0.1, target.conditions)
    assert {one.engine.name for one in able} == {"event", "step"}
    for name in ("dsmc", "dsmc enskog"):
        assert "cells_per_side: cells are" in refused[name] and "changes by e" in refused[name]


def test_steps_that_are_longer_than_a_free_time_are_refused():
    scene = gas(2000, 0.01, SLIT, gravity=(0.0, 0.0, -0.001))
    found = conditions_of(scene)
    own = gp.DSMC().for_scene(scene)
    require_resolved(own, found)
    free = float((found.path / found.speed).min())
    with pytest.raises(gp.SceneError, match="time_step.*local free time"):
        require_resolved(replace(own, time_step=1.5 * free), found)
    with pytest.raises(gp.SceneError, match="cells_per_side.*local free path"):
        require_resolved(replace(own, cells_per_side=2), found)
    even = even_conditions(gas(2000, 0.01), 1.0)
    require_resolved(replace(own, cells_per_side=1, time_step=3.0 * free), even)
    assert cell_error(own, asked(even, "collision_rate")) == 0.0
    assert cell_error(own, asked(found, "collision_rate")) > 0.0


@pytest.mark.thorough
def test_the_errors_of_points_under_gravity_are_those_of_their_runs():
    """In the rate and in the temperature: DSMC with narrow cells beside the exact engine, one start."""
    scene = gas(600, 0.004, SLIT, lengths=(14.0, 14.0, 400.0), gravity=(0.0, 0.0, -0.03))
    found, start = conditions_of(scene), initial_state(scene, 0)
    engine, values = gp.DSMC(time_step=0.5, cells_per_side=(2, 2, 100)), []
    for one in (gp.EventDriven(), engine):
        simulation, parts = gp.Simulation(scene, one, 0, initial=start), []
        simulation.advance(duration=600.0)
        for _ in range(16):
            simulation.reset_tally()
            simulation.advance(duration=100.0)
            hot = 2.0 * simulation.state.kinetic_energy / (3.0 * scene.count)
            parts.append((2.0 * simulation.tally.collisions / scene.count / 100.0, hot))
        values.append((np.mean(parts, axis=0), np.std(parts, axis=0, ddof=1) / 4.0))
    (exact, by_chance), (drawn, its) = values
    difference, error = drawn / exact - 1.0, np.hypot(by_chance, its) / exact
    bounds = [boltzmann_error(asked(found, name)) for name in ("collision_rate", "temperature")]
    assert (np.abs(difference) < bounds + 3.0 * error).all()
    assert max(bounds) < 0.3 and (error < 0.03).all()


def test_observables_that_points_do_not_have_are_refused():
    scene = gas(300, 0.01)
    target = Target(scene, "bulk_viscosity")
    able, refused = candidates(target, 0.1, target.conditions)
    assert "of particles without extent" in refused["dsmc"]
    assert [timed_as(one.engine) for one in able] == ["event", "dsmc enskog"]
    target = Target(scene, "Z")
    assert "is 1 of particles" in candidates(target, 0.1, target.conditions)[1]["dsmc"]


@pytest.mark.thorough
def test_a_heated_gas_has_the_layers_of_its_run(tmp_path):
    """Where theory knows nothing: hot and thin at one plate. One that is even shows no gradient."""
    faces = {"z_low": gp.Thermal(1.0), "z_high": gp.Thermal(9.0)}
    scene = gas(150, 0.02, SLIT, faces=faces)
    assert conditions_of(scene) is None
    path = gp.run(scene, gp.EventDriven(), 0, 600.0, 2.0, tmp_path / "hot.nc")
    found = measured_conditions(scene, path)
    assert found.axis == 2 and found.scale < scene.container.lengths[2]
    assert found.temperature[-1] > 1.5 * found.temperature[0] and found.crowding[0] > 1.3 * found.crowding[-1]
    assert (found.share * found.crowding**-1).sum() == pytest.approx(1.0)
    even = gas(150, 0.02, SLIT)
    path = gp.run(even, gp.EventDriven(), 0, 600.0, 2.0, tmp_path / "even.nc")
    assert measured_conditions(even, path).scale > 2.0 * even.container.lengths[2]
