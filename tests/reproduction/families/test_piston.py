"""Made-up gases behind a piston with known answers, in the form that `measure.piston` gives."""

from __future__ import annotations

import numpy as np
import pytest
import xarray as xr
from reproduction.families.drawn import Points, draw, shows
from reproduction.families.judged import verdicts
from reproduction.made import made

import gaspart as gp
from gaspart import theory
from gaspart.reproduction.families.pressure import figure, measure
from gaspart.reproduction.families.pressure.claims import isothermal_variance, piston
from gaspart.theory import enskog_longitudinal_viscosity, mean_speed

REPLICAS = np.linspace(-1.0, 1.0, 6)
"""Of the scatter of replicas: they add up to nothing."""


def scattered(values, width=0.001):
    """(..., replica) the values, with a relative scatter between replicas."""
    return np.multiply.outer(values, 1.0 + width * REPLICAS)


def gases(exponent=1.0, back=1.0, factor=1.0, fluctuation=1.0, energy=1.0, heat=1.0, speed=1.0, share=0.5):
    """Discs and spheres of each kind, whose numbers are these times those of theory."""
    dimensions = np.array([2, 3])
    volume = np.concatenate([np.linspace(1.0, 0.25, 10), np.linspace(0.3, 0.5, 5)])
    paths = []
    for dimension in dimensions:
        expected = theory.adiabatic_temperature(0.005 / volume, 0.005, dimension)
        power = np.where(np.arange(volume.size) < 10, exponent, back)
        paths.append(np.array([1.01 * expected ** (power * (1.0 + 0.001 * one)) for one in REPLICAS]))
    density = np.array([0.1, 0.3, 0.1, 0.3])
    kinds = np.repeat(dimensions, 2)
    known = [
        (
            theory.compressibility_factor(eta, d) * theory.constant_enthalpy_factor(eta, d, 500),
            theory.speed_of_sound(eta, d) ** -2,
        )
        for eta, d in zip(density, kinds, strict=True)
    ]
    factors, variances = np.array(known).T
    state, gas = ("state", "state_replica"), ("expansion", "expansion_replica")
    return xr.Dataset(
        {
            "path_volume": (("path", "path_replica", "frame"), np.tile(volume, (2, REPLICAS.size, 1))),
            "path_temperature": (("path", "path_replica", "frame"), np.array(paths)),
            "path_heating": (("path", "path_replica", "frame"), np.full_like(paths, np.log(1.01))),
            "path_dimension": ("path", dimensions),
            "path_packing_fraction": ("path", [0.005, 0.005]),
            "state_density": (state, scattered(density, 0.0)),
            "state_factor": (state, scattered(factor * factors)),
            "state_fluctuation": (state, scattered(fluctuation * variances, 0.05)),
            "state_energy": (state, scattered(energy + 0.03 * np.array([1.0, -1.0, 1.0, -1.0]), 0.1)),
            "state_dimension": ("state", kinds),
            "state_count": ("state", np.full(4, 500)),
            "expansion_heat": (gas, np.full((2, REPLICAS.size), heat)),
            "expansion_speed": (gas, scattered(np.full(2, speed))),
            "expansion_share": (gas, scattered(np.full(2, share))),
            "expansion_dimension": ("expansion", dimensions),
        }
    )


# What is read of gases behind a piston: exactly, and what comes out of small ones.


CONTAINER = gp.Container((20.0, 10.0), ("wall", "periodic"))


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
    path = measure.piston([point], {}).isel(path=0, path_replica=1)
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
    state = measure.piston([point], {}).isel(state=0, state_replica=0)
    time = np.array([10.0, 20.0, 30.0])
    length = 20.0 - 0.5 * push * time**2
    # the disc at 8 is in the middle half in all frames, the other one in none
    middle = 3.0 / (0.5 * 10.0 * length.sum())
    assert state["state_density"] == pytest.approx(middle * np.pi * 0.25)
    assert state["state_factor"] == pytest.approx(0.01 / (middle * 0.5))
    assert state["state_fluctuation"] == pytest.approx(2 * length.var(ddof=1) * (10.0 * middle / 2) ** 2)
    assert state["state_energy"] == pytest.approx(10.0 * np.mean((push * time) ** 2) / 0.5)


