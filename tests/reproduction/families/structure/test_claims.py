import numpy as np
import pytest
from reproduction.claims.data import judged
from reproduction.families.structure.data import RATIOS, chemical_potential, structure

from gaspart.reproduction.families.structure import claims


def changed(ds, name, point, value):
    values = ds[name].values.copy()
    values[point] = value
    return ds.assign({name: (ds[name].dims, values)})


def test_true_structure_agrees():
    found = judged(claims.structure(structure()))
    assert len(found) == 5 * 3 + 2
    assert set(found.values()) == {"agrees"}


@pytest.mark.parametrize("name", RATIOS)
def test_each_route_can_disagree(name):
    found = judged(claims.structure(changed(structure(), name, 4, 1.02)))
    assert list(found.values()).count("disagrees") == 1


@pytest.mark.parametrize("name", ["g_gain", "s_gain"])
def test_curves_that_are_no_better_than_percus_and_yevicks_disagree(name):
    found = judged(claims.structure(changed(structure(), name, 2, 0.9)))
    assert [verdict for claim, verdict in found.items() if "Weis" in claim].count("disagrees") == 1


def test_noise_is_inconclusive():
    found = judged(claims.structure(structure(error=0.05)))
    assert {verdict for claim, verdict in found.items() if "over" in claim and "Weis" not in claim} == {
        "inconclusive"
    }


def test_true_insertion_agrees_and_few_successes_give_no_verdict():
    found = judged(claims.chemical_potential(chemical_potential()))
    assert len(found) == 6 + 1 + 2 * 2
    assert set(found.values()) == {"agrees", "no verdict"}
    (failed,) = (claim for claim, verdict in found.items() if verdict == "no verdict")
    assert "spheres, packing fraction 0.5" in failed


def test_a_wrong_chance_disagrees():
    ds = chemical_potential()
    found = judged(claims.chemical_potential(changed(ds, "ratio", 1, 1.05)))
    assert list(found.values()).count("disagrees") == 1
    shifted = ds["inserted"].values + 5.0 * ds["inserted_error"].values
    found = judged(claims.chemical_potential(ds.assign(inserted=("point", shifted))))
    assert {verdict for claim, verdict in found.items() if "all packing" in claim} == {"disagrees"}
    found = judged(claims.chemical_potential(changed(ds, "ln_q_ratio", 2, 0.9)))
    assert [verdict for claim, verdict in found.items() if "ln Q" in claim].count("disagrees") == 1
    assert np.isnan(ds["ln_q_ratio"].values[-1])
