from reproduction.claims.data import judged
from reproduction.families.reversibility.data import measurement

from gaspart.reproduction.families.reversibility import claims as reversibility


def verdicts(dataset):
    return judged(reversibility.reversibility(dataset))


def test_echoes_that_grow_as_they_should_agree(tmp_path):
    found = verdicts(measurement(tmp_path))
    assert len(found) == 3
    assert set(found.values()) == {"agrees"}


def test_another_growth_is_noticed(tmp_path):
    dataset = measurement(tmp_path)
    dataset["growth"] = 1.5 * dataset.growth
    found = verdicts(dataset)
    for other in ("that of two neighbouring runs", "the largest Lyapunov exponent"):
        claim = f"growth of the echo over {other}, spheres, packing fraction 0.1"
        assert found[claim] == "disagrees"


def test_an_engine_that_replays_is_noticed(tmp_path):
    dataset = measurement(tmp_path)
    dataset["memory"] = 3.0 * dataset.memory
    assert any(verdict == "disagrees" for claim, verdict in verdicts(dataset).items() if "memory" in claim)
