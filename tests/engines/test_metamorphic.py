"""What must not matter, mirrors, names of axes and particles, of a scene with all that a contact may have:
gravity, restitution, spins, unlike masses and moments of inertia, a fixed particle, a wall with its ends."""

import math
from dataclasses import replace

import numpy as np
import pytest
from scenes import gas

import gaspart as gp

LENGTHS = np.array([11.0, 9.0])
GRAVITY = np.array([0.05, -0.2])
ENDS = np.array([[3.0, 2.0], [6.5, 5.0]])


def start():
    """Positions, velocities, spins, masses, radii, moments of inertia and fixity of 24 particles."""
    kinds = [gp.Species(14, 0.4, mass=1.0, temperature=1.0), gp.Species(9, 0.25, mass=3.0, temperature=1.0)]
    kinds += [gp.Species(1, 0.5, fixed=True)]
    scene = gp.Scene(gp.Container(tuple(LENGTHS)), kinds, walls=[gp.Wall(*map(tuple, ENDS))])
    state = gp.Simulation(scene, gp.EventDriven(), seed=12).initial_state
    spins = np.where(np.isinf(state.masses), 0.0, np.linspace(-2.0, 2.0, state.count))
    return state, spins


def everything(state, spins, turn=lambda v: v, place=None, hand=1.0):
    """The scene with its vectors turned by `turn`, its places by `place`; hand: -1 if mirrored."""
    place = place or turn
    particles = []
    for x, v, spin, radius, m in zip(
        state.positions, state.velocities, spins, state.radii, state.masses, strict=True
    ):
        own = {"fixed": True} if np.isinf(m) else {"spin": float(hand * spin), "mass": m}
        inertia = 0.3 * own.get("mass", 1.0) * radius**2
        particles.append(
            gp.Particle(tuple(place(x)), tuple(turn(v)), radius, moment_of_inertia=inertia, **own)
        )
    scene = gp.Scene(
        gp.Container(tuple(np.abs(turn(LENGTHS)))),
        particles=particles,
        gravity=tuple(turn(GRAVITY)),
        restitution=gp.Restitution(0.95, 0.4),
        walls=[gp.Wall(*(tuple(place(end)) for end in ENDS))],
    )
    sim = gp.Simulation(scene, gp.EventDriven())
    sim.record_events = True
    return sim


@pytest.mark.interpreted
@pytest.mark.parametrize(
    ("turn", "place"),
    [
        (lambda v: v * (-1.0, 1.0), lambda r: np.array([LENGTHS[0] - r[0], r[1]])),
        (lambda v: v[::-1], None),
    ],
    ids=["mirrored", "axes exchanged"],
)
def test_a_mirrored_scene_runs_mirrored_until_chaos_takes_over(turn, place):
    one, other = everything(*start()), everything(*start(), turn=turn, place=place, hand=-1.0)
    for sim in (one, other):
        sim.advance(duration=8.0)
    assert one.tally.collisions > 40 and one.tally.wall_hits[4] > 5
    mirror = np.array([(place or turn)(r) for r in one.state.positions])
    assert np.allclose(other.state.positions, mirror, atol=1e-6)
    assert np.allclose(other.state.spins, -one.state.spins, atol=1e-5)
    assert np.array_equal(other.events["particles"][:, 0], one.events["particles"][:, 0])
    assert other.tally.dissipated_energy == pytest.approx(one.tally.dissipated_energy, rel=1e-6)


@pytest.mark.interpreted
def test_other_labels_make_the_same_motion_until_chaos_takes_over():
    state, spins = start()
    order = np.random.default_rng(3).permutation(state.count)
    arrays = ("positions", "velocities", "radii", "masses")
    shuffled = replace(state, **{key: getattr(state, key)[order] for key in arrays})
    one, other = everything(state, spins), everything(shuffled, spins[order])
    for sim in (one, other):
        sim.advance(duration=8.0)
    assert np.allclose(other.state.positions, one.state.positions[order], atol=1e-6)
    assert np.allclose(other.state.spins, one.state.spins[order], atol=1e-5)
    assert other.tally.collisions == one.tally.collisions


def echo(seed, per_particle, count=100):
    """The rms distance from its start of a gas that ran `per_particle` collisions per particle, and back."""
    scene = gas(2, count, 0.1, "wall")
    there = gp.Simulation(scene, gp.EventDriven(), seed=seed)
    while 2 * there.tally.collisions < per_particle * count:
        there.advance(duration=0.1)
    turned = there.state.copy()
    turned.velocities *= -1.0
    back = gp.Simulation(scene, gp.EventDriven(), initial=turned)
    back.advance(duration=there.time)
    return math.sqrt(((back.state.positions - there.initial_state.positions) ** 2).sum(axis=1).mean())


@pytest.mark.thorough
def test_a_loschmidt_echo_fades_at_the_rate_of_chaos():
    """Turned round, a gas comes back, but for rounding that grows as e^(lambda s), s collisions per particle;
    lambda = 2.76 +- 0.01 for discs at a packing fraction of 0.1 between walls (tangent space; cf. van Zon,
    van Beijeren & Dellago, Phys. Rev. Lett. 80, 2035 (1998)). An engine that never forgets is replaying."""
    short, long = (np.log([echo(seed, s) for seed in range(8)]) for s in (3.0, 8.0))
    assert short.max() < math.log(1e-8)
    assert ((long - short) / 5.0).mean() == pytest.approx(2.76, abs=0.4)
    assert echo(1, 20.0) > 0.5
