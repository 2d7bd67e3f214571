"""Walls that hold particles: wells, where detailed balance holds, and the sticky rule, where it does not."""

import math

import pytest

import gaspart as gp

SEARCHES = pytest.mark.parametrize("search", ["boxes", "pairs"])


def sent(speed, face, x=5.0, mass=1.0, across=0.25, particles=(), search="boxes"):
    """One particle flying along x in a container with one face of a kind, at x = 0; a heavy one at rest is
    there so that all these scenes, and those of test_thermal, need the same kernels."""
    particles = [gp.Particle((x, 5.0, 5.0), (speed, across, 0.0), 0.5, mass), *particles]
    heavy = gp.Particle((9.0, 1.0, 1.0), (0.0, 0.0, 0.0), 0.5, 100.0)
    scene = gp.Scene(gp.Container((10.0,) * 3), particles=[*particles, heavy], faces={"x_low": face})
    sim = gp.Simulation(scene, gp.EventDriven(search))
    sim.record_events = True
    return sim


@pytest.mark.interpreted
@SEARCHES
def test_a_particle_falls_into_a_well_and_climbs_out(search):
    """In at x = 1.5 with sqrt(v^2 + 2 depth/m), thrown back at 0.5, out with the old speed."""
    sim = sent(-1.0, gp.Well(depth=3.0, width=1.0), mass=2.0, search=search)
    sim.advance(max_events=3)
    assert sim.events["time"] == pytest.approx([3.5, 4.0, 4.5], rel=1e-15)
    assert sim.events["particles"].tolist() == [[0, -1]] * 3
    assert sim.events["positions"][:, 0, 0].tolist() == [1.5, 0.5, 1.5]
    assert sim.events["velocities"][:, 0].tolist() == [[v, 0.25, 0.0] for v in (-2.0, 2.0, 1.0)]
    assert sim.tally.wall_hits.tolist() == [1, 0, 0, 0, 0, 0]
    assert sim.tally.wall_impulse[0] == 4.0  # of the way in, the hit and the way out together


@pytest.mark.interpreted
def test_the_energy_counts_the_well():
    sim = sent(-1.0, gp.Well(depth=3.0, width=1.0), mass=2.0)
    assert sim.state.energy == 1.0625
    sim.advance(duration=3.75)
    assert sim.state.potential_energy == -3.0
    assert sim.state.well_energies.tolist() == [-3.0, 0.0]
    assert sim.state.energy == 1.0625
    sim.check_invariants()


@pytest.mark.interpreted
@SEARCHES
def test_a_slow_particle_does_not_leave_a_well(search):
    face = gp.Well(depth=0.5, width=1.0)
    for speed, leaves in ((1.0, False), (1.0 + 1e-9, True)):  # m v^2 / 2 > depth or not
        sim = sent(speed, face, x=1.0, search=search)
        assert sim.state.energy == pytest.approx(0.5 * speed**2 + 0.03125 - 0.5)
        sim.advance(max_events=1)
        assert (sim.state.velocities[0, 0] > 0.0) == leaves
        assert (sim.state.well_energies[0] == 0.0) == leaves
        sim.check_invariants()


@pytest.mark.interpreted
@SEARCHES
def test_a_slow_particle_sticks_and_glides(search):
    sim = sent(-0.5, gp.Sticky(momentum=1.0), mass=2.0 - 1e-9, search=search)
    sim.advance(duration=12.0)
    state = sim.state
    assert state.positions[0] == pytest.approx([0.5, 8.0, 5.0], rel=1e-14)
    assert state.velocities[0].tolist() == [0.0, 0.25, 0.0]
    assert state.vibrations[0] == pytest.approx(0.25, rel=1e-8)
    assert sim.tally.wall_impulse[0] == pytest.approx(1.0, rel=1e-8)
    sim.check_invariants()
    fast = sent(-0.5, gp.Sticky(momentum=1.0), mass=2.0, search=search)
    fast.advance(duration=12.0)
    assert fast.state.velocities[0, 0] == 0.5


@pytest.mark.interpreted
@SEARCHES
@pytest.mark.parametrize(("speed", "held"), [(0.6, 0.305), (0.9, 0.0)])
def test_a_stuck_particle_is_set_free_with_all_its_energy(search, speed, held):
    """It sticks with an energy of 1/8, to leave it needs 1/2; a blow adds v^2 / 2."""
    blow = gp.Particle((5.0, 5.0, 5.0), (-speed, 0.0, 0.0), 0.5)
    sim = sent(-0.5, gp.Sticky(momentum=1.0), x=1.0, across=0.0, particles=[blow], search=search)
    sim.advance(duration=3.0)
    assert sim.state.vibrations.tolist() == [0.125, 0.0, 0.0]
    sim.advance(duration=4.0)
    assert sim.state.vibrations == pytest.approx([held, 0.0, 0.0])
    assert sim.state.velocities[0] == pytest.approx([0.0, 0.0, 0.0], abs=1e-14)
    # set free, the particle leaves and passes its momentum to the other, which stands before it
    leaving = math.sqrt(0.25 + speed**2) if held == 0.0 else 0.0
    assert sim.state.velocities[1] == pytest.approx([leaving, 0.0, 0.0])
    sim.check_invariants()


@pytest.mark.parametrize(
    ("change", "key"),
    [
        ({"faces": {"x_low": {"kind": "well", "depth": 1.0, "width": 8.0}}}, "faces.x_low.width"),
        ({"faces": {"y_low": {"kind": "sticky", "momentum": 1.0}}}, "faces.y_low"),
        ({"faces": {"x_low": {"kind": "well", "depth": 1.0}}}, "faces.x_low.width"),
    ],
)
def test_what_is_refused(change, key):
    particle = {"position": [2.0, 2.0], "velocity": [0.0, 0.0], "radius": 1.0}
    scene = {"container": {"lengths": [10.0, 10.0]}, "particles": [particle], "gravity": [0.0, -1.0]}
    with pytest.raises(gp.SceneError) as caught:
        gp.Scene.from_dict(scene | change)
    assert caught.value.key == key
