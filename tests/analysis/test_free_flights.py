"""Free flights of recorded events: against a count by hand, and against theory."""

import numpy as np
import pytest
from scenes import gas
from scipy import stats

import gaspart as gp
from gaspart.analysis.collisions import COMPLETE


def recorded(scene, collisions, seed=1):
    """A simulation with so many recorded collisions per particle, after some that are not."""
    sim = gp.Simulation(scene, gp.EventDriven(), seed)
    sim.advance(max_events=5 * scene.count)
    sim.record_events = True
    sim.advance(max_events=int(0.5 * collisions * scene.count))
    return sim


def test_flights_are_those_counted_by_hand():
    sim = recorded(gas(2, 20, 0.2), 80)
    found = gp.analysis.free_flight_times(sim, bins=10)
    events, last, flights = sim.events, {}, []
    for time, pair, velocities in zip(events["time"], events["particles"], events["velocities"], strict=True):
        for particle, velocity in zip(pair.tolist(), velocities, strict=True):
            if particle in last:
                begun, speed = last[particle]
                flights.append((begun, particle % 16, time - begun, speed * (time - begun)))
            last[particle] = time, np.linalg.norm(velocity)
    mean = (sim.time - events["time"][0]) * 20 / (2 * len(events["time"]))
    flights = np.array([flight for flight in flights if flight[0] < sim.time - COMPLETE * mean])
    assert float(found["mean_free_time"]) == pytest.approx(flights[:, 2].mean())  # not of each particle
    assert float(found["mean_free_path"]) == pytest.approx(flights[:, 3].mean())
    density = np.histogram(flights[:, 2], 10, (0, 5 * mean))[0] / len(flights)
    assert np.allclose(found.estimate, density / (0.5 * mean))
    filled = density > 0.0
    freedom = found["free_flight_times_freedom"].values
    assert (freedom[filled] == 15.0).all() and np.isnan(freedom[~filled]).all()


@pytest.mark.parametrize(("dimension", "eta"), [(2, 0.02), (3, 0.002), (3, 0.01)])
def test_a_dilute_gas_flies_as_theory_says(dimension, eta):
    """In a dense gas consecutive collisions are not independent, and short flights rarer than in theory."""
    found = gp.analysis.free_flight_times(recorded(gas(dimension, 1000, eta), 150))
    judged = found.estimate.values * found["mean_free_time"].values > 0.02  # enough in each group
    chi_square = _chi_square(found, judged)
    assert stats.chi2.sf(chi_square, judged.sum()) > 1e-3
    for name in ("mean_free_time", "mean_free_path"):
        error = float(found[f"{name}_error"])
        assert error < 0.01 * float(found[name])
        assert abs(float(found[name] - found[f"{name}_theory"])) < 4.0 * error


def _chi_square(found, judged):
    """Of Student's deviations with 15 degrees of freedom, as Gaussian ones of the same probability."""
    t = ((found.estimate - found.theory) / found.error).values[judged]
    return float((stats.norm.isf(stats.t.sf(np.abs(t), 15)) ** 2).sum())


def test_an_exponential_is_told_apart():
    """The test above could fail: the distribution is not that of one rate for all speeds."""
    found = gp.analysis.free_flight_times(recorded(gas(3, 1000, 0.01), 150))
    judged = found.estimate.values * found["mean_free_time"].values > 0.02
    mean = float(found["mean_free_time"])
    found["free_flight_times_theory"] = np.exp(-found["free_time"] / mean) / mean
    assert stats.chi2.sf(_chi_square(found, judged), judged.sum()) < 1e-6


def test_what_has_no_free_flights_is_refused():
    sim = gp.Simulation(gas(2, 20, 0.2), gp.EventDriven())
    with pytest.raises(gp.SceneError, match="set record_events to True"):
        gp.analysis.free_flight_times(sim)
    with pytest.raises(gp.SceneError, match="must be 32 collisions of a particle or more"):
        gp.analysis.free_flight_times(recorded(gas(2, 20, 0.2), 20))
    with pytest.raises(gp.SceneError, match="has walls, which end flights"):
        gp.analysis.free_flight_times(recorded(gas(2, 20, 0.2, "wall"), 80))
    with pytest.raises(gp.SceneError, match="needs 16 moving particles"):
        gp.analysis.free_flight_times(recorded(gas(2, 10, 0.2), 80))
