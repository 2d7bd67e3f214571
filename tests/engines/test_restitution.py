"""Inelastic and rough contacts, spins and fixed particles, against closed formulae and conservation laws."""

import math
from dataclasses import replace

import numpy as np
import pytest
from referee import events_of, restored
from scenes import gas

import gaspart as gp
from gaspart import theory


@pytest.mark.thorough
def test_smooth_and_elastic_is_the_plain_engine():
    """The law's own code, brought in by a fixed particle out of reach, agrees to rounding."""
    both = [gp.Particle((2.0, 5.0), (1.0, 0.2), 0.5, mass=2.0), gp.Particle((6.0, 5.1), (0.0, 0.0), 0.5)]
    far, ends = gp.Particle((1.0, 1.0), (0.0, 0.0), 0.2, fixed=True), []
    for particles in (both, [*both, far]):
        sim = gp.Simulation(gp.Scene(gp.Container((10.0, 10.0)), particles=particles), gp.EventDriven())
        sim.advance(duration=7.0)
        assert sim.tally.collisions == 1
        ends.append(sim.state.positions[:2])
    assert np.allclose(*ends, rtol=1e-14)


def collided(law, one, other):
    """The state just after two particles, placed by hand, have met."""
    scene = gp.Scene(gp.Container((40.0,) * len(one.position)), particles=[one, other], restitution=law)
    sim = gp.Simulation(scene, gp.EventDriven())
    sim.advance(max_events=1)
    assert sim.tally.collisions == 1
    return sim


@pytest.mark.interpreted
@pytest.mark.parametrize("dimension", [2, 3])
@pytest.mark.parametrize("law", [(1.0, 1.0), (0.8, 0.3), (0.0, 0.0), (0.5, -0.7), (1.0, -1.0)])
def test_a_rough_contact_follows_the_closed_formulae(dimension, law):
    """Spencer 2022, Eqs. 22, 26 and 39, with unlike masses, radii, inertias and spins."""
    rng = np.random.default_rng(5)
    law = gp.Restitution(*law)
    turn = rng.normal(size=2 if dimension == 2 else (2, 3)).tolist()
    one = gp.Particle((20.0,) * dimension, (1.0, 0.3, -0.2)[:dimension], 1.5, 2.0, turn[0], 0.7)
    other = gp.Particle((24.0, 20.5, 21.0)[:dimension], (-1.0, 0.1, -0.6)[:dimension], 0.6, 5.0, turn[1], 1.9)
    sim = collided(law, one, other)
    before, after = sim.initial_state, sim.state

    def three(x):
        return np.pad(x, (0, 3 - len(x)))

    n = three(after.positions[1] - after.positions[0])
    assert np.linalg.norm(n) == pytest.approx(2.1, rel=1e-13)
    n /= np.linalg.norm(n)
    spin = [np.array([0, 0, s]) if dimension == 2 else np.array(s) for s in turn]
    m, radius, inertia = (2.0, 5.0), (1.5, 0.6), (0.7, 1.9)

    def surface(v, w):
        return v[0] - v[1] + np.cross(radius[0] * w[0] + radius[1] * w[1], n)

    v = [three(x) for x in before.velocities]
    g = surface(v, spin)
    gn = (g @ n) * n
    mu = m[0] * m[1] / (m[0] + m[1])
    q = -(1 + law.normal) * mu * gn - (1 + law.tangential) / (
        1 / mu + radius[0] ** 2 / inertia[0] + radius[1] ** 2 / inertia[1]
    ) * (g - gn)
    found = [three(x) for x in after.velocities]
    assert found[0] == pytest.approx(v[0] + q / m[0], abs=1e-13)
    assert found[1] == pytest.approx(v[1] - q / m[1], abs=1e-13)
    turned = [np.array([0, 0, s]) if dimension == 2 else s for s in after.spins]
    for k in (0, 1):
        expected = spin[k] + radius[k] / inertia[k] * np.cross(n, q)
        assert turned[k] == pytest.approx(expected, abs=1e-13)
    h = surface(found, turned)
    assert h @ n == pytest.approx(-law.normal * (g @ n), abs=1e-13)
    assert h - (h @ n) * n == pytest.approx(-law.tangential * (g - gn), abs=1e-13)
    assert after.momentum == pytest.approx(before.momentum, abs=1e-13)
    assert after.angular_momentum == pytest.approx(before.angular_momentum, abs=1e-11)
    assert after.energy + sim.tally.dissipated_energy == pytest.approx(before.energy, rel=1e-14)


