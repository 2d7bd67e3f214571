"""Viscoelastic particles: single contacts, their scaling, and the energy of many."""

from dataclasses import replace

import pytest

import gaspart as gp
from gaspart.kernels.physics.contact import fifth_root, restitution_of

LAW = gp.Restitution(0.8, -0.5, reference_speed=2.0)
ROOM = gp.Container((40.0, 40.0))


def damping_of(restitution):
    """The damping that has this restitution, by bisection."""
    low, high = 0.0, 100.0
    for _ in range(200):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if restitution_of(middle) > restitution else (low, middle)
    return low


def pair(speed, radii=(0.5, 0.5), masses=(1.0, 1.0)):
    """Two discs that approach each other centrally; the first species only sets the scale."""
    particles = [
        gp.Particle((20.0 - 2.0, 20.0), (speed, 0.0), radii[0], masses[0]),
        gp.Particle((20.0 + 2.0, 20.0), (0.0, 0.0), radii[1], masses[1]),
    ]
    return gp.Scene(ROOM, [gp.Species(0, 0.5)], particles=particles, restitution=LAW)


def parted(scene):
    """Relative speed after the first contact over that before."""
    sim = gp.Simulation(scene, gp.EventDriven())
    before = sim.state.velocities[1, 0] - sim.state.velocities[0, 0]
    sim.advance(max_events=1)
    return -(sim.state.velocities[1, 0] - sim.state.velocities[0, 0]) / before


@pytest.mark.interpreted
@pytest.mark.parametrize(("factor", "damped"), [(1.0, 1.0), (32.0, 2.0), (1 / 32.0, 0.5), (1e-10, 0.01)])
def test_the_damping_grows_as_the_fifth_root_of_the_speed(factor, damped):
    expected = restitution_of(damped * damping_of(0.8))
    assert parted(pair(2.0 * factor)) == pytest.approx(expected, rel=1e-13)


@pytest.mark.interpreted
def test_the_damping_depends_on_radii_and_masses():
    """As (R_eff / m_eff^2)^(1/5); a particle at a wall has its own radius and mass."""
    radius, mass = 0.3 * 1.2 / 1.5, 2.0 * 5.0 / 7.0
    factor = fifth_root(radius / mass**2 / (0.25 / 0.5**2))
    found = parted(pair(2.0, (0.3, 1.2), (2.0, 5.0)))
    assert found == pytest.approx(restitution_of(factor * damping_of(0.8)), rel=1e-13)
    particle = gp.Particle((20.0, 2.0), (0.0, -2.0), 0.3, mass=2.0)
    sim = gp.Simulation(
        gp.Scene(ROOM, [gp.Species(0, 0.5)], particles=[particle], restitution=LAW), gp.EventDriven()
    )
    sim.advance(max_events=1)
    factor = fifth_root(0.3 / 2.0**2 / (0.25 / 0.5**2))
    expected = 2.0 * restitution_of(factor * damping_of(0.8))
    assert sim.state.velocities[0, 1] == pytest.approx(expected, rel=1e-13)


@pytest.mark.interpreted
def test_what_has_no_meaning_is_refused():
    for normal in (0.0, 1.0):
        with pytest.raises(gp.SceneError, match="normal.*between 0 and 1, both excluded"):
            gp.Restitution(normal, reference_speed=1.0)


@pytest.mark.thorough
def test_a_dense_gas_does_not_collapse():
    """Between slow contacts, which are nearly elastic, intervals do not shrink geometrically: what is a
    collapse at a constant restitution of 0.1 ends here after some tens of contacts."""
    law = gp.Restitution(0.1, reference_speed=1.0)
    kind = gp.Species(300, 0.5, temperature=1.0, arrangement="compressed")
    scene = gp.Scene(gp.Container((20.0, 20.0), "periodic"), [kind], restitution=law)
    sim = gp.Simulation(scene, gp.EventDriven(), seed=1)
    sim.advance(until=5.0)
    sim.check_invariants()
    assert sim.tally.dissipated_energy == pytest.approx(sim.initial_state.energy - sim.state.energy, rel=1e-9)
    constant = gp.Simulation(replace(scene, restitution=gp.Restitution(0.1)), gp.EventDriven(), seed=1)
    with pytest.raises(gp.SimulationError, match="inelastic collapse"):
        constant.advance(until=5.0)
