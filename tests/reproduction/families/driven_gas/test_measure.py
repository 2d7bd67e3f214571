"""What is read of driven gases: exactly, and what comes out of small ones."""

from dataclasses import replace

import numpy as np
import pytest
from reproduction.families.granular.test_measure import made
from scenes import gas

import gaspart as gp
from gaspart import theory
from gaspart.reproduction.families.driven_gas import measure
from gaspart.reproduction.families.shared.runs import runs


def test_a_driven_gas_is_at_the_temperature_of_the_energy_balance(tmp_path):
    scene = replace(gas(2, 128, 0.02), restitution=gp.Restitution(0.6), thermostat=gp.Thermostat(0.03, 0.25))
    point = made(tmp_path, "driven", scene, duration=1000.0, samples=50, equilibration=200.0)
    ds = measure.driven_gas([point], {}).isel(gas=0)
    power = 0.03 * (1.0 - 1.0 / 128)
    expected = theory.driven_temperature(0.6, 2, 0.03, 0.02)
    assert abs(ds["temperature"] / expected - 1.0) < 4.0 * ds["temperature_error"] / expected + 0.02
    assert ds["temperature_error"] < 0.05 * expected
    assert ds["given"] == pytest.approx(power, abs=4.0 * float(ds["given_error"]) + 1e-3 * power)
    assert ds["lost"] == pytest.approx(power, rel=0.05)


def test_the_cumulant_is_that_of_the_velocities(tmp_path):
    """Of one frame with known speeds: those of the centre of mass are left out."""
    particles = [
        gp.Particle((2.0 + 3.0 * n, 5.0), (v + 7.0, 0.5), 0.1) for n, v in enumerate((1.0, -1.0, 2.0, -2.0))
    ]
    scene = gp.Scene(
        gp.Container((100.0, 10.0), "periodic"), particles=particles, species=[gp.Species(0, 0.1)]
    )
    scene.to_file(tmp_path / "scene.yaml")
    point = made(tmp_path, "still", scene, duration=0.001, samples=1, replicas=1)
    (found,) = [measure.means(run) for run in runs(point)]
    squares = np.array([1.0, 1.0, 4.0, 4.0])
    assert found["temperature"] == pytest.approx(squares.mean() * 4 / (2 * 3), rel=1e-6)
    assert found["cumulant"] == pytest.approx(
        2 * (squares**2).mean() / (4 * squares.mean() ** 2) - 1, rel=1e-6
    )
