import pytest
from reproduction.claims.data import judged
from reproduction.families.displacement.data import discs, spheres

from gaspart.reproduction.families.displacement import claims as displacement


def test_spheres_as_theory_says_agree():
    found = judged(displacement.msd_spheres(spheres()))
    assert len(found) == 6
    assert sum("Erpenbeck and Wood" in text for text in found) == 2
    assert set(found.values()) == {"agrees"}


def test_discs_as_mode_coupling_says_agree():
    found = judged(displacement.msd_discs(discs()))
    assert len(found) == 4
    assert set(found.values()) == {"agrees"}


def scaled(ds, name, factor, where):
    """A copy in which a column is multiplied at some points."""
    column = ds[name].values.copy()
    column[where] *= factor
    return ds.assign({name: (ds[name].dims, column)})


@pytest.mark.parametrize(
    ("name", "factor", "where", "text"),
    [
        ("diffusion", 0.97, [0], "dilute limit"),
        ("msd", 1.02, [5], "msd over Enskog's"),
    ],
)
def test_each_claim_about_spheres_can_fail(name, factor, where, text):
    found = judged(displacement.msd_spheres(scaled(spheres(), name, factor, where)))
    assert {verdict for claim, verdict in found.items() if text in claim} == {"disagrees"}


def test_a_limit_that_does_not_exclude_the_first_approximation_is_inconclusive():
    ds = spheres()
    ds["diffusion_error"] = 6.0 * ds["diffusion_error"]
    found = judged(displacement.msd_spheres(ds))
    assert {verdict for claim, verdict in found.items() if "dilute" in claim} == {"inconclusive"}


def test_no_size_dependence_disagrees_and_a_noisy_one_is_inconclusive():
    text = "slope of D against 1/L at packing fraction 0.3"
    ds = spheres()
    assert judged(displacement.msd_spheres(ds.assign(size_slope=0.0)))[text] == "disagrees"
    assert judged(displacement.msd_spheres(ds.assign(size_slope_error=0.1)))[text] == "inconclusive"


def test_without_dilute_points_the_limit_is_inconclusive():
    ds = spheres().isel(point=slice(1, None))
    found = judged(displacement.msd_spheres(ds))
    assert {verdict for claim, verdict in found.items() if "dilute" in claim} == {"inconclusive"}


def test_a_plateau_of_discs_disagrees_and_a_noisy_slope_is_inconclusive():
    flat = scaled(discs(), "logarithmic_slope", 0.0, [0, 1])
    found = judged(displacement.msd_discs(flat))
    assert {verdict for claim, verdict in found.items() if "ln t" in claim} == {"disagrees"}
    noisy = scaled(discs(), "logarithmic_slope_error", 10.0, [0, 1])
    found = judged(displacement.msd_discs(noisy))
    assert {verdict for claim, verdict in found.items() if "ln t" in claim} == {"inconclusive"}


def test_velocities_that_are_not_the_displacements_disagree():
    ds = discs()
    found = judged(displacement.msd_discs(scaled(ds, "integral_difference", 30.0, [2])))
    assert {verdict for claim, verdict in found.items() if "Green-Kubo" in claim} == {"disagrees"}
