"""Advice from a table of known errors, noises and times."""

import math
from dataclasses import replace

import pytest

import gaspart as gp
from gaspart import theory
from gaspart.accuracy import table
from gaspart.accuracy.advisers import timed_as
from gaspart.accuracy.option import WORTH
from gaspart.accuracy.plan import plan, plan_from_table
from gaspart.accuracy.table import EQUILIBRATION
from gaspart.analysis.measuring import measure
from gaspart.cli.advise import _lines
from gaspart.engines import DSMC
from gaspart.errors import SceneError
from gaspart.scene.container import Container
from gaspart.scene.restitution import Restitution
from gaspart.scene.scene import Scene
from gaspart.scene.species import Species


def gas(fraction, count=1000, dimension=3, **more):
    side = (count * theory.particle_volume(dimension) / fraction) ** (1.0 / dimension)
    species = Species(count, 0.5, temperature=1.0, arrangement="lattice")
    return Scene(Container((side,) * dimension, boundary="periodic"), species=(species,), **more)


def between_walls(boundary):
    """A gas whose Z is 1.28 far from walls: 200 spheres press by 1.53 N kT / V on those of this box."""
    return Scene(Container((12.0,) * 3, boundary), species=(Species(200, 0.5, temperature=1.0),))


def advice(fraction, accuracy, observable="Z", budget=None, **more):
    return plan_from_table(gas(fraction, **more), observable, accuracy, budget)


@pytest.fixture
def fast_steps(monkeypatch):
    """A machine on which time steps cost a thousandth."""
    known = table.seconds

    def seconds(dimension, fraction, engine, precision="float64", step=0.0):
        return known(dimension, fraction, engine, precision, step) * (1e-3 if engine == "step" else 1.0)

    monkeypatch.setattr(table, "seconds", seconds)


@pytest.mark.parametrize("dimension", [2, 3])
@pytest.mark.parametrize("observable", ["Z", "collision_rate"])
@pytest.mark.parametrize("accuracy", [1e-2, 1e-3, 1e-4])
def test_bias_and_noise_make_up_the_wanted_accuracy(dimension, observable, accuracy):
    found = advice(0.2, accuracy, observable, dimension=dimension)
    noise = table.noise(dimension, 0.2, observable)
    best = found.best
    contacts = 0.5 * found.replicas * found.collisions_per_particle * found.gas.count
    assert best.bias + math.sqrt(noise / contacts) <= accuracy * (1.0 + 1e-9)
    slower = WORTH if best.engine.reference else 1.0
    assert all(best.seconds <= slower * other.seconds for other in found.options[1:])


def test_a_fast_time_stepped_engine_is_taken(fast_steps):
    found = advice(0.3, 1e-2)
    assert found.best.engine.name == "step" and found.best.bias < 1e-2
    assert found.options[1:][0].engine.name == "event"


def test_dilute_spheres_take_the_model_that_is_accurate_enough():
    """Boltzmann's equation lacks the contact value, 1 + 5/2 of the packing fraction, and Z - 1."""
    rough, fine = (advice(0.003, accuracy, "collision_rate", count=4000) for accuracy in (0.03, 1e-4))
    assert rough.best.engine.model == "boltzmann" and fine.best.engine.name == "event"
    assert rough.best.bias == pytest.approx(2.5 * 0.003, rel=0.02)
    by_name = {timed_as(one.engine): one for one in rough.options[1:]}
    assert by_name["event"].seconds > 5.0 * rough.best.seconds
    pressure = advice(0.003, 0.03, count=4000)  # Z of Boltzmann's equation is 1 without a run
    assert pressure.best.engine.model == "enskog"
    assert "is 1 of particles without extent" in pressure.refused["dsmc"]
    assert advice(0.003, 0.03, "D", count=4000).best.engine.name == "dsmc"
    steps = [
        advice(0.003, accuracy, observable, count=4000).best.engine.time_step
        for observable, accuracy in (("collision_rate", 0.03), ("D", 0.05), ("D", 0.03))
    ]
    own = DSMC().for_scene(gas(0.003, count=4000)).time_step
    assert steps[0] == 4.0 * own and steps[0] > steps[1] > steps[2]  # they change D, not the rate
    assert advice(0.1, 0.03, "collision_rate").best.engine.name != "dsmc"


def test_long_steps_of_dsmc_are_explained():
    """The run warns of the viscosity that they change."""
    for observable, effect in (("collision_rate", "does not depend"), ("D", "the bias includes")):
        lines = _lines(advice(0.003, 0.05, observable, count=4000), "gas.yaml")
        (line,) = [line for line in lines if line.startswith("time step")]
        assert "times the engine's own" in line and effect in line
    assert not [line for line in _lines(advice(0.3, 0.01), "gas.yaml") if line.startswith("time step")]


