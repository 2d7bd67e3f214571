"""Mixtures: exact limits, closed forms of the literature, and the virial theorem."""

import numpy as np
import pytest

import gaspart as gp
from gaspart import theory
from gaspart.theory.mixtures import MIXTURE_THEORIES

CASES = [(name, d) for name, where in MIXTURE_THEORIES.items() for d in where]
ETA = (0.05, 0.3, 0.45)
SIZES, NUMBERS = np.array([1.0, 0.6, 0.25]), np.array([1.0, 3.0, 5.0])


def moment(power):
    return (NUMBERS / NUMBERS.sum()) @ SIZES**power


@pytest.mark.parametrize(("name", "dimension"), CASES)
@pytest.mark.parametrize("eta", ETA)
def test_equal_sizes_are_the_pure_fluid(name, dimension, eta):
    exact = (
        theory.carnahan_starling(eta) if name == "boublik" else theory.compressibility_factor(eta, dimension)
    )
    for sizes, numbers in (([2.0], None), ([3.0, 3.0], [1, 9])):
        z = theory.mixture_compressibility_factor(eta, dimension, sizes, numbers, name)
        assert z == pytest.approx(float(exact), rel=1e-12)
        contact = theory.mixture_contact_values(eta, dimension, sizes, numbers, name)
        assert contact == pytest.approx(np.full(contact.shape, (z - 1.0) / (2.0 ** (dimension - 1) * eta)))


@pytest.mark.parametrize(("name", "dimension"), CASES)
def test_z_follows_from_the_contact_values_by_the_virial_theorem(name, dimension):
    eta, parts = 0.4, NUMBERS / NUMBERS.sum()
    contact = theory.mixture_contact_values(eta, dimension, SIZES, NUMBERS, name)
    between = 0.5 * np.add.outer(SIZES, SIZES)
    sums = (np.outer(parts, parts) * between**dimension * contact).sum() / moment(dimension)
    z = theory.mixture_compressibility_factor(eta, dimension, SIZES, NUMBERS, name)
    assert z == pytest.approx(1.0 + 2.0 ** (dimension - 1) * eta * sums, rel=1e-12)


@pytest.mark.parametrize(("name", "dimension"), CASES)
def test_the_second_virial_coefficient_is_exact(name, dimension):
    parts = NUMBERS / NUMBERS.sum()
    between = 0.5 * np.add.outer(SIZES, SIZES)
    exact = 2.0 ** (dimension - 1) * (np.outer(parts, parts) * between**dimension).sum() / moment(dimension)
    z = theory.mixture_compressibility_factor(1e-6, dimension, SIZES, NUMBERS, name)
    assert (z - 1.0) / 1e-6 == pytest.approx(exact, rel=1e-5)


@pytest.mark.parametrize("eta", ETA)
def test_boubliks_and_mansooris_closed_form(eta):
    first, second = moment(1) * moment(2) / moment(3), moment(2) ** 3 / moment(3) ** 2
    void = 1.0 - eta
    exact = 1.0 / void + 3.0 * eta * first / void**2 + eta**2 * (3.0 - eta) * second / void**3
    z = theory.mixture_compressibility_factor(eta, 3, SIZES, NUMBERS, "boublik")
    assert z == pytest.approx(exact, rel=1e-12)


@pytest.mark.parametrize("eta", ETA)
def test_closed_form_of_discs_from_the_pure_fluid(eta):
    """Santos, Yuste and Lopez de Haro 1999, for discs; the equation of 2002 has the same Z there."""
    part, pure = moment(1) ** 2 / moment(2), float(theory.compressibility_factor(eta, 2))
    for name in ("linear", "santos"):
        z = theory.mixture_compressibility_factor(eta, 2, SIZES, NUMBERS, name)
        assert z == pytest.approx((1.0 - part) / (1.0 - eta) + part * pure, rel=1e-12)


@pytest.mark.parametrize("dimension", [2, 3])
def test_limits_of_one_particle_of_another_size(dimension):
    """A point meets free volume, 1 / (1 - eta); an infinitely large particle is a wall: Z of the fluid."""
    eta = 0.3
    pure = [0.0, 1.0]
    point = theory.mixture_contact_values(eta, dimension, [1e-9, 1.0], pure)
    assert point[0, 1] == pytest.approx(1.0 / (1.0 - eta), rel=1e-6)
    wall = theory.mixture_contact_values(eta, dimension, [1e9, 1.0], pure)
    assert wall[0, 1] == pytest.approx(float(theory.compressibility_factor(eta, dimension)), rel=1e-6)


@pytest.mark.parametrize("dimension", [2, 3])
def test_collision_rates(dimension):
    state = 0.3, dimension, [0.8, 0.8], [1, 3]
    rates = theory.mixture_collision_rates(*state, temperature=2.0, masses=4.0)
    exact = theory.collision_rate(0.3, dimension, 0.8, 2.0, 4.0)
    assert rates.sum(axis=1) == pytest.approx(np.full(2, float(exact)), rel=1e-12)
    rates = theory.mixture_collision_rates(0.3, dimension, SIZES, NUMBERS, masses=[4.0, 1.0, 0.1])
    assert NUMBERS[:, None] * rates == pytest.approx((NUMBERS[:, None] * rates).T, rel=1e-12)


@pytest.mark.parametrize(
    ("key", "arguments"),
    [
        ("theory", (0.3, 2, [1.0, 2.0], None, "boublik")),
        ("theory", (0.3, 3, [1.0, 2.0], None, "ideal")),
        ("packing_fraction", (0.9, 3, [1.0, 2.0])),
        ("dimension", (0.3, 4, [1.0, 2.0])),
        ("diameters", (0.3, 3, [1.0, 0.0])),
        ("diameters", (0.3, 3, [])),
        ("diameters", (0.3, 3, [np.nan])),
        ("fractions", (0.3, 3, [1.0, 2.0], [1.0])),
        ("fractions", (0.3, 3, [1.0, 2.0], [-1.0, 2.0])),
    ],
)
def test_other_arguments_are_refused(key, arguments):
    for function in (
        theory.mixture_compressibility_factor,
        theory.mixture_contact_values,
        theory.mixture_collision_rates,
    ):
        with pytest.raises(gp.SceneError, match=f"^{key} = ") as caught:
            function(*arguments)
        assert "\n" not in str(caught.value)


@pytest.mark.parametrize("masses", [0.0, [1.0, 2.0, 3.0], [1.0, np.inf]])
def test_masses_are_checked(masses):
    with pytest.raises(gp.SceneError, match="^masses = "):
        theory.mixture_collision_rates(0.3, 3, [1.0, 2.0], masses=masses)
