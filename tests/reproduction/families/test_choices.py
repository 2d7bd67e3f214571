"""Costs and errors of made-up choices; the errors that theory states; runs of a few particles."""

from __future__ import annotations

import math
from functools import partial

import numpy as np
import pytest

import gaspart as gp
from gaspart import theory
from gaspart.accuracy import tabulated
from gaspart.accuracy.estimates import Component
from gaspart.accuracy.option import Option, fluid_option
from gaspart.analysis.estimate import Estimate
from gaspart.engines.engine import Candidate
from gaspart.reproduction.families.tradeoff import ENGINES, PARTS, claims, maps, uniform
from gaspart.reproduction.families.tradeoff.uniform import Choice
from gaspart.reproduction.jobs.simulate import simulate
from gaspart.reproduction.points.point import Point
from gaspart.scene.gas import Gas
from gaspart.theory.discretisation import contact_values


def choice(model=0.0, discretisation=0.0, least=0.5, **changes):
    """One CPU second a unit of time, and a relative variance of 1e-4 of a run of this length."""
    candidate = Candidate(gp.EventDriven(), model, discretisation)
    noise = Component(1.0, 1.0, 1.0, 1.96**2 * 1e-4, freedom=math.inf)
    limits = least + 1.0, math.inf, 1.0, 0.0
    option = Option(candidate, candidate.bias, noise, 1.0, 1.0, *limits)
    return Choice(option, **{"decay": 0.1, "uncertainty": 0.01, "finite_size": 1e-4} | changes)


def test_a_cost_is_that_of_the_noise_that_bias_leaves_room_for():
    assert choice().option.cost(0.001) == pytest.approx(1e-4 * (1.96 / 0.001) ** 2 + 1.0)
    assert choice(model=0.0003, discretisation=0.0002).option.cost(0.001) == pytest.approx(
        1e-4 * (1.96 / 0.0005) ** 2 + 1.0
    )
    assert choice().option.cost(0.1) == pytest.approx(1.5)  # the shortest run
    assert choice(model=0.001).option.cost(0.001) == math.inf


def test_parts_fill_the_accuracy():
    parts = choice(model=0.0003, discretisation=0.0002).parts(0.001)
    assert tuple(parts) == PARTS
    assert parts["model"] + parts["discretisation"] + parts["noise"] == pytest.approx(0.001)
    assert parts["equilibration"] == pytest.approx(math.exp(-10.0) * 0.1 / (1e-4 * (1.96 / 0.0005) ** 2))
    out_of_reach = choice(model=0.002).parts(0.001)
    assert out_of_reach["noise"] == out_of_reach["equilibration"] == 0.0
    assert choice(decay=0.0).parts(0.001)["equilibration"] == 0.0


def test_the_cheapest_choice_is_the_least_biased_one_where_none_reaches():
    coarse, fine = choice(discretisation=0.01), choice(discretisation=0.001, least=5.0)
    costs, parts = np.zeros((3, len(ENGINES), 2)), np.zeros((3, len(ENGINES), len(PARTS)))
    maps._enter(costs, parts, [coarse, fine], [0.05, 0.005, 0.0005])
    assert parts[:, 0, 1].tolist() == [0.01, 0.001, 0.001] and costs[2, 0, 0] == math.inf


def test_the_costs_of_a_fluid_are_those_of_its_contacts():
    """A contact of 2 us, and 1 / 100 of the variance of one contact."""
    gas, candidate = Gas(3, 0.1, 1000, 1.0, 1.0), Candidate(gp.EventDriven())
    option = fluid_option(gas, candidate, 2e-6, 0.01, 1.0, discarded=0.0)
    assert option.cost(1e-3) == pytest.approx(2e-6 * (0.01 / 1e-3**2 + 0.5 * 1000 * 30.0))
    assert option.cost(1.0) == pytest.approx(2e-6 * 0.5 * 1000 * (30.0 + 20.0))


