"""Made-up equations of state with known answers, in the form that `measure.equation_of_state` gives."""

from __future__ import annotations

import numpy as np
import pytest
import xarray as xr
from reproduction.claims.data import judged
from reproduction.families.drawn import Points, draw, shows, varied

from gaspart import theory
from gaspart.analysis.estimate import Estimate
from gaspart.reproduction.families.equation_of_state import figure
from gaspart.reproduction.families.equation_of_state.claims import virial_discs, virial_spheres
from gaspart.reproduction.families.equation_of_state.measure import fit_coefficients, fit_table

FITS = [
    {"free": 4, "up_to": 0.35, "held": True},
    {"free": 5, "up_to": 0.3, "held": True},
    {"free": 5, "up_to": 0.2, "held": False},
]
ETA = np.array([0.01, 0.02, 0.05, 0.1, 0.15, 0.2, 0.25, 0.3, 0.35, 0.4])


def equation_of_state(dimension, collisions=4e6, noise=1.0, seed=1, true=theory.compressibility_factor):
    """Z of the equation `true` with the scatter of `collisions` collisions a point, times `noise`."""
    rng = np.random.default_rng(seed)
    z = true(ETA, dimension)
    error = (z - 1.0) / np.sqrt(collisions)
    columns = {
        "Z": z + noise * error * rng.standard_normal(ETA.size),
        "Z_error": error,
        "reference": theory.compressibility_factor(ETA, dimension),
        "reference_error": theory.compressibility_uncertainty(ETA, dimension),
        "collision_rate": 1.0 + noise * rng.standard_normal(ETA.size) / np.sqrt(collisions),
        "collision_rate_error": np.full(ETA.size, collisions**-0.5),
        "replica_chi_square": rng.chisquare(1, ETA.size),
        "replica_degrees_of_freedom": np.ones(ETA.size, dtype=int),
    }
    dataset = xr.Dataset(
        {name: ("packing_fraction", values) for name, values in columns.items()},
        coords={"packing_fraction": ETA},
        attrs={"dimension": dimension},
    )
    return dataset.merge(fit_table(dataset, FITS))


@pytest.mark.parametrize("dimension", [2, 3])
def test_exact_data_give_the_exact_coefficients(dimension):
    z = theory.virial_with_tail(ETA, dimension)
    fit, held_error = fit_coefficients(ETA, Estimate(z, 1e-4 * (z - 1.0)), dimension, free=5, held=True)
    exact, _ = theory.virial_coefficients(dimension, 5)
    assert fit.values == pytest.approx(exact[1:], rel=1e-6)
    assert np.all(held_error >= 0.0) and np.all(held_error < fit.errors * 10)


@pytest.mark.parametrize("dimension", [2, 3])
def test_fitted_coefficients_scatter_as_their_errors_say(dimension):
    exact, _ = theory.virial_coefficients(dimension, 4)
    fits = [equation_of_state(dimension, seed=seed).isel(fit=0) for seed in range(60)]
    pulls = np.array([
        (fit["coefficient"].values[:3] - exact[1:]) / fit["coefficient_error"].values[:3] for fit in fits
    ])  # fmt: skip
    assert np.allclose(pulls.mean(axis=0), 0.0, atol=0.5)
    assert np.allclose(pulls.std(axis=0), 1.0, atol=0.3)


def test_a_cut_series_is_biased():
    z = theory.compressibility_factor(ETA, 2)
    fit, held_error = fit_coefficients(ETA, Estimate(z, 1e-4 * (z - 1.0)), 2, free=4, held=False)
    assert fit.values[2] > 1.3 * theory.virial_coefficients(2, 4)[0][3]  # B4 takes up what was cut
    assert not held_error.any()


def test_choices_with_too_few_points_are_left_out():
    dataset = equation_of_state(2).drop_dims(["fit", "order"])
    few = dataset.isel(packing_fraction=slice(0, 4))
    table = fit_table(few, FITS)
    assert table["free"].values.tolist() == [4]
    nothing = fit_table(dataset.isel(packing_fraction=slice(0, 2)), FITS)
    assert nothing.sizes["fit"] == 0


CLAIMS = {2: virial_discs, 3: virial_spheres}


def verdicts(dimension, dataset):
    return judged(CLAIMS[dimension](dataset))


@pytest.mark.parametrize("dimension", [2, 3])
def test_right_data_agree(dimension):
    assert set(verdicts(dimension, equation_of_state(dimension)).values()) == {"agrees"}


@pytest.mark.parametrize("dimension", [2, 3])
def test_short_runs_are_inconclusive_not_right(dimension):
    found = verdicts(dimension, equation_of_state(dimension, collisions=3e4))
    assert found[next(text for text in found if text.startswith("B2"))] == "inconclusive"
    assert "disagrees" not in found.values()


@pytest.mark.parametrize("dimension", [2, 3])
def test_a_bias_of_three_in_a_thousand_is_found(dimension):
    def biased(eta, d):
        return 1.0 + 1.003 * (theory.compressibility_factor(eta, d) - 1.0)

    found = verdicts(dimension, equation_of_state(dimension, true=biased))
    assert found[next(text for text in found if text.startswith("B2"))] == "disagrees"
    assert found[next(text for text in found if text.startswith("Z at all"))] == "disagrees"


def test_carnahan_and_starlings_fluid_is_distinguished_from_the_true_one():
    found = verdicts(3, equation_of_state(3, true=lambda eta, _: theory.carnahan_starling(eta)))
    assert found[next(text for text in found if text.startswith("excess of Z over Carnahan"))] == "disagrees"


def test_error_bars_that_are_too_small_are_found():
    dataset = equation_of_state(2)
    dataset["replica_chi_square"] = dataset["replica_chi_square"] + 8.0
    found = verdicts(2, dataset)
    assert found[next(text for text in found if text.startswith("error bars"))] == "disagrees"


def test_a_wrong_collision_rate_is_found():
    dataset = equation_of_state(2)
    dataset["collision_rate"] = dataset["collision_rate"] * 1.003
    assert np.isfinite(dataset["collision_rate"]).all()
    found = verdicts(2, dataset)
    assert found[next(text for text in found if text.startswith("collision rate"))] == "disagrees"


DRAW = {2: figure.virial_discs, 3: figure.virial_spheres}


@pytest.mark.parametrize("dimension", [2, 3])
def test_z_its_residuals_and_the_coefficients(dimension):
    ds = varied(equation_of_state(dimension), "up_to")
    state, residuals, coefficients = draw(DRAW[dimension], ds).axes
    eta = ds["packing_fraction"]
    shows(state, Points(eta, ds["Z"]))
    error = 100.0 * np.hypot(ds["Z_error"], ds["reference_error"]) / ds["reference"]
    shows(residuals, Points(eta, 100.0 * (ds["Z"] / ds["reference"] - 1.0), error))
    fitted = []
    for k, (order, scale) in enumerate({2: 1e-3, 3: 1e-2, 4: 1e-1}.items()):
        at = ds.sel(order=order)
        unit = scale * float(at["exact"])
        error = np.hypot(at["coefficient_error"], at["held_error"]) / unit
        fitted.append(Points(np.arange(3) + 0.22 * (k - 1), (at["coefficient"] - at["exact"]) / unit, error))
    shows(coefficients, *fitted)
    *_, coefficients = draw(DRAW[dimension], ds.isel(fit=slice(0, 0))).axes  # without fits
    shows(coefficients, *[Points([], [], [])] * 3)
