import pytest
from reproduction.claims.data import judged
from reproduction.families.estimators.data import measured

from gaspart.reproduction.families.estimators.claims import estimators


def test_what_is_right_agrees():
    found = judged(estimators(measured()))
    assert len(found) == 9 and set(found.values()) == {"agrees"}


@pytest.mark.parametrize(
    ("changed", "start"),
    [
        ({"mean_square": [1.05, 0.9, 2.5, 0.95]}, "mean square"),
        ({"mixture": [12.0, 9.0, 1.8, 1.1]}, "variance"),
        ({"mixture": [30.0, 9.0, 0.8, 1.1]}, "variance"),
        ({"pressures_apart": [0.002, 0.002, 0.02, 0.02]}, "pressure by impulses"),
        ({"pressure": [5.0, 5.0, 1.3, 1.3]}, "squared error"),
    ],
)
def test_what_is_wrong_is_found(changed, start):
    found = judged(estimators(measured(**changed)))
    wrong = [text for text, verdict in found.items() if verdict == "disagrees"]
    assert len(wrong) == 1 and wrong[0].startswith(start)
