"""Length of the clocks' epochs: with the present speeds, and without events."""

import numpy as np
import pytest
from referee import check_restored

import gaspart as gp
from gaspart.engines.event.clock_epochs import QUIET, Epochs


def alone(side, restitution=None, radius=0.5, velocity=(1.0, 0.3), boundary="wall"):
    particle = gp.Particle((0.4 * side, 0.5 * side), velocity, radius)
    law = None if restitution is None else gp.Restitution(restitution)
    return gp.Scene(gp.Container((side, side), boundary), particles=[particle], restitution=law)


def test_a_disc_that_has_slowed_down_still_hits_walls():
    """After 237 hits with restitution 0.9 its speed is some 1e-6, and after 3000 some 1e-80."""
    sim = gp.Simulation(alone(5.0, 0.9), gp.EventDriven(), seed=1)
    sim.advance(max_events=3000)
    assert sim.tally.wall_hits.sum() == 3000
    sim.check_invariants()
    assert abs(sim.state.velocities).max() < 1e-60
    assert sim.tally.dissipated_energy == pytest.approx(sim.initial_state.kinetic_energy, rel=1e-12)


@pytest.mark.parametrize("side", [1e7, 1e9, 1e11])
def test_a_disc_in_a_vast_container_hits_its_walls(side):
    sim = gp.Simulation(alone(side), gp.EventDriven(), seed=1)
    sim.record_events = True
    sim.advance(max_events=10)
    expected = np.sort(
        [
            ((side - 1.0) * n + (side - 0.5 - start)) / speed
            for start, speed in ((0.4 * side, 1.0), (0.5 * side, 0.3))
            for n in range(10)
        ]
    )[:10]
    assert sim.events["time"] == pytest.approx(expected, rel=1e-12)


def test_splits_and_checkpoints_change_no_bit_of_a_long_flight():
    ends = np.linspace(0.0, 3e9, 50)[1:]
    check_restored(alone(1e7, 0.9), ends, "state.positions", "state.velocities", "time", seed=1)


def test_a_run_without_possible_events_is_stopped():
    particles = [gp.Particle((x, 5.0), (1.0, 0.0), 0.5) for x in (2.0, 6.0)]
    scene = gp.Scene(gp.Container((10.0, 10.0), "periodic"), particles=particles)
    sim = gp.Simulation(scene, gp.EventDriven(), seed=1)
    with pytest.raises(gp.SimulationError, match="particles miss one another"):
        sim.advance(max_events=1)


def together(slower):
    """Two discs that fly almost evenly round a periodic container, 4 apart, and meet after 4 / `slower`."""
    particles = [gp.Particle((2.0, 5.0), (1.0, 0.0), 0.5), gp.Particle((7.0, 5.0), (1.0 - slower, 0.0), 0.5)]
    return gp.Scene(gp.Container((100.0, 10.0), "periodic"), particles=particles)


def test_particles_that_move_together_do_not_miss_one_another():
    """They meet, after 7800 epochs in which they have no event."""
    sim = gp.Simulation(together(2.0**-21), gp.EventDriven())
    sim.advance(max_events=1)
    assert sim.tally.collisions == 1
    assert sim.time == pytest.approx(4.0 * 2.0**21, rel=1e-9)


def test_what_moves_together_by_rounding_only_is_stopped():
    sim = gp.Simulation(together(0.0), gp.EventDriven())
    with pytest.raises(gp.SimulationError, match="particles miss one another"):
        sim.advance(max_events=1)


def test_epochs_follow_large_changes_only():
    epochs = Epochs(alone(5.0), 1.0)
    speed = epochs.speed(np.array([[1.0, 0.3]]))
    first = epochs.length(speed)
    assert np.frexp(first)[0] == 0.5
    for factor, kept in ((2.0**-9, True), (2.0**9, True), (2.0**-11, False), (2.0**11, False)):
        assert (epochs.length(factor * speed, first) == first) == kept
    assert epochs.length(0.0) == epochs.length(1e-300)
    assert epochs.quiet(speed, first, 10_000) == first  # longer than a flight through it
    vast = Epochs(alone(1e9), 1.0)
    found = [vast.quiet(speed, first, number) for number in (0, QUIET, QUIET + 3, 10_000)]
    assert found[:3] == [first, first, 8.0 * first] and 1e9 / 1.1 < found[3] < 4e9
