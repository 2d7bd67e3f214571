import numpy as np
import pytest

from gaspart import theory

BULK = theory.number_density(0.35, 3)


def test_the_functional_obeys_the_contact_theorem():
    # Its pressure follows from its bulk alone, the density at the wall from the profile: an exact sum rule.
    _, density = theory.white_bear_slit(BULK, 8.0)
    assert density[0] == pytest.approx(theory.white_bear_pressure(BULK), rel=3e-4)
    assert density[0] == pytest.approx(density[-1], rel=1e-6)


def test_far_from_the_walls_the_functional_has_its_bulk():
    place, density = theory.white_bear_slit(BULK, 11.0, 0.02)
    middle = np.abs(place - 5.0) < 1.0
    assert density[middle].mean() == pytest.approx(BULK, rel=2e-3)


def test_a_dilute_gas_is_uniform():
    _, density = theory.white_bear_slit(1e-5, 3.0, 0.02)
    assert density == pytest.approx(1e-5, rel=1e-3)


def test_first_order_of_the_profile_is_exact():
    # A wall keeps half of a sphere's surroundings free of others: rho(0) / rho_b = 1 + (2 pi / 3) rho_b.
    bulk = 0.01
    _, density = theory.white_bear_slit(bulk, 6.0)
    assert density[0] / bulk == pytest.approx(1.0 + 2.0 * np.pi / 3.0 * bulk, abs=4e-4)


def test_a_narrow_slit_pushes_where_layers_fit():
    pressure = [theory.white_bear_slit(BULK, width, 0.02)[1][0] for width in (2.0, 2.5, 3.0, 3.5)]
    bulk = theory.white_bear_pressure(BULK)
    assert [p > bulk for p in pressure] == [True, False, True, False]


def test_no_slit_narrower_than_a_sphere():
    with pytest.raises(ValueError, match="width"):
        theory.white_bear_slit(BULK, 1.0)
