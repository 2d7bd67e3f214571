import numpy as np
import pytest

from gaspart import theory
from gaspart.theory.packing import CRYSTAL_OF_1024_DISCS, ETOMICA_CRYSTAL_UNCERTAINTY


def speedy_crystal(eta):
    """Z of the face-centred cubic crystal of spheres (Speedy 1998; coefficients from SklogWiki)."""
    z = eta / theory.CLOSE_PACKING[3]
    return 3.0 / (1.0 - z) - 0.5921 * (z - 0.7072) / (z - 0.601)


def test_both_branches_of_spheres_meet_at_the_coexistence_pressure():
    # Fluid and crystal are from different sources than the pressure and the densities.
    fluid, crystal = theory.coexistence_packing_fractions(3)
    freezing, melting = theory.COEXISTENCE_DENSITY[3]
    pressure = theory.COEXISTENCE_PRESSURE[3]
    assert freezing * theory.compressibility_factor(fluid, 3) == pytest.approx(pressure, rel=2e-3)
    assert melting * speedy_crystal(crystal) == pytest.approx(pressure, rel=2e-3)


def test_the_liquid_of_discs_has_the_coexistence_pressure_at_its_end():
    # Nearly: the literature's largest simulation just below freezing.
    known = theory.literature("pressure", 2)
    last = known[(known["count"] == 65536) & (known.packing_fraction == 0.698)]
    assert set(last.source) == {"Bernard 2011", "Engel 2013"}
    assert last.packing_fraction[0] < theory.coexistence_packing_fractions(2)[0]
    assert last.value == pytest.approx(theory.COEXISTENCE_PRESSURE[2], rel=2e-3)


def test_the_crystal_of_spheres_is_that_of_another_program():
    """Whose errors are 3 to 6e-6 of Z; by the same runs Speedy's equation is 1.6 to 4.6e-4 low."""
    known = theory.literature("Z_crystal", 3)
    distance = theory.etomica_crystal(known.packing_fraction) / known.value - 1.0
    assert np.abs(distance).max() == pytest.approx(ETOMICA_CRYSTAL_UNCERTAINTY, rel=0.01)
    low = 1.0 - speedy_crystal(known.packing_fraction) / known.value
    assert low.min() > 1.6e-4 and low.max() < 4.6e-4
    dense = np.linspace(0.56, 0.74, 30)
    assert theory.etomica_crystal(dense) == pytest.approx(speedy_crystal(dense), rel=1.1e-4)


def test_the_two_crystals_of_spheres_agree():
    eta = np.linspace(0.545, 0.72, 30)
    assert theory.alder_hoover_young_crystal(eta, 3) == pytest.approx(speedy_crystal(eta), rel=1.5e-3)


@pytest.mark.parametrize("dimension", [2, 3])
def test_free_volume_rules_at_close_packing(dimension):
    eta = theory.CLOSE_PACKING[dimension] * (1.0 - 1e-5)
    z = theory.alder_hoover_young_crystal(eta, dimension)
    assert z * 1e-5 == pytest.approx(dimension, rel=1e-4)


def test_the_crystal_of_discs_has_the_pressure_of_a_simulation():
    eta, pressure, error = CRYSTAL_OF_1024_DISCS
    z = theory.alder_hoover_young_crystal(eta, 2)
    z += theory.crystal_finite_size_correction(z, 1024)
    assert abs(z * eta * 4.0 / np.pi - pressure) < 2.0 * error


@pytest.mark.parametrize("eta", [0.4, 0.7405, np.nan])
def test_no_crystal_outside_its_range(eta):
    with pytest.raises(ValueError, match="packing_fraction"):
        theory.etomica_crystal(eta)
