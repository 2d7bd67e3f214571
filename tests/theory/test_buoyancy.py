import numpy as np
import pytest

from gaspart import theory
from gaspart.theory import brownian as buoyancy

ETA = np.linspace(0.02, 0.6, 12)


def slope(function, at, step=1e-5):
    return (function(at + step) - function(at - step)) / (2.0 * step)


def test_a_disc_of_the_fluids_own_size_costs_its_chemical_potential():
    # Gibbs and Duhem, with the theory's own pressure: eta d mu_excess / d eta = d(eta Z) / d eta - 1.
    pressure = slope(lambda eta: eta * theory.scaled_particle(eta), ETA)
    assert ETA * slope(lambda eta: buoyancy.insertion_work(eta, 1.0), ETA) == pytest.approx(pressure - 1.0)
    exact = theory.excess_chemical_potential(0.2, 2)
    assert buoyancy.insertion_work(0.2, 1.0) == pytest.approx(exact, rel=0.02)


@pytest.mark.parametrize("ratio", [0.0, 1.0, 6.0, 50.0])
def test_what_is_displaced_is_the_slope_of_the_work_by_the_chemical_potential(ratio):
    work = slope(lambda eta: buoyancy.insertion_work(eta, ratio), ETA)
    potential = 1.0 / ETA + slope(lambda eta: buoyancy.insertion_work(eta, 1.0), ETA)
    assert ETA * buoyancy.displaced_area(ETA, ratio) == pytest.approx(work / potential, rel=1e-6)


def test_the_radius_that_counts_goes_from_one_to_the_other():
    eta = np.linspace(0.0, 0.69, 50)
    beyond = np.sqrt(buoyancy.displaced_area(eta, 6.0)) - 6.0
    assert beyond[0] == pytest.approx(1.0)
    assert np.all(np.diff(beyond) < 0.0) and beyond[-1] > 0.0
    # Widom: a point is inserted where no disc is, -ln(1 - eta).
    assert buoyancy.insertion_work(0.3, 0.0) == pytest.approx(-np.log(0.7))
