"""Length of the clocks' epochs: with the present speeds, and without events."""

import numpy as np
import pytest

import gaspart as gp
from gaspart.engines.event.tally import QUIET, Epochs


def alone(side, law=None):
    particle = gp.Particle((0.4 * side, 0.5 * side), (1.0, 0.3), 0.5)
    return gp.Scene(gp.Container((side, side)), particles=[particle], restitution=law)


@pytest.mark.thorough
def test_a_disc_that_has_slowed_down_still_hits_walls():
    """After 237 hits with restitution 0.9 its speed is some 1e-6, and after 3000 some 1e-80."""
    sim = gp.Simulation(alone(5.0, gp.Restitution(0.9)), gp.EventDriven(), seed=1)
    sim.advance(max_events=3000)
    assert sim.tally.wall_hits.sum() == 3000
    sim.check_invariants()
    assert abs(sim.state.velocities).max() < 1e-60
    assert sim.tally.dissipated_energy == pytest.approx(sim.initial_state.kinetic_energy, rel=1e-12)


@pytest.mark.interpreted
@pytest.mark.parametrize("side", [1e4, 1e7, 1e11])
def test_a_disc_in_a_vast_container_hits_its_walls(side):
    sim = gp.Simulation(alone(side), gp.EventDriven(), seed=1)
    sim.record_events = True
    sim.advance(max_events=10)
    flights = [(side - 1.0) * np.arange(10) + (side - 0.5 - start) for start in (0.4 * side, 0.5 * side)]
    expected = np.sort(np.concatenate([flights[0], flights[1] / 0.3]))[:10]
    assert sim.events["time"] == pytest.approx(expected, rel=1e-12)


def together(slower):
    """Two discs that fly almost evenly round a periodic container, 4 apart, and meet after 4 / `slower`."""
    particles = [gp.Particle((2.0, 5.0), (1.0, 0.0), 0.5), gp.Particle((7.0, 5.0), (1.0 - slower, 0.0), 0.5)]
    return gp.Scene(gp.Container((100.0, 10.0), "periodic"), particles=particles)


@pytest.mark.thorough
def test_particles_that_move_together_do_not_miss_one_another():
    """They meet, after 7800 epochs in which they have no event."""
    sim = gp.Simulation(together(2.0**-21), gp.EventDriven())
    sim.advance(max_events=1)
    assert sim.tally.collisions == 1
    assert sim.time == pytest.approx(4.0 * 2.0**21, rel=1e-9)


@pytest.mark.thorough
def test_what_moves_together_by_rounding_only_is_stopped():
    sim = gp.Simulation(together(0.0), gp.EventDriven())
    with pytest.raises(gp.SimulationError, match="particles miss one another"):
        sim.advance(max_events=1)


@pytest.mark.interpreted
def test_epochs_follow_large_changes_only():
    epochs = Epochs(alone(5.0), np.ones(1), 1.0)
    speed = epochs.speed(np.array([[1.0, 0.3]]))
    first = epochs.length(speed)
    assert np.frexp(first)[0] == 0.5
    for factor, kept in ((2.0**-9, True), (2.0**9, True), (2.0**-11, False), (2.0**11, False)):
        assert (epochs.length(factor * speed, first) == first) == kept
    assert epochs.length(0.0) == epochs.length(1e-300)
    assert epochs.quiet(speed, first, 10_000) == first  # longer than a flight through it
    vast = Epochs(alone(1.5e4), np.ones(1), 1.0)
    found = [vast.quiet(speed, first, number) for number in (0, QUIET, QUIET + 3, 10_000)]
    assert found[:3] == [first, first, 8.0 * first] and 1e4 / 1.1 < found[3] < 4e4


@pytest.mark.parametrize("small", [1e-9, 0.4])
def test_an_epoch_of_tiny_particles_is_a_flight_through_the_container(small):
    """Also if only one of many particles is tiny."""
    side = 40.0 if small < 0.4 else 4e4
    species = [gp.Species(1, small), gp.Species(20, 0.5)]
    epochs = Epochs(gp.Scene(gp.Container((side, side)), species), np.ones(21), 0.0)
    assert side <= epochs.length(1.0) <= 2.0 * side
    dense = Epochs(gp.Scene(gp.Container((side, side)), [gp.Species(1, 0.01 * side)]), np.ones(1), 0.0)
    assert 0.02 * side * 2**10 <= dense.length(1.0) <= 0.02 * side * 2**11


