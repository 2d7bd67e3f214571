"""Fits of virial coefficients to made-up equations of state."""

import numpy as np
import pytest
import xarray as xr

from gaspart import theory
from gaspart.analysis.estimate import Estimate
from gaspart.reproduction.figures.virial import fit_coefficients, fit_table
from gaspart.theory.state import virial_with_tail

FITS = [
    {"free": 4, "up_to": 0.35, "held": True},
    {"free": 5, "up_to": 0.3, "held": True},
    {"free": 5, "up_to": 0.2, "held": False},
]
ETA = np.array([0.01, 0.02, 0.05, 0.1, 0.15, 0.2, 0.25, 0.3, 0.35, 0.4])


def equation_of_state(dimension, collisions=4e6, seed=1):
    """Z with the scatter of `collisions` collisions a point, in the form that `measure` gives."""
    z = theory.compressibility_factor(ETA, dimension)
    error = (z - 1.0) / np.sqrt(collisions)
    columns = {
        "Z": z + error * np.random.default_rng(seed).standard_normal(ETA.size),
        "Z_error": error,
        "reference": z,
        "reference_error": theory.compressibility_uncertainty(ETA, dimension),
        "collision_rate": np.ones(ETA.size),
        "collision_rate_error": np.full(ETA.size, collisions**-0.5),
    }
    dataset = xr.Dataset(
        {name: ("packing_fraction", values) for name, values in columns.items()},
        coords={"packing_fraction": ETA},
        attrs={"dimension": dimension},
    )
    return dataset.merge(fit_table(dataset, FITS))


@pytest.mark.parametrize("dimension", [2, 3])
def test_exact_data_give_the_exact_coefficients(dimension):
    z = virial_with_tail(ETA, dimension)
    fit, held_error = fit_coefficients(ETA, Estimate(z, 1e-4 * (z - 1.0)), dimension, free=5, held=True)
    exact, _ = theory.virial_coefficients(dimension, 5)
    assert fit.values == pytest.approx(exact[1:], rel=1e-6)
    assert np.all(held_error >= 0.0) and np.all(held_error < fit.errors * 10)


def test_choices_with_too_few_points_are_left_out():
    dataset = equation_of_state(2).drop_dims(["fit", "order"])
    few = dataset.isel(packing_fraction=slice(0, 4))
    table = fit_table(few, FITS)
    assert table["free"].values.tolist() == [4]
    nothing = fit_table(dataset.isel(packing_fraction=slice(0, 2)), FITS)
    assert nothing.sizes["fit"] == 0
