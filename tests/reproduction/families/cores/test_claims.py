import pytest
from reproduction.claims.data import judged
from reproduction.families.cores.data import measured

from gaspart.reproduction.families.cores.claims import cores

NAN = float("nan")
SPEEDS = [1.6, 1.9, 1.9, 1.95, 1.7, NAN, 1.8, NAN, NAN]


def test_what_is_right_agrees():
    found = judged(cores(measured(speed=SPEEDS)))
    assert len(found) == 7 and set(found.values()) == {"agrees"}


@pytest.mark.parametrize(
    ("changed", "start"),
    [
        ({"speed": [1.6, 1.3, *SPEEDS[2:]]}, "speed with two threads"),
        ({"speed": [*SPEEDS[:3], 1.5, *SPEEDS[4:]]}, "speed of two runs at once"),
        (
            {"same": [1, 1, 1, 1, 1, 0, 1, 1, 1]},
            "runs on several cores that differ from one core in any bit",
        ),
    ],
)
def test_what_is_wrong_is_found(changed, start):
    found = judged(cores(measured(**{"speed": SPEEDS} | changed)))
    wrong = [text for text, verdict in found.items() if verdict == "disagrees"]
    assert len(wrong) == 1 and wrong[0].startswith(start)


def test_a_machine_with_one_core_compares_bits_and_decides_no_speed():
    found = judged(cores(measured(speed=[NAN] * 9)))
    bits = {text: verdict for text, verdict in found.items() if text.startswith("runs on several")}
    assert set(bits.values()) == {"agrees"}
    assert {found[text] for text in found.keys() - bits} == {"inconclusive"}
