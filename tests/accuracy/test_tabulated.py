"""Costs of a fluid, and errors of the models of DSMC that theory states."""

import math
from functools import partial

import numpy as np
import pytest

import gaspart as gp
from gaspart import theory
from gaspart.accuracy import tabulated
from gaspart.accuracy.of_engine import Candidate
from gaspart.accuracy.option import fluid_option
from gaspart.scene.facts import Gas
from gaspart.theory.diffusion import ERPENBECK_WOOD_UNCERTAINTY
from gaspart.theory.discretisation import contact_values


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
    exact = 1.0 - 1.0 / ratio + ERPENBECK_WOOD_UNCERTAINTY
    assert tabulated.model_error(0.3, 3, "enskog", "D") == pytest.approx(exact, rel=0.02)
    assert tabulated.model_error(1e-6, 3, "boltzmann", "D") < 1e-5
    assert tabulated.model_error(0.01, 2, "boltzmann", "D") == math.inf  # discs have no D
