"""The table as it is kept: what must hold of any measurement."""

import math

import numpy as np
import pytest

from gaspart.accuracy import speed, table
from gaspart.analysis.observables import observables_with


def test_every_row_is_a_number_with_an_error_of_a_known_quantity():
    known = {
        "seconds",
        *(f"{kind}_{name}" for kind in ("bias", "noise") for name in observables_with(tabulated=True)),
    }
    known |= {f"price_{name}" for name in ("walls", "gravity", "spin", "two_masses", "recording", "stress")}
    assert {row["quantity"] for row in table.read()} == known
    assert all(np.isfinite((row["value"], row["error"])).all() for row in table.read())
    assert {row["dimension"] for row in table.read()} == {2, 3}


def test_longer_steps_lose_more_contacts():
    steps = [0.04, 0.08, 0.16, 0.32]
    for fraction in (0.01, 0.03, 0.1):
        lost = [table.bias(3, fraction, "float64", step, "collision_rate") for step in steps]
        assert lost == sorted(lost)
        assert lost[-1] > 2.0 / 3.0 * 0.9 * 0.32**2


def test_unmeasured_time_steps_have_no_bound():
    assert math.isinf(table.bias(3, 0.45, "float64", 0.08, "Z"))
    assert math.isinf(table.bias(3, 0.1, "float64", 0.123, "Z"))
    assert math.isinf(table.seconds(3, 0.45, "step", "float64", 0.08))


@pytest.mark.parametrize(
    ("dimension", "fractions"), [(3, (0.01, 0.1, 0.3, 0.45)), (2, (0.01, 0.1, 0.3, 0.6))]
)
def test_a_contact_costs_less_in_a_denser_gas(dimension, fractions):
    """The flights between contacts are shorter, and neighbour lists know where to look."""
    times = [table.seconds(dimension, fraction, "event") for fraction in fractions]
    assert times == sorted(times, reverse=True)
    assert times[-1] < 0.8 * times[-2]


@pytest.mark.parametrize("eta", [1e-4, 0.001, 0.01])
def test_noise_of_the_pressure_of_a_dilute_gas_is_that_of_independent_contacts(eta):
    """Z - 1 is a sum over contacts whose momenta have <p^2> / <p>^2 = 4 / pi: the variance of Z is that of
    Poisson's law, 4 / pi, times (Z - 1)^2 / Z^2."""
    z = 1.0 + 4.0 * eta + 10.0 * eta**2
    expected = 4.0 / math.pi * ((z - 1.0) / z) ** 2
    assert table.noise(3, eta, "Z") == pytest.approx(expected, rel=0.5)


def test_this_machine_is_timed_in_less_than_some_seconds():
    assert 0.05 < speed.factor(3, "event", "float64", 500) < 20.0