def test_discs_that_expand(tmp_path):
    half = ((0.0, 0.0), (10.0, 10.0))
    scene = gp.Scene(CONTAINER, [gp.Species(30, 0.3, temperature=2.0, region=half)])
    point = made(tmp_path, "free", scene, duration=400.0, samples=40)
    ds = measure.piston([point], {}).isel(expansion=0)
    assert ds["expansion_heat"].values == pytest.approx(1.0, abs=1e-12)
    assert ds["expansion_speed"].mean() == pytest.approx(1.0, abs=0.03)
    assert ds["expansion_share"].mean() == pytest.approx(0.5, abs=0.1)
    with gp.open_trajectory(point.replica_path(0)) as run:
        speeds = np.linalg.norm(run["velocities"].values[20:].astype(float), axis=2)
        first = run["kinetic_energy"].values[0] / 30
        assert (run["coordinates"].values[0, :, 0] < 10.0).all()
    assert ds["expansion_speed"].values[0] == pytest.approx(speeds.mean() / mean_speed(2, first, count=30))


def test_right_data_agree():
    claims = piston(gases())
    assert verdicts(claims) == {"agrees"}
    assert len(claims) == 4 + 4 + 4 + 1 + 6


@pytest.mark.parametrize(
    ("wrong", "claim"),
    [
        ({"exponent": 1.01}, "adiabatic exponent of discs, compressed"),
        ({"back": 0.99}, "adiabatic exponent of spheres, expanded"),
        ({"factor": 1.004}, "compressibility factor"),
        ({"fluctuation": 1.2}, "variance"),
        ({"energy": 1.5}, "kinetic energy of the piston"),
        ({"heat": 1.0 + 1e-9}, "kinetic energy after"),
        ({"speed": 0.99}, "mean speed"),
        ({"share": 0.48}, "share"),
    ],
)
def test_wrong_data_disagree(wrong, claim):
    assert verdicts(piston(gases(**wrong)), claim) == {"disagrees"}
    assert verdicts(piston(gases()), claim) == {"agrees"}


def test_the_variance_of_an_ideal_gas_at_constant_temperature():
    """That of Poisson's distribution, 1/N of the volume squared; at constant enthalpy 1 / gamma of it."""
    assert isothermal_variance(1e-3, 2) == pytest.approx(1.0 - 4e-3, rel=1e-4)


def of_replicas(values):
    """Mean and standard error over the last axis."""
    return values.mean(axis=-1), values.std(axis=-1, ddof=1) / np.sqrt(REPLICAS.size)


def test_paths_states_and_an_expansion():
    ds = gases(exponent=1.1, back=0.9, factor=1.02, fluctuation=0.9, speed=1.01)
    upper, middle, lower = draw(figure.piston, ds).axes
    paths, factors, variances = [], [], []
    for n in range(2):
        own = ds.isel(path=n)
        measured = of_replicas(own["path_temperature"].values.T)
        paths.append(Points(own["path_volume"].mean("path_replica"), *measured))
        states = ds.isel(state=slice(2 * n, 2 * n + 2))
        eta = states["state_density"].values
        factor = states["state_factor"].values / theory.compressibility_factor(eta, n + 2)
        variance = states["state_fluctuation"].values * theory.speed_of_sound(eta, n + 2) ** 2
        factors.append(Points(eta[:, 0], *of_replicas(factor)))
        variances.append(Points(eta[:, 0], *of_replicas(variance)))
    speed = ds["expansion_speed"].values[0] ** 2
    paths.append(Points([2.0], *([one] for one in of_replicas(speed))))
    shows(upper, *paths)
    shows(middle, *factors)
    shows(lower, *variances)
