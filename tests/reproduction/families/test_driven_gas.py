"""Made-up driven gases with known answers, in the form that `measure.driven_gas` gives."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
import xarray as xr
from reproduction.families.drawn import Points, column, draw, shows
from reproduction.families.judged import verdicts
from reproduction.made import made
from scenes import gas

import gaspart as gp
from gaspart import theory
from gaspart.reproduction.families.granular import figure, measure
from gaspart.reproduction.families.granular.claims import driven_gas
from gaspart.reproduction.families.shared.runs import runs


def driven(temperature=1.0, cumulant=0.0, given=1.0):
    """Two gases of each dimension: temperature and energy over theory's, cumulant minus theory's."""
    dimension, restitution = np.array([2, 2, 3, 3]), np.array([0.9, 0.4, 0.9, 0.4])
    power, count, eta = np.full(4, 0.01), np.full(4, 500), np.full(4, 0.01)
    own = power * (1.0 - 1.0 / count)
    kinds = list(zip(restitution, dimension, power, eta, strict=True))
    steady = np.array([float(theory.driven_temperature(*kind)) for kind in kinds])
    many = np.array([float(theory.driven_cumulant(*kind[:2])) for kind in kinds])
    fourth = np.array([theory.finite_size_cumulant(a, 500, d) for a, d in zip(many, dimension, strict=True)])
    columns = {
        "dimension": dimension,
        "restitution": restitution,
        "packing_fraction": eta,
        "count": count,
        "power": power,
        "temperature": temperature * steady,
        "temperature_error": 0.002 * steady,
        "cumulant": fourth + cumulant,
        "cumulant_error": np.full(4, 0.002),
        "given": given * own,
        "given_error": 0.002 * own,
        "lost": own,
        "lost_error": 0.002 * own,
    }
    return xr.Dataset({key: ("gas", values) for key, values in columns.items()})


# What is read of driven gases: exactly, and what comes out of small ones.


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


def test_right_data_agree():
    assert verdicts(driven_gas(driven())) == {"agrees"}


@pytest.mark.parametrize(
    ("wrong", "claim"),
    [
        ({"temperature": 1.01}, "steady temperature"),
        ({"cumulant": 0.01}, "fourth cumulant of the"),
        ({"given": 1.01}, "energy given"),
    ],
)
def test_wrong_data_disagree(wrong, claim):
    claims = driven_gas(driven(**wrong))
    assert verdicts(claims, claim) == {"disagrees"}
    others = [one for one in claims if not one.claim.startswith((claim, "fourth cumulants"))]
    assert verdicts(others) == {"agrees"}


def test_the_cumulants_of_the_cooling_gas_disagree():
    gases = driven()
    for k in range(4):
        e, dimension = float(gases["restitution"][k]), int(gases["dimension"][k])
        gases["cumulant"][k] = theory.finite_size_cumulant(
            theory.fourth_cumulant(e, dimension), 500, dimension
        )
    assert verdicts(driven_gas(gases), "fourth cumulants") == {"disagrees"}


def test_temperatures_and_cumulants():
    ds = driven(1.02, 0.003)
    upper, lower = draw(figure.driven_gas, ds).axes
    temperatures, cumulants = [], []
    for dimension in (2, 3):
        own = ds.isel(gas=(ds["dimension"] == dimension).values)
        unit = own["temperature"] / 1.02
        ratio = own["temperature"] / unit, own["temperature_error"] / unit
        temperatures.append(Points(own["restitution"], *ratio))
        cumulants.append(column(own, "restitution", "cumulant"))
    shows(upper, *temperatures)
    shows(lower, *cumulants)