@pytest.mark.parametrize(("dimension", "order"), [(2, 1.564), (3, 2.5)])
def test_the_boltzmann_equation_lacks_contact_value_and_virial(dimension, order):
    """order: of the contact value, 1 + order x packing fraction."""
    z, contact = (float(f(0.1, dimension)) for f in (theory.compressibility_factor, theory.contact_value))
    error = partial(tabulated.model_error, dimension=dimension, equation="boltzmann")
    assert error(0.1, observable="Z") == pytest.approx(1.0 - 1.0 / z)
    assert error(0.1, observable="collision_rate") == pytest.approx(1.0 - 1.0 / contact)
    assert error(1e-3, observable="collision_rate") == pytest.approx(1e-3 * order, rel=0.005)
    for name in ("Z", "collision_rate"):  # a dilute gas has neither
        assert error(1e-6, observable=name) < 1e-5


@pytest.mark.parametrize("dimension", [2, 3])
def test_the_enskog_model_errs_by_the_contact_value_that_its_engine_has(dimension):
    radius, density = np.array([0.5]), np.array([0.3 / theory.particle_volume(dimension)])
    given = contact_values(density, radius, dimension).item()
    error = abs(given / float(theory.contact_value(0.3, dimension)) - 1.0)
    found = tabulated.model_error(0.3, dimension, "enskog", "collision_rate")
    assert 0.0 < found < 0.004 and found == pytest.approx(error, rel=1e-9)
    assert 0.0 < tabulated.model_error(0.3, dimension, "enskog", "Z") < found


def test_both_models_lack_the_memory_of_collisions_in_d():
    ratio = float(theory.erpenbeck_wood_ratio(0.3))
    exact = 1.0 - 1.0 / ratio + theory.ERPENBECK_WOOD_UNCERTAINTY
    assert tabulated.model_error(0.3, 3, "enskog", "D") == pytest.approx(exact, rel=0.02)
    assert tabulated.model_error(1e-6, 3, "boltzmann", "D") < 1e-5
    assert tabulated.model_error(0.01, 2, "boltzmann", "D") == math.inf  # discs have no D


def test_what_the_size_leaves_falls_with_it():
    small, large = (Gas(3, 0.3, count, 1.0, 1.0) for count in (1000, 8000))
    for name in uniform.OBSERVABLES:
        assert 0.0 < uniform.finite_size(large, name) < uniform.finite_size(small, name) < 0.01
    (wave, lost), (speeds, whole) = uniform.decay_of(small, "D"), uniform.decay_of(small, "Z")
    assert wave > speeds and whole == 1.0 and 0.05 < lost < 0.2


def test_steps_of_a_fifth_of_a_free_time():
    """16 / (75 pi) is for the viscosity, 4 / (27 pi) for D, of (c step / l)^2."""
    step = 0.2 / float(theory.collision_rate(0.001, 3))
    moved = 0.2 * math.sqrt(math.pi) / 2.0
    expected = 4.0 / (27.0 * math.pi) * moved**2
    error = uniform._error_of_steps(gp.DSMC(step), Gas(3, 0.001, 4000, 1.0, 1.0))
    assert error == pytest.approx(expected, rel=0.01)


SOLVERS = {
    "event": gp.EventDriven(), "step": gp.TimeStepped(0.1), "boltzmann": gp.DSMC(0.1),
    "enskog": gp.DSMC(0.1, model="enskog"),
}  # fmt: skip


def flow(engine, value, error=0.001, bounds=(0.0, 0.0), **changes):
    numbers = {
        "observable": "heat_flux", "packing_fraction": 0.1, "count": 500, "variance": 2.0,
        "contacts": 1000.0, "decay": 3.0, "shortest": 3.0,
    }  # fmt: skip
    candidate = Candidate(SOLVERS[engine], *bounds)
    return maps.Flow(candidate=candidate, value=Estimate(value, error, 20.0), **numbers | changes)


