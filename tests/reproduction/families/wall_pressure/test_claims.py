from reproduction.claims.data import judged
from reproduction.families.wall_pressure.data import pressures

from gaspart.reproduction.families.wall_pressure.claims import wall_pressure


def verdicts(dataset):
    return judged(wall_pressure(dataset))


def test_right_data_agree():
    found = verdicts(pressures())
    assert set(found.values()) == {"agrees"}
    assert any(text.startswith("pressure of 125 spheres") for text in found)
    assert sum("bulk pressure at N/V" in text for text in found) == 2


def test_a_bias_of_half_a_percent_is_found():
    found = verdicts(pressures(factor=1.005))
    assert found["pressure of spheres between two walls over theory's, mean of 3 slits"] == "disagrees"


def test_short_runs_are_inconclusive():
    assert "inconclusive" in verdicts(pressures(relative_error=0.01)).values()


def test_an_energy_scale_is_found():
    dataset = pressures()
    dataset["pressure"] = dataset["pressure"] * dataset["temperature"] ** 0.01
    found = verdicts(dataset)
    assert next(v for text, v in found.items() if text.startswith("exponent")) == "disagrees"
