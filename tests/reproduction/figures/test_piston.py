"""What is read of a gas behind a piston, exactly."""

import numpy as np
import pytest
from reproduction.made import made

import gaspart as gp
from gaspart.reproduction.figures import piston
from gaspart.reproduction.table import Table, from_rows
from gaspart.theory.enskog import enskog_longitudinal_viscosity
from gaspart.theory.state import adiabatic_temperature

CONTAINER = gp.Container((20.0, 10.0), ("wall", "periodic"))


@pytest.mark.interpreted
def test_one_disc_and_its_piston(tmp_path):
    """The disc, at rest in the middle, is not met; the piston falls freely."""
    scene = gp.Scene(
        CONTAINER,
        particles=[gp.Particle((8.0, 5.0), (0.0, 1.0), 0.5), gp.Particle((1.0, 5.0), (0.0, 1.0), 0.5)],
        species=[gp.Species(0, 0.5)],
        faces={"x_high": gp.Piston(10.0, 0.01)},
    )
    push = 0.01 * 10.0 / 10.0
    point = made(tmp_path, "fall", scene, duration=20.0, samples=2, replicas=2)
    path = piston.measure([point], {}).isel(path=0, path_replica=1)
    assert path["path_volume"].values == pytest.approx(1.0 - 0.5 * push * np.array([0, 10, 20]) ** 2 / 20.0)
    assert np.array_equal(path["path_temperature"], np.ones(3))
    # 0.5 per area of strain rate squared, times the area, over the energy 1, by two trapezoids
    viscosity = enskog_longitudinal_viscosity(0.5 * np.pi / 200 / path["path_volume"].values, 2)
    length = 20.0 * path["path_volume"].values
    power = viscosity * np.sqrt(0.5) * (push * np.array([0.0, 10.0, 20.0])) ** 2 * 10.0 / length
    heating = 10.0 * np.array([0.0, 0.5 * power[1], 0.5 * power[:2].sum() + 0.5 * power[1:].sum()])
    assert path["path_heating"].values == pytest.approx(heating)
    assert (path["path_dimension"], path["path_packing_fraction"]) == (2, pytest.approx(0.5 * np.pi / 200))

    point = made(tmp_path, "steady", scene, duration=20.0, samples=2, equilibration=10.0, replicas=2)
    state = piston.measure([point], {}).isel(state=0, state_replica=0)
    time = np.array([10.0, 20.0, 30.0])
    length = 20.0 - 0.5 * push * time**2
    # the disc at 8 is in the middle half in all frames, the other one in none
    middle = 3.0 / (0.5 * 10.0 * length.sum())
    assert state["state_density"] == pytest.approx(middle * np.pi * 0.25)
    assert state["state_factor"] == pytest.approx(0.01 / (middle * 0.5))
    assert state["state_fluctuation"] == pytest.approx(2 * length.var(ddof=1) * (10.0 * middle / 2) ** 2)
    assert state["state_energy"] == pytest.approx(10.0 * np.mean((push * time) ** 2) / 0.5)


@pytest.mark.parametrize("dimension", [2, 3])
def test_the_exponent_of_a_gas_that_is_also_heated(dimension):
    volume, heating = np.array([[0.5, 0.25]]), np.array([[0.01, 0.03]])
    expected = adiabatic_temperature(0.005 / volume, 0.005, dimension)
    row = {"dimension": dimension, "packing_fraction": 0.005, "volume": volume, "heating": heating}
    row["temperature"] = expected**1.1 * np.exp(heating)
    path = Table(from_rows("path", [row], ("replica", "frame")), "path")[0]
    assert piston.exponents(path) == pytest.approx(np.full((1, 2), 1.0 + 2.2 / dimension))


def test_the_variance_of_an_ideal_gas_at_constant_temperature():
    """That of Poisson's distribution, 1/N of the volume squared; at constant enthalpy 1 / gamma of it."""
    assert piston.isothermal_variance(1e-3, 2) == pytest.approx(1.0 - 4e-3, rel=1e-4)