@pytest.mark.interpreted
@pytest.mark.parametrize("law", [(1.0, 1.0), (0.6, 0.2), (0.0, -1.0)])
def test_a_wall_hit_follows_its_formula(law):
    """Spencer 2022, Eq. 40, at the upper y wall."""
    law, m, radius, inertia, spin = gp.Restitution(*law), 3.0, 0.5, 0.2, 1.7
    particle = gp.Particle((5.0, 5.0), (1.0, 2.0), radius, m, spin, inertia)
    scene = gp.Scene(gp.Container((10.0, 10.0)), particles=[particle], restitution=law)
    sim = gp.Simulation(scene, gp.EventDriven())
    sim.advance(max_events=1)
    slide = 1.0 - radius * spin  # v + R w x n, n = y
    along = -(1 + law.tangential) / (1 / m + radius**2 / inertia) * slide
    assert sim.state.velocities[0] == pytest.approx([1.0 + along / m, -2.0 * law.normal], abs=1e-14)
    assert sim.state.spins[0] == pytest.approx(spin - radius / inertia * along, abs=1e-13)
    assert sim.tally.wall_impulse[3] == pytest.approx((1 + law.normal) * m * 2.0)
    kept = sim.state.energy + sim.tally.dissipated_energy
    assert kept == pytest.approx(sim.initial_state.energy, rel=1e-14)
    sim.advance(duration=1.0)
    sim.check_invariants()


@pytest.mark.interpreted
def test_a_fixed_particle_is_a_wall():
    for dimension in (2, 3):
        middle, still = (5.0,) * dimension, (0.0,) * dimension
        post = gp.Particle(middle, still, 1.0, fixed=True)
        ball = gp.Particle((2.0, *middle[1:]), (1.0, *still[1:]), 0.5, mass=7.0)
        scene = gp.Scene(gp.Container((10.0,) * dimension), particles=[post, ball])
        sim = gp.Simulation(scene, gp.EventDriven())
        sim.advance(duration=2.5)
        assert sim.tally.collisions == 1
        assert sim.state.positions[1, 0] == pytest.approx(2.5, rel=1e-15)
        assert sim.state.velocities[1, 0] == -1.0
        assert sim.state.positions[0].tolist() == [5.0] * dimension
        assert sim.state.kinetic_energy == 3.5


@pytest.mark.interpreted
def test_a_ball_falls_on_a_fixed_one_and_bounces_back():
    """Dropped just off the top: |r(t)| = sigma decides when, and the rebound is about that normal."""
    post = gp.Particle((5.0, 2.0), (0.0, 0.0), 1.0, fixed=True)
    ball = gp.Particle((5.3, 8.0), (0.0, 0.0), 0.5)
    scene = gp.Scene(gp.Container((10.0, 10.0)), particles=[post, ball], gravity=(0.0, -2.0))
    for search in ("boxes", "direct", "pairs"):
        sim = gp.Simulation(scene, gp.EventDriven(search))
        sim.record_events = True
        sim.advance(max_events=1)
        height = math.sqrt(1.5**2 - 0.3**2)
        assert sim.events["time"] == pytest.approx([math.sqrt(8.0 - 2.0 - height)], rel=1e-14)
        speed = 2.0 * sim.time
        n = np.array([0.3, height]) / 1.5
        expected = np.array([0, -speed]) + 2 * speed * n[1] * n
        assert sim.state.velocities[1] == pytest.approx(expected, rel=1e-13)


