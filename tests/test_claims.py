import math

import numpy as np
import pytest

from gaspart import claims
from gaspart.claims import Claim, holm, judge


def claim(measured=1.0, uncertainty=0.01, required=0.02, expected=1.0, kind="test", text="Z at 0.1", **more):
    """A claim in which only what the test is about needs to be said."""
    return Claim(text, kind, measured, uncertainty, required, expected, "theory", fails_if="Z is off", **more)


def test_deviation_combines_both_uncertainties():
    assert claim(1.05, 0.03, expected_uncertainty=0.04).deviation_sigma == pytest.approx(1.0)
    assert claim(0.95, 0.05).deviation_sigma == pytest.approx(-1.0)


def test_three_sigma_is_the_edge_for_a_claim_alone():
    assert judge([claim(1.0 + 2.99 * 0.01)]) == ["agrees"]
    assert judge([claim(1.0 - 2.99 * 0.01)]) == ["agrees"]
    assert judge([claim(1.0 + 3.01 * 0.01)]) == ["disagrees"]
    assert judge([claim(1.0 - 3.01 * 0.01)]) == ["disagrees"]


def test_too_large_an_uncertainty_is_inconclusive_whatever_the_value():
    assert judge([claim(1.0, 0.021)]) == ["inconclusive"]
    assert judge([claim(50.0, 0.021)]) == ["inconclusive"]


@pytest.mark.parametrize("broken", [math.nan, math.inf, -math.inf])
def test_numbers_that_are_not_finite_are_inconclusive(broken):
    assert judge([claim(broken)]) == ["inconclusive"]
    assert judge([claim(expected=broken)]) == ["inconclusive"]
    assert judge([claim(uncertainty=abs(broken))]) == ["inconclusive"]


def test_one_of_many_at_just_over_three_sigma_is_no_disagreement():
    family = [claim(1.0 + 3.2 * 0.01), *[claim(text=f"Z at {k}") for k in range(20)]]
    assert judge(family)[0] == "agrees"
    assert judge([claim(1.0 + 4.2 * 0.01), *family[1:]])[0] == "disagrees"


def test_inconclusive_claims_and_identities_do_not_weaken_the_family():
    many = [claim(text=f"Z at {k}", uncertainty=1.0) for k in range(50)]
    identities = [claim(text=f"T at {k}", kind="identity") for k in range(50)]
    assert judge([claim(1.0 + 3.1 * 0.01), *many, *identities])[0] == "disagrees"
    assert judge([claim(1.0 + 3.1 * 0.01, kind="identity"), *family_of(20)])[0] == "disagrees"


def family_of(size):
    """That many claims which agree."""
    return [claim(text=f"Z at {k}") for k in range(size)]


def test_holm_steps_down():
    # 0.01 <= 0.05/4, then 0.0166 <= 0.05/3; 0.03 > 0.05/2 stops it, although 0.04 <= 0.05 would pass.
    assert holm([0.04, 0.0166, 0.03, 0.01], 0.05) == [False, True, False, True]
    assert holm([0.03, 0.03], 0.05) == [False, False]
    assert holm([], 0.05) == []


def test_family_of_true_claims_is_wrong_as_seldom_as_one_test():
    generator = np.random.default_rng(11)
    deviations = generator.standard_normal((4000, 30))
    wrong = sum("disagrees" in judge([claim(1.0 + 0.01 * d) for d in row]) for row in deviations)
    assert wrong <= 25  # 0.0027 of 4000 is 11


def test_bounds():
    common = {"source": "theory", "fails_if": "it is not"}
    assert judge([Claim.at_least("d", "test", 0.61, 0.001, 0.01, 0.60, **common)]) == ["agrees"]
    assert judge([Claim.at_least("d", "test", 0.598, 0.001, 0.01, 0.60, **common)]) == ["inconclusive"]
    assert judge([Claim.at_least("d", "test", 0.59, 0.001, 0.01, 0.60, **common)]) == ["disagrees"]
    assert judge([Claim.at_most("d", "test", 0.59, 0.001, 0.01, 0.60, **common)]) == ["agrees"]
    assert judge([Claim.at_most("d", "test", 0.61, 0.001, 0.01, 0.60, **common)]) == ["disagrees"]
    exponent = Claim.within("exponent", "test", 1.03, 0.01, 1.0, 0.05, **common)
    assert exponent.deviation_sigma == 0.0
    assert exponent.required_uncertainty == pytest.approx(0.025)
    assert exponent.claim == "exponent (within 0.95 to 1.05)"
    assert judge([exponent]) == ["agrees"]
    beyond = Claim.within("exponent", "test", 1.09, 0.01, 1.0, 0.05, **common)
    assert beyond.deviation_sigma == pytest.approx(4.0)
    assert judge([beyond]) == ["disagrees"]
    assert judge([Claim.within("exponent", "test", 1.0, 0.03, 1.0, 0.05, **common)]) == ["inconclusive"]


