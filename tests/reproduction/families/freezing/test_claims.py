import pytest
from reproduction.claims.data import judged
from reproduction.families.freezing.data import discs, spheres

from gaspart.reproduction.families.freezing import claims as freezing


def verdict(found, text):
    return next(verdict for claim, verdict in found.items() if text in claim)


def test_discs_as_the_literature_has_them_agree():
    found = judged(freezing.freezing_discs(discs()))
    assert len(found) == 9
    plateaus = [found.pop(text) for text in list(found) if text.startswith("plateau pressure of discs in")]
    assert plateaus == ["no verdict"] * 2  # of 1024 discs, beside the literature's 10^6
    assert set(found.values()) == {"agrees"}


def test_the_crystal_of_discs_is_compared_in_a_system_of_the_same_size():
    data = discs()
    data["count"] = data["count"] * 4
    assert not any("1024" in text for text in judged(freezing.freezing_discs(data)))


def test_the_liquid_of_discs_is_compared_where_it_is_published():
    data = discs()
    elsewhere = data.assign_coords(compared_packing_fraction=data["compared_packing_fraction"] + 0.001)
    without = data.drop_dims("compared_packing_fraction")
    for changed in (elsewhere, without):
        assert not any("870" in text for text in judged(freezing.freezing_discs(changed)))


def test_the_liquid_of_discs_must_be_known_well():
    data = discs()
    data["compared_pressure_error"] = data["compared_pressure_error"] * 4
    found = judged(freezing.freezing_discs(data))
    assert {verdict(found, f"870 discs at packing fraction {eta}") for eta in (0.68, 0.7)} == {"inconclusive"}


def test_spheres_as_the_literature_has_them_agree():
    found = judged(freezing.freezing_spheres(spheres()))
    assert sum("Z of the crystal" in text for text in found) == 3
    assert (
        found.pop("Z of the crystal at packing fraction 0.5, from the crystal") == "no verdict"
    )  # superheated
    assert sum("Z of the fluid" in text for text in found) == 5
    assert set(found.values()) == {"agrees"}


def test_a_wrong_pressure_of_coexistence_disagrees():
    data = spheres()
    data["slab_pressure"] = data["slab_pressure"] * 1.05
    assert verdict(judged(freezing.freezing_spheres(data)), "k_B T / sigma^3 (within") == "disagrees"


def changed(dataset, name, value, **where):
    dataset = dataset.copy(deep=True)
    dataset[name].loc[where] = value
    return dataset


@pytest.mark.parametrize(
    ("name", "value", "where", "text"),
    [
        ("plateau", 9.35, {"start": "fluid"}, "from the crystal minus"),
        (
            "compared_pressure",
            8.53,
            {"compared_packing_fraction": 0.68, "start": "crystal"},
            "870 discs at p",
        ),
        ("compared_pressure", 8.53, {"compared_packing_fraction": 0.68, "start": "fluid"}, "870 discs at p"),
        ("compared_pressure", 9.15, {"compared_packing_fraction": 0.7, "start": "fluid"}, "fraction 0.7,"),
        ("pressure", 9.6, {"packing_fraction": 0.725, "start": "crystal"}, "crystal of 1024"),
        ("order", 0.6, {"packing_fraction": 0.68, "start": "crystal"}, "most ordered"),
        ("order", 0.3, {"packing_fraction": 0.725, "start": "fluid"}, "least ordered"),
    ],
)
def test_each_claim_about_discs_can_fail(name, value, where, text):
    data = discs()
    if "packing_fraction" in where:
        eta = float(
            data["packing_fraction"].sel(packing_fraction=where["packing_fraction"], method="nearest")
        )
        where = {**where, "packing_fraction": eta}
    found = judged(freezing.freezing_discs(changed(data, name, value, **where)))
    assert verdict(found, text) == "disagrees"


def test_discs_out_of_equilibrium_are_inconclusive():
    data = discs()
    data["plateau_error"] = data["plateau_error"] * 10
    data["disagreement"] = data["disagreement"] + 5.0
    found = judged(freezing.freezing_discs(data))
    assert verdict(found, "from the crystal minus") == "inconclusive"
    assert verdict(found, "starts or halves differ") in ("inconclusive", "disagrees")


@pytest.mark.parametrize(
    ("name", "value", "where", "text"),
    [
        ("order", 0.35, {"packing_fraction": 0.45, "start": "crystal"}, "largest global"),
        ("order", 0.3, {"packing_fraction": 0.56, "start": "crystal"}, "smallest global"),
        ("Z", 12.0, {"packing_fraction": 0.56, "start": "crystal"}, "crystal at packing fraction 0.56"),
        ("Z", 12.0, {"packing_fraction": 0.5, "start": "fluid"}, "fluid at packing fraction 0.5"),
        ("slab_drift", 0.6, {}, "second half"),
        ("crystal_fraction", 0.95, {}, "crystalline at the end"),
    ],
)
def test_each_claim_about_spheres_can_fail(name, value, where, text):
    found = judged(freezing.freezing_spheres(changed(spheres(), name, value, **where)))
    assert verdict(found, text) == "disagrees"


def test_a_crystal_that_creeps_is_less_certain():
    data = changed(spheres(), "pressure_drift", 0.5, packing_fraction=0.56, start="crystal")
    found = judged(freezing.freezing_spheres(data))
    assert verdict(found, "crystal at packing fraction 0.56") == "inconclusive"