def test_an_error_is_bounded_by_theory_or_by_what_is_seen():
    event = flow("event", 1.0)
    seen = 0.02 + 2.0 * math.hypot(0.001 / 1.02, 0.001) * 1.02
    assert maps.errors_of(flow("boltzmann", 1.02, bounds=(0.3, 0.005)), event) == pytest.approx(
        (seen - 0.005, 0.005), rel=1e-3
    )
    assert maps.errors_of(flow("boltzmann", 1.02, bounds=(0.004, 0.001)), event) == (0.004, 0.001)
    assert maps.errors_of(flow("step", 1.02, bounds=(0.0, math.inf)), event)[1] == pytest.approx(
        seen, rel=1e-3
    )
    assert maps.errors_of(event, event) == (0.0, 0.0)


def test_a_flow_costs_its_variance_and_settles_first():
    speeds = {"event": Estimate(1e-3, 1e-5), "enskog": Estimate(2e-3, 1e-5)}
    made = list(maps.flow_choices([flow("event", 1.0), flow("enskog", 1.0), flow("step", 1.0)], 1000, speeds))
    assert [uniform.solver_of(one.option.engine) for one in made] == ["event", "enskog"]
    for one, seconds in zip(made, (1e-3, 2e-3), strict=True):
        settling = maps.SETTLED * 3.0 * 2.0 * seconds  # of twice as many particles
        assert one.option.cost(10.0) == pytest.approx(3.0 * 2.0 * seconds + settling)  # the shortest run
        assert one.option.cost(1e-3) == pytest.approx(2.0 * seconds * 1.96**2 / 1e-3**2 + settling)
        assert one.uncertainty == pytest.approx(1e-5 / seconds)


def test_rarer_collisions_make_speeds_relax_later():
    assert claims.relaxation_time(1.0) == pytest.approx(1.618, abs=0.002)
    assert claims.relaxation_time(2.0) > 1.2 * claims.relaxation_time(1.0)


def point(folder, **settings):
    """A point whose runs have been made."""
    basic = {"dimension": 3, "radius": 0.5, "boundary": "periodic", "packing_fraction": 0.1}
    made = Point("gas", "point", "simulate", basic | settings, str(folder), 1)
    simulate(folder / "gas" / "point", **made.arguments)
    return made


def test_relaxation_of_a_small_gas(tmp_path):
    run = {"count": 400, "speed": math.sqrt(3.0), "collisions_per_particle": 3, "samples": 12, "replicas": 4}
    made = point(tmp_path, engine="event", **run)
    found = maps.relaxation_of(made)
    assert abs((found.value - claims.relaxation_time(1.0)).deviation) < 4.0
    rate = float(theory.collision_rate(0.1, 3))
    assert found.contacts == pytest.approx(0.5 * 400 * rate, rel=0.1)
    assert found.candidate.bias == 0.0 and found.decay == 0.0


def test_cells_of_a_small_gas(tmp_path):
    """With one cell nothing is lost; with 27 of 15 the Enskog model loses collisions."""
    gas = {
        "count": 400, "temperature": 1.0, "exact_temperature": True, "arrangement": "lattice",
        "engine": "dsmc", "model": "enskog",
        "collisions_per_particle": 1000, "equilibration": 10, "samples": 50,
    }  # fmt: skip
    (tmp_path / "one").mkdir(), (tmp_path / "many").mkdir()
    one = uniform.cells_of(point(tmp_path / "one", cells_per_side=1, **gas))
    many = uniform.cells_of(point(tmp_path / "many", cells_per_side=3, **gas))
    assert abs((one.rate - 1.0).deviation) < 4.0 and one.bound == 0.0
    assert 1.0 - many.bound < many.rate.value < 1.0 - 4.0 * many.rate.error
    assert many.error > many.bound / 4.0
    assert np.isfinite(list(one.noise.values())).all()
