"""Theory against numbers that other programs have measured and published."""

from pathlib import Path

import numpy as np
import pytest

import gaspart as gp
from gaspart import theory

DATA = Path(__file__).parent / "data"


def table(name):
    """The columns of a table, as arrays."""
    return np.genfromtxt(DATA / name, delimiter=",", names=True)


def test_a_table_has_the_values_of_one_quantity_and_no_other():
    sizes = {(3, "Z"): 193, (3, "Z_crystal"): 10, (3, "diffusion"): 49, (3, "viscosity"): 2}
    for (dimension, quantity), size in sizes.items():
        rows = theory.literature(quantity, dimension)
        assert set(rows.quantity) == {quantity} and rows.size == size and np.all(rows.error > 0.0)
    discs = theory.literature("pressure", 2)
    assert set(discs.source) == {"Li 2022", "Bernard 2011", "Engel 2013"}
    with pytest.raises(
        gp.SceneError, match=r"quantity = 'pressure': must be one of Z, Z_crystal, conductivity, diffusion"
    ):
        theory.literature("pressure", 3)
    rows.value[:] = 0.0  # a reader's own copy
    assert np.all(theory.literature("viscosity", 3).value > 0.0)


def test_z_of_spheres_by_another_equation():
    """Of etomica, fitted to its authors' simulations: what `compressibility_uncertainty` states."""
    rows = table("z_spheres_etomica.csv")
    rows = rows[rows["packing_fraction"] <= theory.HIGHEST_PACKING_FRACTION[3]]
    eta, z = rows["packing_fraction"], rows["z"]
    distance = np.abs(theory.kolafa_labik_malijevsky(eta) / z - 1.0)
    assert distance[eta < 0.4451].max() == pytest.approx(4.3e-6, abs=5e-8)
    assert distance[eta < 0.5237].max() < 1e-5 and distance.max() == pytest.approx(2.52e-5, abs=2e-7)
    dense = eta > 0.2  # below, the digits of the table's packing fractions are too few
    assert np.all((distance * z < 1.01 * theory.compressibility_uncertainty(eta, 3))[dense])


def test_the_virial_coefficients_of_spheres_by_another_equation():
    """Of the same program, whose first eleven are those of its authors' series."""
    orders, ratios = table("virial_spheres_etomica.csv")[["n", "ratio"]].view((float, 2)).T
    found, uncertainty = theory.virial_coefficients(3, 10)
    deviation = (4.0 ** (orders - 1) * ratios)[:9] - found[1:]
    assert np.abs(deviation[:3]).max() < 1e-6
    assert np.abs(deviation[3:] / uncertainty[4:]).max() < 3.0
    assert 0.4 < np.sqrt(np.mean((deviation[3:] / uncertainty[4:]) ** 2)) < 1.6


def test_z_of_spheres_by_dynamo():
    """Errors from 8e-7 on, N from 1372 to 2e6: the deviations have a root mean square of 0.8 of both
    uncertainties, of 1.2 of those of the runs alone."""
    rows = theory.literature("Z", 3)
    eta = rows.packing_fraction
    reference, uncertainty = theory.compressibility_factor(eta, 3), theory.compressibility_uncertainty(eta, 3)
    shifts = [
        theory.finite_size_correction(one, 3, int(n), "dynamics")
        for one, n in zip(eta, rows.count, strict=True)
    ]
    deviation = rows.value - reference - shifts
    assert np.abs(deviation / reference).max() < 4e-5
    both = np.hypot(rows.error, uncertainty)
    assert 0.65 < np.sqrt(np.mean((deviation / both) ** 2)) < 1.0
    assert np.sqrt(np.mean((deviation / rows.error) ** 2)) < 1.25


def sides(rows):
    """Of the cubes of a table, in diameters."""
    return (rows.count / theory.number_density(rows.packing_fraction, 3)) ** (1.0 / 3.0)


def test_d_of_spheres_by_dynamo():
    """Values from 1372 to 530604 spheres: some 1 %, where the container changes up to 8 %."""
    rows = theory.literature("diffusion", 3)
    found = np.array([
        theory.diffusion_in_cube(eta, side)
        for eta, side in zip(rows.packing_fraction, sides(rows), strict=True)
    ])  # fmt: skip
    value, uncertainty = found.T
    deviation = (rows.value - value) / np.hypot(rows.error, uncertainty)
    assert np.sqrt(np.mean(deviation**2)) < 1.0 and np.abs(deviation).max() < 2.5