@pytest.mark.interpreted
@pytest.mark.parametrize("normal", [0.0, 0.5, 0.9])
def test_a_ball_on_a_floor_comes_to_rest(normal):
    """Bounce times are a geometric series, with an end: t = sqrt(2h/g) (1 + e)/(1 - e). Then it lies."""
    particle = gp.Particle((5.0, 2.5), (0.25, 0.0), 0.5)
    law = gp.Restitution(normal, contact_duration=0.0)
    scene = gp.Scene(gp.Container((400.0, 10.0)), particles=[particle], gravity=(0.0, -1.0), restitution=law)
    end = 2.0 * (1 + normal) / (1 - normal)
    sim = gp.Simulation(scene, gp.EventDriven())
    sim.record_events = True
    sim.advance(duration=1000.0)
    assert sim.events["time"][-1] == pytest.approx(end, rel=1e-10)
    assert sim.state.positions[0] == pytest.approx([5.0 + 250.0, 0.5])
    assert sim.state.velocities.tolist() == [[0.25, 0.0]]
    assert sim.tally.dissipated_energy == pytest.approx(2.0, rel=1e-13)
    sim.check_invariants()


def three_on_a_line(normal, middle=0.0):
    """Discs of which the outer ones come to the middle one, which has a velocity."""
    particles = [gp.Particle((x, 1.0), (v, 0.0), 0.5) for x, v in ((2.5, 1.0), (5.0, middle), (7.0, -1.0))]
    law = gp.Restitution(normal)
    return gp.Scene(gp.Container((10.0, 2.0)), particles=particles, restitution=law)


@pytest.mark.interpreted
@pytest.mark.parametrize("middle", [0.0, 0.5])
@pytest.mark.parametrize("normal", [0.0, 0.03, 0.05, 0.06])
def test_collapse_is_reported_with_the_state_kept(middle, normal):
    """At e < 7 - 4 sqrt 3 = 0.0718 three meet infinitely often (McNamara & Young, Phys. Fluids A 4, 496)."""
    for search in ("boxes", "pairs"):
        sim = gp.Simulation(three_on_a_line(normal, middle), gp.EventDriven(search))
        with pytest.raises(gp.SimulationError, match="collapse"):
            sim.advance(duration=10.0)
        assert 1.0 < sim.time < 3.0
        assert np.isfinite(sim.state.positions).all()
        sim.check_invariants()
    sim = gp.Simulation(three_on_a_line(0.1, middle), gp.EventDriven())
    sim.advance(duration=10.0)  # above the threshold


@pytest.mark.interpreted
def test_a_collapse_comes_at_the_same_event_however_often_the_run_is_resumed():
    """The watch's counts are in the checkpoint; without them a run resumed in time would never collapse."""
    whole, resumed = (gp.Simulation(three_on_a_line(0.05), gp.EventDriven()) for _ in range(2))
    with pytest.raises(gp.SimulationError, match="collapse"):
        whole.advance(duration=10.0)
    with pytest.raises(gp.SimulationError, match="collapse"):
        while resumed.tally.collisions <= whole.tally.collisions:
            resumed.advance(max_events=1)
            resumed = restored(resumed)
    assert (resumed.time, resumed.tally.collisions) == (whole.time, whole.tally.collisions)


@pytest.mark.interpreted
@pytest.mark.parametrize("dimension", [2, 3])
def test_events_tell_spins(dimension):
    scene = replace(gas(dimension, 20, 0.1, "wall"), restitution=gp.Restitution(0.9, 0.5))
    sim = events_of(scene, "boxes", 100)
    spins, particles = sim.events["spins"], sim.events["particles"]
    assert spins.shape == (100, 2) + (3,) * (dimension == 3)
    assert np.array_equal(np.isnan(spins[:, 1]).reshape(100, -1).any(axis=1), particles[:, 1] < 0)
    last = dict(zip(particles.ravel(), spins.reshape(200, *spins.shape[2:]), strict=True))
    for particle in range(20):
        assert np.array_equal(sim.state.spins[particle], last.get(particle, 0 * sim.state.spins[particle]))
    smooth = events_of(replace(scene, restitution=gp.Restitution(0.9)), "boxes", 10)
    assert "spins" not in smooth.events


@pytest.mark.thorough
def test_a_stack_at_rest_is_reported_not_looped_over():
    particles = [gp.Particle((5.0, 0.5), (0.0, 0.0), 0.5), gp.Particle((5.0, 1.5), (0.0, 0.0), 0.5)]
    scene = gp.Scene(gp.Container((10.0, 10.0)), particles=particles, gravity=(0.0, -1.0))
    sim = gp.Simulation(scene, gp.EventDriven())
    with pytest.raises(gp.SimulationError, match=": a stack at rest; the state"):
        sim.advance(duration=1.0)


