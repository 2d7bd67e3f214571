import numpy as np
import pytest

from gaspart import theory
from gaspart.theory.packing import available_fraction, insertion_saturation_uncertainty


def test_saturation_in_boxes_agrees_with_insertions_to_saturation(table):
    for row in table("rsa_boxes"):
        boundary = "periodic" if row["periodic"] else "centres_to_walls"
        arguments = (int(row["dimension"]), row["side_over_diameter"], boundary)
        expected = theory.insertion_saturation(*arguments)
        # Three runs do not give an error of their own: that of the next smaller box stands in.
        error = max(row["standard_error"], 8e-4 if row["runs"] < 5 else 0.0)
        spread = np.hypot(error, insertion_saturation_uncertainty(*arguments))
        assert abs(row["packing_fraction_of_centres"] - expected) < 3.0 * spread


def test_particles_inside_are_equivalent_to_centres_in_the_smaller_box():
    inner, outer = 7.0, 8.0
    centres = theory.insertion_saturation(3, inner, "centres_to_walls")
    inside = theory.insertion_saturation(3, outer, "wall")
    assert inside == pytest.approx(centres * (inner / outer) ** 3, rel=1e-12)


@pytest.mark.parametrize("boundary", ["wall", "centres_to_walls", "periodic"])
@pytest.mark.parametrize("dimension", [2, 3])
def test_large_containers_tend_to_the_infinite_value(dimension, boundary):
    assert theory.insertion_saturation(dimension, 1e9, boundary) == pytest.approx(
        theory.insertion_saturation(dimension), rel=1e-8
    )


@pytest.mark.parametrize(("dimension", "first"), [(2, 4.0), (3, 8.0)])
def test_failures_at_low_density(dimension, first):
    assert theory.failures_per_particle(1e-6, dimension) == pytest.approx(first * 1e-6, rel=1e-4)
    assert available_fraction(0.0, dimension) == 1.0


@pytest.mark.parametrize("dimension", [2, 3])
def test_second_order_of_the_available_fraction_follows_from_the_virial_coefficients(dimension):
    # available = exp(-mu_excess / kT), mu_excess / kT = 2 b2 eta + (3/2) b3 eta^2 + ...
    coefficients, _ = theory.virial_coefficients(dimension)
    eta = 1e-3
    exact = np.exp(-2.0 * coefficients[1] * eta - 1.5 * coefficients[2] * eta**2)
    # What is left is of third order, at most the cube of the first one over six.
    assert abs(available_fraction(eta, dimension) - exact) < (2.0**dimension * eta) ** 3


def test_available_fraction_against_insertion_itself():
    # Discs placed one by one in a periodic square: the fraction of random probes that would fit.
    generator = np.random.default_rng(3)
    side, eta = 20.0, 0.04
    fractions = []
    for _ in range(20):
        centres = np.empty((0, 2))
        while len(centres) < round(theory.number_density(eta, 2) * side**2):
            trial = generator.uniform(0.0, side, 2)
            if fits(trial[None], centres, side)[0]:
                centres = np.vstack([centres, trial])
        fractions.append(fits(generator.uniform(0.0, side, (2000, 2)), centres, side).mean())
    error = np.std(fractions) / np.sqrt(len(fractions))
    assert abs(np.mean(fractions) - available_fraction(eta, 2)) < 4.0 * error


def fits(probes, centres, side):
    """Which probes are a diameter or more from all centres, periodic square."""
    apart = probes[:, None, :] - centres[None, :, :]
    apart -= side * np.round(apart / side)
    return np.all((apart**2).sum(axis=2) >= 1.0, axis=1)


def test_refusals():
    with pytest.raises(ValueError, match="boundary"):
        theory.insertion_saturation(3, 5.0, "open")
    with pytest.raises(ValueError, match="packing_fraction"):
        available_fraction(0.3, 3)
