import numpy as np
import pytest
from reproduction.claims.data import judged
from reproduction.families.virial.data import equation_of_state

from gaspart import theory
from gaspart.reproduction.families.virial.claims import virial_discs, virial_spheres

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
