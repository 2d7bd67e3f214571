import math

import pytest
from reproduction.families.reversibility.data import SIDE, measurement

from gaspart.reproduction.families.reversibility.claims import ROUNDINGS


def test_growth_memory_and_jumps(tmp_path):
    dataset = measurement(tmp_path)
    event, step = dataset.isel(row=0), dataset.isel(row=1)
    assert float(event.growth) == pytest.approx(1.47, rel=0.03)
    assert float(event.divergence) == pytest.approx(float(event.growth), rel=0.01)
    assert float(event.memory * event.growth) == pytest.approx(ROUNDINGS - math.log(SIDE), abs=0.5)
    assert float(event.exponent) == pytest.approx(1.47, abs=4.0 * float(event.exponent_error))
    assert (float(event.jumps), float(step.jumps)) == (0.0, 1.0)
    assert float(step.memory) == pytest.approx(8.5, abs=0.6)
    assert float(event.side) == SIDE
