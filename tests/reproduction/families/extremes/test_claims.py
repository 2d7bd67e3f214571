"""What the table of extremes claims, and when it does not hold."""

import pytest
from reproduction.families.extremes.data import extremes_data

from gaspart.reproduction.claims import judge
from gaspart.reproduction.families.extremes.claims import stability_extremes


def test_rows_that_pass_or_are_refused_agree():
    claims = stability_extremes(extremes_data())
    assert len(claims) == 2 + 3
    assert set(judge(claims)) == {"agrees"}


def test_a_refusal_is_expected_and_has_one_line():
    for verdict, message in (("passes", ""), ("refused", ""), ("refused", "two\nlines")):
        data = extremes_data()
        data["verdict"][1, 0], data["message"][1, 0] = verdict, message
        assert judge(stability_extremes(data)[:2]) == ["agrees", "disagrees"]


@pytest.mark.parametrize(
    ("changed", "wrong"),
    [
        ({"verdict": "fails", "message": "energy"}, 0),
        ({"verdict": "hangs"}, 0),
        ({"verdict": "refused", "message": "speed = 1: too fast"}, 0),  # which should pass
        ({"missed": -1}, 4),
    ],
)
def test_what_hangs_fails_or_refuses_without_a_line_disagrees(changed, wrong):
    data = extremes_data(**changed)
    verdicts = judge(stability_extremes(data) if wrong else stability_extremes(data)[:2])
    assert [n for n, verdict in enumerate(verdicts) if verdict != "agrees"] == [wrong]
