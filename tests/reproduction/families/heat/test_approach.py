import numpy as np
import pytest
from reproduction.families.heat.data import gas, run

from gaspart.reproduction.families.heat.gap import FRAMES, approach
from gaspart.theory.heat import conducting_slab


def test_the_start_of_a_run_is_shown_from_one_temperature_on(tmp_path):
    """Halves at one temperature; of a run with fewer frames the others are missing."""
    point = run(tmp_path, gas(100, 0.5), duration=20.0, equilibration=5.0, samples=8, boxes_per_side=1)
    slab = conducting_slab(10.0, 100 / 360, 2.0, 1.0)
    found = approach(point, slab)
    frames = int(np.isfinite(found["approach_time"]).sum())
    assert 8 < frames < FRAMES and np.isnan(found["approach"][frames:]).all()
    assert abs(found["approach"][0]) < 4.0 * found["approach_error"][0]
    # two halves of 50 spheres at 1.4, the squares of whose components vary by 2
    assert found["approach_error"][0] == pytest.approx(1.4 * np.sqrt(2.0 * 2.0 / (3.0 * 50.0)), rel=0.15)
