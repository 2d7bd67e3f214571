"""Errors of pilots and of runs until accurate, extrapolated: planted series and pressures on walls."""

import math

import numpy as np
import pytest
from scenes import gas
from scipy.signal import lfilter

import gaspart as gp
from gaspart.accuracy.estimates import components, with_stores, without_stores
from gaspart.accuracy.pilot import Pilot
from gaspart.accuracy.reached import Examiner

SERIES = 400
LONG = 16
"""Length of the run that a short series predicts, over its own."""


def planted(correlation, stored, samples, seed):
    """(SERIES, samples) of mean 5, and (SERIES, samples + 1) of a store whose changes they hold `stored`
    times; the noise beside that has the spectrum 1 at frequency 0."""
    rng = np.random.default_rng(seed)
    noise = rng.standard_normal((SERIES, samples + 200))
    noise = (1.0 - correlation) * lfilter([1.0], [1.0, -correlation], noise)[:, 200:]
    store = rng.standard_normal((SERIES, samples + 1))
    return 5.0 + noise + stored * np.diff(store), store


@pytest.mark.parametrize("correlation", [-0.5, 0.7, pytest.param(0.0, marks=pytest.mark.thorough)])
@pytest.mark.parametrize("stored", [0.0, 12.0, pytest.param(3.0, marks=pytest.mark.thorough)])
def test_a_short_series_predicts_the_error_of_a_long_one(correlation, stored):
    """The interval between samples is 1."""
    series, store = planted(correlation, stored, 384, 1)
    found = [with_stores(one, its[:, None], 1.0) for one, its in zip(series, store, strict=True)]
    for times in (1, LONG):
        longer, _ = planted(correlation, stored, 384 * times, 2)
        true = longer.mean(axis=1).std()
        predicted = np.median([one.error(384.0 * times) for one in found])
        assert predicted == pytest.approx(true, rel=0.12)  # the true one is known to 3.5 %
    kept = np.median([one.stored for one in found])
    assert kept == pytest.approx(2.0 * stored**2, rel=0.05, abs=0.05)


def test_a_series_that_controls_explain_to_rounding_has_a_known_error():
    series = np.tile([1.0, 2.0, 1.5], 20)
    explained = without_stores(series, np.full(60, 1.5), 1.0, controls=3)
    assert (explained.error(60.0), explained.freedom) == (0.0, 59.0 - 3.0)
    unchanged = without_stores(np.ones(60), np.ones(60), 1.0, controls=3)
    assert (unchanged.error(60.0), unchanged.freedom) == (0.0, 1.0)


WALLED = gas(2, 64, 0.04, boundary="wall", exact_temperature=True)


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    """16 times 384 intervals that are shorter than a particle's way from wall to wall."""
    path = tmp_path_factory.mktemp("walled") / "run.nc"
    return gp.run(WALLED, gp.EventDriven("direct"), 5, LONG * 512 * 2.0, 2.0, path)


@pytest.mark.thorough
def test_a_short_run_predicts_the_error_of_pressures_in_a_long_one(run):
    """The errors of sixteen short runs are their scatter, and predict that of all together; those of 16
    blocks of each predict too much."""
    with gp.open_trajectory(run) as data:
        whole = components(data, "pressure", start=0.0)
        starts = range(0, data.sizes["frame"] - 512, 512)
        parts = [data.isel(frame=slice(first, first + 513)) for first in starts]
        short = [components(part, "pressure", start=float(part.time[0])) for part in parts]
        blocks = [gp.analysis.wall_pressure(part, start=float(part.time[0])) for part in parts]
    for face, long in whole.items():
        predicted = np.sqrt(np.mean([one[face].error(long.time) ** 2 for one in short]))
        assert predicted == pytest.approx(long.estimate.error, rel=0.3)
        scatter = np.std([one[face].value for one in short], ddof=1)
        claimed = np.sqrt(np.mean([one[face].estimate.error ** 2 for one in short]))
        assert claimed == pytest.approx(scatter, rel=0.5)  # of 16, known to 18 %
        by_blocks = np.sqrt(np.mean([float(one.error.sel(face=face)) ** 2 for one in blocks]) / LONG)
        assert by_blocks > 1.3 * predicted


def test_a_run_until_accurate_has_the_errors_of_its_pilot(run):
    asked = gp.Accuracy("pressure", 0.01)
    with gp.open_trajectory(run) as data:
        known = components(data, "pressure")
        (reached,) = Examiner().examine([data], (asked,), data.sizes["frame"])
    worst = known[reached.component]
    assert reached.value == worst.value and reached.error >= worst.estimate.error
    pilot = Pilot(gp.EventDriven(), 1.0, components={"": worst})
    assert pilot.component.reaches(worst.time) == pytest.approx(
        worst.accuracy * math.sqrt(worst.freedom / _quantile(worst.freedom))
    )


def _quantile(freedom):
    from scipy.stats import chi2

    return chi2.ppf(0.1, freedom)


@pytest.mark.thorough
def test_components_that_vanish_are_relative_to_the_others(tmp_path):
    scene = gas(2, 32, 0.2)
    stress = gp.Correlations(interval=0.1, lags=8, stress=True)
    path = gp.run(scene, gp.EventDriven("direct"), 5, 64.0, 0.8, tmp_path / "run.nc", correlations=stress)
    with gp.open_trajectory(path) as data:
        found = components(data, "pressure_tensor")
    assert found["xy"].scale == found["xx"].scale > 0.5 * found["xx"].value > abs(found["xy"].value)
    assert all(0.0 < one.accuracy < 0.5 for one in found.values())
