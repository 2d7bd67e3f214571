"""Theory against numbers that other programs have measured and published."""

from pathlib import Path

import numpy as np
import pytest

from gaspart import theory

DATA = Path(__file__).parent / "data"


def table(name):
    """The columns of a table, as arrays."""
    return np.genfromtxt(DATA / name, delimiter=",", names=True)


@pytest.fixture(scope="module")
def pressures():
    """193 runs: the table, the packing fractions, Z of the infinite fluid and its uncertainty."""
    rows = table("z_spheres_dynamo.csv")
    eta = rows["density"] * np.pi / 6.0
    return rows, eta, theory.compressibility_factor(eta, 3), theory.compressibility_uncertainty(eta, 3)


def shifts(rows, eta, ensemble):
    """What finite numbers change."""
    return np.array([
        theory.finite_size_correction(one, 3, int(count), ensemble)
        for one, count in zip(eta, rows["count"], strict=True)
    ])  # fmt: skip


def test_z_of_spheres_by_dynamo(pressures):
    """Errors from 8e-7 on, N from 1372 to 2e6: the deviations have a root mean square of 0.8 of both
    uncertainties, of 1.2 of those of the runs alone."""
    rows, eta, reference, uncertainty = pressures
    deviation = rows["z"] - reference - shifts(rows, eta, "dynamics")
    assert np.abs(deviation / reference).max() < 4e-5
    both = np.hypot(rows["error"], uncertainty)
    assert 0.65 < np.sqrt(np.mean((deviation / both) ** 2)) < 1.0
    assert np.sqrt(np.mean((deviation / rows["error"]) ** 2)) < 1.25


def test_the_law_of_finite_numbers_is_that_of_dynamics(pressures):
    """At a fixed energy and momentum. The canonical one is excluded by 30 standard errors on average."""
    rows, eta, reference, uncertainty = pressures
    few = rows["count"] < 6000
    both = np.hypot(rows["error"], uncertainty)[few]
    for ensemble, low, high in (("dynamics", 0.5, 1.3), ("canonical", 25.0, 60.0)):
        deviation = (rows["z"] - reference - shifts(rows, eta, ensemble))[few]
        assert low < np.sqrt(np.mean((deviation / both) ** 2)) < high, ensemble


def test_d_of_spheres_by_dynamo():
    """Values from 1372 to 530604 spheres: some 1 %, where the container changes up to 8 %."""
    rows = table("d_spheres_dynamo.csv")
    eta = rows["density"] * np.pi / 6.0
    found = np.array([
        theory.diffusion_in_cube(one, (count / density) ** (1.0 / 3.0))
        for one, count, density in zip(eta, rows["count"], rows["density"], strict=True)
    ])  # fmt: skip
    value, uncertainty = found.T
    deviation = (rows["diffusion"] - value) / np.hypot(rows["error"], uncertainty)
    assert np.sqrt(np.mean(deviation**2)) < 1.0 and np.abs(deviation).max() < 2.5


def test_the_shift_of_d_in_a_cube_is_known_to_a_tenth():
    """Relative to the largest containers of each density, so that D of the infinite system has no part."""
    rows = table("d_spheres_dynamo.csv")
    deviations = []
    for density in np.unique(rows["density"]):
        part = rows[rows["density"] == density]
        eta, sides = density * np.pi / 6.0, (part["count"] / density) ** (1.0 / 3.0)
        infinite = float(theory.erpenbeck_wood_diffusion(eta))
        shift = infinite - np.array([theory.diffusion_in_cube(eta, side)[0] for side in sides])
        large = part["count"] > 2e5
        own = np.average((part["diffusion"] + shift)[large], weights=part["error"][large] ** -2.0)
        unsure = (0.05 + 2.0 * theory.mean_free_path(eta, 3) / sides) * shift
        few = ~large
        deviations.append(((part["diffusion"] - own + shift) / np.hypot(part["error"], unsure))[few])
    together = np.concatenate(deviations)
    assert together.size == 40
    assert 0.5 < np.sqrt(np.mean(together**2)) < 1.1
    assert np.abs(together).max() < 3.0
