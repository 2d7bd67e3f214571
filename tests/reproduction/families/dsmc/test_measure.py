import pytest

from gaspart.reproduction.families.dsmc.measure import dsmc_convergence
from gaspart.reproduction.jobs.simulate import simulate
from gaspart.reproduction.points.point import Point

GAS = {
    "dimension": 3,
    "count": 64,
    "radius": 0.5,
    "packing_fraction": 0.0025,
    "boundary": "periodic",
    "temperature": 1.0,
    "exact_temperature": True,
    "engine": "dsmc",
    "cells_per_side": 1,
    "collisions_per_particle": 600,
    "samples": 1200,
    "lags": 30,
    "follow": 1,
    "replicas": 6,
}


@pytest.mark.filterwarnings("ignore:gaspart")
def test_coefficients_of_a_gas_are_near_their_exact_values(tmp_path, monkeypatch):
    """One cell of half a mean free path: viscosity 1.023 times, diffusion once."""
    monkeypatch.chdir(tmp_path)
    made = {"fluxes": {"stress": True}, "paths": {"displacements": True}}
    points = [Point(name, "one", "simulate", GAS | more, "results", 1) for name, more in made.items()]
    for one in points:
        (tmp_path / one.path).parent.mkdir(parents=True)
        simulate(tmp_path / one.path, **one.arguments)
    ds = dsmc_convergence(points, {"parts": {name: [name] for name in made}, "blocks": 4})
    width = float(ds["width"][0])
    assert width == pytest.approx(0.5, abs=0.01)
    expected = {
        "viscosity": 1.0 + 0.1132 * width**2,
        "conductivity": 1.0 + 0.0453 * width**2,
        "diffusion": 1.0,
    }
    for (name, value), row in zip(expected.items(), (0, 0, 1), strict=True):
        found, error = float(ds[name][row]), float(ds[f"{name}_error"][row])
        assert error < 0.15 * value
        assert abs(found - value) < 4.5 * error
