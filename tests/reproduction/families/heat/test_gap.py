import numpy as np
import pytest
from reproduction.families.heat.data import gas, run

from gaspart.reproduction.families.heat.gap import FRAMES, Averages, Gap, approach, averages
from gaspart.theory.heat import conducting_slab


def test_the_gap_is_where_centres_can_be():
    assert Gap.of(gas(10, 0.5)) == Gap(length=10.0, area=36.0, hot=2.0, cold=1.0, dimension=3)


def test_what_the_walls_give_is_what_the_particles_gain(tmp_path):
    point = run(tmp_path, gas(20, 0.1), duration=200.0, equilibration=20.0, samples=40)
    found = averages(point, Gap.of(gas(20, 0.1)), blocks=8, bins=4)
    blocks = np.diff(found.stored[0, :, 0]) / 25.0 / 36.0  # of 5 samples, each 5 long
    assert found.heat_in - found.heat_out == pytest.approx(blocks, abs=1e-9)
    assert found.imbalance < 1e-9
    assert found.density.mean(axis=1) == pytest.approx(np.full(8, 20 / 360))
    with pytest.raises(ValueError, match="blocks"):
        averages(point, Gap.of(gas(20, 0.1)), blocks=1000, bins=4)


def test_the_flux_is_without_what_the_particles_store():
    """Blocks whose energy fluctuates around a flux of 3, and is given back in the next."""
    rng = np.random.default_rng(5)
    energy = rng.normal(size=(1, 201))
    moment = rng.normal(size=(1, 201))
    change = np.diff(energy)[0]
    found = Averages(
        3.0 + change, np.full(200, 3.0), *np.ones((2, 200, 1)), 0.0, np.stack([energy, moment], -1), 600.0
    )
    assert found.flux().value == pytest.approx(3.0, abs=1e-12)
    assert found.wall_ratio().value == pytest.approx(600.0 / (600.0 + change.sum()))


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
