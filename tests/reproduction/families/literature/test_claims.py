from reproduction.claims.data import judged
from reproduction.families.literature.data import ROWS, beside_others

from gaspart.reproduction.families.literature.claims import literature


def test_values_of_others_agree_and_those_of_other_figures_have_no_claim_of_their_own():
    found = judged(literature(beside_others()))
    assert set(found.values()) == {"agrees"}
    assert len(found) == sum(row[-1] for row in ROWS) + 2
    assert [text for text in found if text.startswith("Z of the fluid of spheres at packing fraction 0.1571")]


def test_a_bias_of_a_tenth_of_a_per_cent_is_found():
    found = judged(literature(beside_others(factor=1.001, noise=0.0)))
    wrong = [text for text, verdict in found.items() if verdict == "disagrees"]
    assert sum(text.startswith("Z of the ") for text in wrong) == 3
    assert any(text.startswith("Z and pressures beside") for text in wrong)


def test_a_bias_of_diffusion_is_found():
    dataset = beside_others()
    dataset["ours"] = dataset["ours"].where(dataset["quantity"] != "diffusion", 1.03 * dataset["ours"])
    found = judged(literature(dataset))
    wrong = {text for text, verdict in found.items() if verdict == "disagrees"}
    assert len(wrong) == 3 and any(text.startswith("transport coefficients") for text in wrong)


def test_values_that_are_too_uncertain_are_inconclusive():
    dataset = beside_others(noise=0.0)
    dataset["ours_error"] = 20.0 * dataset["ours_error"]
    found = judged(literature(dataset))
    single = {verdict for text, verdict in found.items() if " at packing fraction " in text}
    assert single == {"inconclusive"}
