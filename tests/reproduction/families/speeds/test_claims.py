import numpy as np
import pytest
import xarray as xr
from reproduction.claims.data import judged
from reproduction.families.speeds.data import relaxation_measurement

from gaspart import theory
from gaspart.reproduction.families.speeds import claims as speeds


def distribution(dimension=3, **changes):
    """What `measure.distribution` gives of a gas in equilibrium."""
    values = {
        "packing_fraction": 0.1,
        "samples": 100_000,
        "count": 1000,
        "chi_square": 47.0,
        "degrees_of_freedom": 48,
        "kolmogorov_distance": 0.0025,
        "kurtosis": theory.kurtosis(dimension, 1000) + 0.002,
        "kurtosis_error": 0.003,
        "temperature": 1.0 / dimension,
        "given_temperature": 1.0 / dimension,
        "collisions_between": 5.0,
    }
    return xr.Dataset(
        {name: ("point", [value]) for name, value in (values | changes).items()},
        attrs={"dimension": dimension},
    )


def test_kinetic_theory_agrees_with_itself():
    found = judged(speeds.speed_relaxation(relaxation_measurement()))
    assert len(found) == 18
    assert set(found.values()) == {"agrees"}


@pytest.mark.parametrize(
    ("name", "factor", "text"),
    [
        ("kurtosis", 1.05, "kurtosis of the speeds at"),
        ("never_hit", 1.3, "never hit"),
        ("collisions", 1.05, "collisions per particle until"),
        ("initial_slope", 1.1, "initial slope"),
        ("temperature_drift", 1e6, "drift of the energy"),
    ],
)
def test_each_claim_about_relaxation_can_fail(name, factor, text):
    ds = relaxation_measurement()
    ds[name] = ds[name] * factor
    found = judged(speeds.speed_relaxation(ds))
    assert "disagrees" in {verdict for claim, verdict in found.items() if text in claim}


def test_too_few_runs_are_inconclusive():
    found = judged(speeds.speed_relaxation(relaxation_measurement(error=0.02)))
    assert {verdict for claim, verdict in found.items() if "kurtosis of" in claim} == {"inconclusive"}


@pytest.mark.parametrize("statement", [speeds.speed_distribution_spheres, speeds.speed_distribution_discs])
def test_maxwell_agrees(statement):
    dimension = 3 if statement is speeds.speed_distribution_spheres else 2
    assert set(judged(statement(distribution(dimension))).values()) == {"agrees"}


@pytest.mark.parametrize(
    ("changes", "text"),
    [
        ({"chi_square": 110.0}, "chi-square"),
        ({"chi_square": 12.0}, "chi-square"),
        ({"kolmogorov_distance": 0.012}, "Kolmogorov"),
        ({"kurtosis": 1.64}, "kurtosis"),
        ({"temperature": np.nextafter(1 / 3, 1) + 1e-10}, "temperature"),
        ({"collisions_between": 2.0}, "between snapshots"),
    ],
)
def test_each_claim_about_maxwell_can_fail(changes, text):
    found = judged(speeds.distribution(distribution(3, **changes)))
    assert {verdict for claim, verdict in found.items() if text in claim} == {"disagrees"}