@pytest.mark.parametrize(
    ("observable", "fraction", "dimension"),
    [("collision_rate", 0.003, 3), ("Z", 0.003, 3), ("collision_rate", 0.01, 2)],
)
def test_an_advised_run_of_dsmc_is_as_accurate_as_promised(tmp_path, observable, fraction, dimension):
    scene = gas(fraction, count=2000, dimension=dimension)
    scene = replace(scene, species=(replace(scene.species[0], exact_temperature=True),))
    found = plan_from_table(scene, observable, 0.02)
    recipe = found.recipe
    assert recipe.engine.name == "dsmc"
    path = gp.run(scene, recipe.engine, 1, recipe.duration, recipe.sample_interval, tmp_path / "run.nc")
    measured = measure(path, observable)
    assert float(measured.estimate) == pytest.approx(float(measured.theory), rel=0.02)


@pytest.mark.parametrize(("ratio", "name"), [(1.4, "event"), (1.6, "dsmc enskog")])
def test_the_exact_engine_is_taken_unless_another_is_much_cheaper(monkeypatch, ratio, name):
    """Of gases of few cells the Enskog model is as fast as the exact engine, or a little faster."""
    costs = {"event": ratio, "dsmc enskog": 1.0}
    monkeypatch.setattr(table, "seconds", lambda d, f, engine, *rest: costs.get(engine, math.inf))
    assert timed_as(advice(0.003, 0.03, count=4000).best.engine) == name


def test_a_look_up_runs_and_compiles_nothing(monkeypatch):
    def refuse(*arguments, **options):
        raise AssertionError("a simulation was made")

    monkeypatch.setattr("gaspart.simulation.Simulation.__init__", refuse)
    monkeypatch.setattr("gaspart.kernels.compile.cache.load_numba", refuse)
    made = plan(gas(0.2), "D", 1e-2)
    assert any(line.startswith("command") for line in _lines(made, "gas.yaml"))


def test_a_budget_that_does_not_suffice_gives_the_best_within_it():
    wanted = advice(0.2, 1e-4)
    short = advice(0.2, 1e-4, budget=0.25 * wanted.best.seconds)
    assert not short.affordable and wanted.affordable
    assert short.best.seconds <= 0.2501 * wanted.best.seconds
    assert 1e-4 < short.best.error < 3e-4


def test_time_steps_scale_with_the_scene(fast_steps):
    slow = plan_from_table(gas(0.3), "Z", 1e-2)
    hot = Scene(
        Container(tuple(2.0 * length for length in gas(0.3).container.lengths), boundary="periodic"),
        species=(Species(1000, 1.0, temperature=16.0, arrangement="lattice"),),
    )
    assert plan_from_table(hot, "Z", 1e-2).best.engine.time_step == pytest.approx(
        0.5 * slow.best.engine.time_step
    )


def test_equilibration_and_finite_size_are_reported():
    found = advice(0.3, 1e-3, count=100)
    assert found.finite_size[0] < 0.0 and found.finite_size[1] > 100
    assert found.best.seconds > 0.5 * 100 * EQUILIBRATION * table.seconds(3, 0.3, "event")


@pytest.mark.parametrize(("exact", "scatter"), [(False, 0.5 * math.sqrt(2.0 / 3000.0)), (True, 0.0)])
def test_drawn_velocities_add_a_scatter_that_is_stated(exact, scatter):
    scene = gas(0.2)
    particles = replace(scene.species[0], exact_temperature=exact)
    found = plan_from_table(replace(scene, species=(particles,)), "D", 1e-2)
    assert found.scatter.value == pytest.approx(scatter)
    assert any("exact_temperature: true" in line for line in _lines(found, "gas.yaml")) != exact


@pytest.mark.parametrize(
    ("scene", "observable", "accuracy", "key"),
    [
        (gas(0.2, restitution=Restitution(normal=0.9)), "Z", 0.01, "restitution"),
        (gas(0.2), "viscosity", 0.01, "observable"),
        (gas(0.2), "Z", 0.0, "accuracy"),
        (gas(0.2, dimension=2), "D", 0.01, "observable"),
        (gas(0.00005), "Z", 0.01, "packing_fraction = .*: advice is known from 9.5"),
        (gas(0.005, dimension=2), "Z", 0.01, "packing_fraction = .*: advice is known from 0.0095"),
        (between_walls(("wall",) * 3), "Z", 0.01, "container.boundary.*periodic containers"),
        (
            between_walls(("periodic", "periodic", "wall")),
            "D",
            0.01,
            "container.boundary.*measure the pressure",
        ),
    ],
)
def test_unmeasured_cases_are_refused(scene, observable, accuracy, key):
    with pytest.raises(SceneError, match=key):
        plan_from_table(scene, observable, accuracy)