def from_rest(power, interval, speed=None, count=100):
    """An inelastic gas that is kicked, from rest or from one speed."""
    rest = {"restitution": gp.Restitution(0.8), "thermostat": gp.Thermostat(power, interval)}
    return gp.Scene(gp.Container((10.0,) * 3), [gp.Species(count, 0.3, speed=speed)], **rest)


@pytest.mark.thorough
@pytest.mark.parametrize("speed", [None, 1e-12, 1e-6])
@pytest.mark.parametrize("power", [2.0**-90, 1.0, 2.0**90])
def test_a_gas_that_kicks_set_in_motion_runs_as_any_other(power, speed):
    """Epochs of a gas at rest have no end: what was short beside them was no collapse. The temperature is
    that of a gas which has moved from the start, 12.5 after the fourth kick; kicks at other scales, which are
    powers of two, give the same bits."""
    scale = 2.0 ** round(np.log2(power) / 3.0)  # of speeds
    scene = from_rest(power, 10.0 / scale, speed and speed * scale)
    sim = gp.Simulation(scene, gp.EventDriven(), seed=1)
    sim.advance(until=40.0 / scale)
    sim.check_invariants()
    assert sim.tally.collisions > 500 and sim.tally.worst_contact < 1e-12
    assert sim.state.kinetic_energy / scene.count == pytest.approx(12.5 * scale**2, rel=0.15)
    plain = gp.Simulation(from_rest(1.0, 10.0, speed), gp.EventDriven(), seed=1)
    plain.advance(until=40.0)
    assert np.array_equal(plain.state.velocities * scale, sim.state.velocities)


def spinning(spin):
    """25 discs near rest, of which one spins."""
    rng = np.random.default_rng(1)
    places = [((n % 5) * 1.2 + 0.6, (n // 5) * 1.2 + 0.6) for n in range(25)]
    particles = [
        gp.Particle(place, tuple(1e-9 * rng.normal(size=2)), 0.5, spin=spin if n == 12 else 0.0)
        for n, place in enumerate(places)
    ]
    return gp.Scene(gp.Container((6.0, 6.0)), particles=particles, restitution=gp.Restitution(0.8, 0.5))


@pytest.mark.thorough
def test_a_spin_that_sets_a_gas_in_motion_is_no_collapse():
    sim = gp.Simulation(spinning(1.0), gp.EventDriven())
    sim.advance(until=1e9)
    sim.check_invariants()
    assert sim.tally.collisions > 1000 and sim.tally.worst_contact < 1e-8


@pytest.mark.interpreted
def test_epochs_are_those_of_shared_energy():
    """A particle of mass 2^40 can make 63 of mass 1, at rest, 2^14 times faster than the rms speed is now."""
    masses = np.append(np.ones(63), 2.0**40)
    epochs = Epochs(alone(5.0), masses, 0.0)
    velocities = np.zeros((64, 2))
    velocities[-1, 0] = 1.0
    shared = np.sqrt(2.0**40 * (63.0 + 2.0**-40)) / 64.0
    assert epochs.base(velocities, 0.0) == epochs.length(shared)
    assert epochs.base(np.zeros((64, 2)), 32.0) == epochs.length(np.sqrt(63.0 / 64.0))


@pytest.mark.interpreted
def test_speeds_that_the_time_does_not_resolve_stop_a_run():
    """After a time of 2^60 an epoch of 2^-9 would not make the time later: the run would have no end."""
    sim = gp.Simulation(from_rest(2.0**40, 2.0**60, count=2), gp.EventDriven(), seed=1)
    sim.advance(until=2.0**60 - 2.0**10)
    with pytest.raises(gp.SimulationError, match="so fast that .* of time holds a thousand flights"):
        sim.advance(until=2.0**61)