@pytest.mark.interpreted
def test_particles_that_stick_fly_on_together():
    """e = 0, head on: they stay together and never meet again for rounding's sake."""
    one, other = gp.Particle((5.0, 5.3), (1.0, 0.1), 0.5), gp.Particle((9.0, 5.3), (0.3, 0.1), 0.5)
    sim = collided(gp.Restitution(0.0), one, other)
    assert sim.state.velocities == pytest.approx(np.array([[0.65, 0.1], [0.65, 0.1]]), rel=1e-13)
    sim.advance(duration=20.0)
    assert sim.tally.collisions == 1


@pytest.mark.thorough
def test_haffs_law():
    """While the gas is uniform, T(s) = T0 exp(-(1 - e^2) s / d) by collisions per particle, and by the time
    T(t) = T0 / (1 + t/tau)^2 with tau = 2 d / ((1 - e^2) times the collision rate at the start); Haff, J.
    Fluid Mech. 134, 401 (1983)."""
    count, e, eta = 1000, 0.9, 0.05
    scene = replace(gas(2, count, eta), restitution=gp.Restitution(e))
    sim = gp.Simulation(scene, gp.EventDriven(), seed=3)
    tau = 2 * 2 / ((1 - e**2) * float(theory.collision_rate(eta, 2)))
    for _ in range(4):
        sim.advance(max_events=count * 10 // 4)
        per_particle = 2 * sim.tally.collisions / count
        ratio = sim.state.kinetic_energy / sim.initial_state.kinetic_energy
        rate = -math.log(ratio) / (per_particle * (1 - e**2) / 2)
        assert rate == pytest.approx(1.0, abs=0.03)
        assert (ratio**-0.5 - 1.0) * tau / sim.time == pytest.approx(1.0, abs=0.05)


@pytest.mark.interpreted
@pytest.mark.parametrize(
    ("change", "key"),
    [
        ({"restitution": {"rough": 1}}, "restitution.rough"),
        ({"restitution": {"tangential": 0.0}, "centres_to_walls": True}, "centres_to_walls"),
        (
            {"species": [{"count": 1, "radius": 0.5, "moment_of_inertia": 0.0}]},
            "species[0].moment_of_inertia",
        ),
        ({"species": [{"count": 1, "radius": 0.5, "fixed": True, "speed": 1.0}]}, "species[0].speed"),
        ({"species": [{"count": 1, "radius": 0.5, "fixed": 1}]}, "species[0].fixed"),
        (
            {"particles": [{"position": [5, 5], "velocity": [1, 0], "radius": 1, "spin": [1, 0, 0]}]},
            "particles[0].spin",
        ),
    ],
)
def test_what_is_refused(change, key):
    with pytest.raises(gp.SceneError) as caught:
        gp.Scene.from_dict({"container": {"lengths": [10.0, 10.0]}} | change)
    assert caught.value.key == key


@pytest.mark.thorough
@pytest.mark.parametrize("radius", [1e-3, 1e-6, 1e-8])
def test_elastic_particles_do_not_collapse(radius):
    """A small disc flies exactly between two fixed discs that touch. The circles on which its centre may be
    meet at an angle 2 a, sin(a) = sqrt((R + r)^2 - R^2)/(R + r): unfolded, its path crosses pi/(2 a) walls at
    one time, and it returns as it came."""
    particles = [gp.Particle((6.0, y), (0.0, 0.0), 1.0, fixed=True) for y in (5.0, 7.0)]
    particles.append(gp.Particle((2.0, 6.0), (1.0, 0.0), radius))
    sim = gp.Simulation(gp.Scene(gp.Container((12.0, 12.0)), particles=particles), gp.EventDriven())
    sim.advance(until=4.5)
    angle = math.asin(math.sqrt(radius * (2.0 + radius)) / (1.0 + radius))
    assert sim.tally.collisions == math.floor(0.5 * math.pi / angle + 0.5)
    sim.check_invariants()
    assert np.hypot(*sim.state.velocities[2]) == pytest.approx(1.0, rel=1e-11)