def test_exact_numbers_have_no_spread():
    assert judge([claim(3.0, 0.0, 0.0, 3.0)]) == ["agrees"]
    assert judge([claim(4.0, 0.0, 0.0, 3.0)]) == ["disagrees"]
    assert claim(2.0, 0.0, 0.0, 3.0).deviation_sigma == -math.inf


def test_chi_square_claim_is_two_sided():
    def of(value):
        return Claim.chi_square("Maxwell", "test", value, 100, "Maxwell", "speeds are not Maxwell's")

    assert of(100.0).measured == 1.0
    assert abs(of(99.33).deviation_sigma) < 0.01  # the median
    assert judge([of(100.0)]) == ["agrees"]
    assert judge([of(160.0)]) == ["disagrees"]
    assert of(160.0).deviation_sigma > 3.0
    assert judge([of(50.0)]) == ["disagrees"]
    assert of(50.0).deviation_sigma < -3.0
    assert judge([of(1e5)]) == ["disagrees"]


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"kind": "guess"}, "kind: 'guess'"),
        ({"text": " "}, "claim: empty"),
        ({"uncertainty": -1.0}, "uncertainty: -1"),
    ],
)
def test_malformed_claims_are_refused(change, message):
    with pytest.raises(ValueError, match=message):
        claim(**change)


def test_a_claim_must_say_what_would_make_it_fail():
    with pytest.raises(ValueError, match="fails_if: empty"):
        Claim("Z", "test", 1.0, 0.1, 0.1, 1.0, "theory")


def test_table_goes_out_and_comes_back(tmp_path):
    path = tmp_path / "claims" / "virial_discs.csv"
    made = [
        claim(np.float64(1.234), np.float32(0.01), 0.02, 1.23, expected_uncertainty=0.004),
        claim(9.0, text='Z at "0.2", dense'),
        claim(uncertainty=math.nan, kind="reproduction", text="Z at 0.3"),
    ]
    claims.write(path, "virial_discs", made)
    assert path.read_text().splitlines()[0] == ",".join(claims.COLUMNS)
    rows = claims.read(path)
    assert [row["verdict"] for row in rows] == judge(made) == ["agrees", "disagrees", "inconclusive"]
    assert [row["claim"] for row in rows] == [one.claim for one in made]
    assert rows[0]["measured"] == 1.234
    assert rows[0]["source"] == "theory (± 0.004)"
    assert rows[0]["deviation_sigma"] == pytest.approx(made[0].deviation_sigma, abs=1e-3)
    assert not list(path.parent.glob("*.partial"))

    table = claims.collect([path, path])
    assert tuple(table.columns) == claims.COLUMNS
    assert len(table) == 6
    assert claims.summary(table) == "6 claims: 2 agree, 2 disagree, 2 inconclusive"


def test_collecting_nothing_gives_an_empty_table():
    table = claims.collect([])
    assert tuple(table.columns) == claims.COLUMNS
    assert claims.summary(table) == "0 claims: 0 agree, 0 disagree, 0 inconclusive"


def test_two_claims_with_one_text_are_refused(tmp_path):
    with pytest.raises(ValueError, match="stands twice"):
        claims.write(tmp_path / "a.csv", "figure", [claim(), claim()])
    assert not (tmp_path / "a.csv").exists()


def test_foreign_tables_are_refused(tmp_path):
    path = tmp_path / "other.csv"
    path.write_text("a,b\n1,2\n")
    with pytest.raises(ValueError, match=r"other\.csv: not a claims table"):
        claims.read(path)
    claims.write(path, "figure", [claim()])
    path.write_text(path.read_text().replace(",agrees,", ",perhaps,"))
    with pytest.raises(ValueError, match="verdict: 'perhaps'"):
        claims.read(path)
