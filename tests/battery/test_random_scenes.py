"""Random small scenes of all kinds: any search gives the same events, and what is exchanged is tallied."""

from dataclasses import dataclass

import numpy as np
import pytest
import scenes
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from hypothesis.strategies import SearchStrategy
from referee import WORK, check_same, events_of, same_bits

import gaspart as gp
from gaspart.engines.event.search import obstacle_to_lists

ALL = settings.default.max_examples


@dataclass(frozen=True)
class Kind:
    """Random scenes of so many particles at most. searches: which have the first events of a referee, planar:
    further ones, of discs only, so that fewer kernels are compiled; kept: events after which the books of a
    larger scene are looked at. rounding: of places, and of energies where it is less than usual."""

    scenes: SearchStrategy
    searches: tuple[str, ...] = ("boxes", "direct")
    referee: str = "pairs"
    planar: tuple[str, ...] = ()
    events: int = 150
    may_collapse: bool = False
    larger: SearchStrategy | None = None
    kept: int = 2000
    rounding: float = 1e-9
    examples: int = ALL


KINDS = {
    "mixtures": Kind(scenes.mixtures(), larger=scenes.mixtures(40), kept=3000, rounding=1e-12),
    "dense": Kind(scenes.dense(), examples=ALL // 5),
    "listed": Kind(scenes.mixtures(40), ("lists",)),
    "uneven": Kind(scenes.uneven(), ("boxes",), may_collapse=True),
    "falling": Kind(scenes.falling(), larger=scenes.falling(40), kept=3000, rounding=1e-11),
    "granular": Kind(scenes.granular(), may_collapse=True, larger=scenes.granular(30), rounding=1e-11),
    "piled": Kind(scenes.piled(), events=400),
    "lossy": Kind(scenes.lossy(), ("direct",), "boxes", events=300),
    "kicked": Kind(scenes.kicked(), events=100),
    "walled": Kind(scenes.walled(), events=120, may_collapse=True, larger=scenes.walled(20)),
    "partitioned": Kind(scenes.partitioned(), events=100, may_collapse=True, larger=scenes.partitioned()),
    "surfaced": Kind(scenes.surfaced(), may_collapse=True, larger=scenes.surfaced(20), kept=3000),
    "cornered": Kind(scenes.cornered(), events=400),
    "metals": Kind(scenes.metals(), may_collapse=True),
    "parted": Kind(scenes.parted(), events=200),
    "pressed": Kind(scenes.pressed(), ("direct",), "boxes", ("pairs",), events=300),
    "pushed": Kind(scenes.pushed()),
    "shaken": Kind(scenes.shaken(), ("direct",), "boxes", ("pairs",), events=200),
}
INTERPRETED = "mixtures", "granular", "walled", "pushed"
"""Kinds of which `make test` has a few scenes, with kernels as plain Python."""


def tier(name):
    """The marker of a kind."""
    return pytest.mark.interpreted if name in INTERPRETED else pytest.mark.thorough


def each_random(name, check, strategy, examples):
    """Check random scenes, each with a seed."""
    settings(max_examples=examples)(given(strategy, st.integers(0, 2**32))(check))()


@pytest.mark.parametrize("name", [pytest.param(name, marks=tier(name)) for name in KINDS])
def test_all_searches_give_the_same_events(name):
    kind = KINDS[name]

    def check(scene, seed):
        assume(not {"lists"}.intersection(kind.searches) or obstacle_to_lists(scene) is None)
        # More boxes than the large particles among small ones fit in.
        many = {"boxes_per_side": 8 + seed % 9} if name == "uneven" else {}
        try:
            referee = events_of(scene, kind.referee, kind.events, seed, kind.may_collapse)
        except gp.SceneError as error:  # a wall, or a small container, may leave no room
            assume("does not fit by random insertion" not in error.rule and "jam already" not in error.rule)
            raise
        for search in kind.searches + (kind.planar if scene.dimension == 2 else ()):
            other = events_of(scene, search, kind.events, seed, kind.may_collapse, **many)
            assert same_bits(referee, other)
            check_same(referee, other, WORK)
        check_books(referee, kind.rounding)
        if name == "cornered":  # each contact gives the faces a part of the energy, so that they end
            assert np.unique(referee.events["time"], return_counts=True)[1].max(initial=0) < kind.events

    each_random(name, check, kind.scenes, kind.examples)


@pytest.mark.thorough
@pytest.mark.parametrize("name", [name for name, kind in KINDS.items() if kind.larger is not None])
def test_books_are_kept(name):
    kind = KINDS[name]

    def check(scene, seed):
        check_books(events_of(scene, "automatic", kind.kept, seed, kind.may_collapse), kind.rounding)

    each_random(name, check, kind.larger, ALL)


def check_books(sim, rounding):
    """Energy and momentum are exchanged with what is tallied only; no particle is where it cannot be."""
    sim.check_invariants()
    scene, before, state, tally = sim.scene, sim.initial_state, sim.state, sim.tally
    given_away = tally.wall_energy.sum() + tally.dissipated_energy - tally.thermostat_energy
    exchanged = np.abs(tally.wall_energy).sum() + tally.dissipated_energy + tally.thermostat_energy
    fall = (
        0.0
        if state.gravity is None
        else state.masses[np.isfinite(state.masses)].sum() * (abs(state.gravity) @ state.lengths)
    )
    scale = max(before.kinetic_energy, state.kinetic_energy) + exchanged + fall
    assert before.energy - state.energy == pytest.approx(given_away, abs=min(rounding, 1e-11) * scale)
    loaded = [(number // 2, number % 2, face) for number, face in scene.pistons if face.mass]
    for axis, high, piston in loaded:
        enthalpy = [one.energy + energy_of(scene, piston, axis, high, *one.piston) for one in (before, state)]
        assert enthalpy[1] == pytest.approx(enthalpy[0], rel=1e-11)
    moving = np.isfinite(state.masses)
    assert np.array_equal(state.positions[~moving], before.positions[~moving])
    assert tally.worst_contact < (1e-9 if rounding < 1e-9 else 1e-8)
    law = scene.restitution
    assert tally.dissipated_energy >= 0.0
    if law is None or (law.normal == 1.0 and abs(law.tangential) == 1.0):
        assert tally.dissipated_energy == 0.0
    if all(scene.container.periodic) and moving.all() and not scene.walls and not state.gravity:
        momentum = (state.masses[:, None] * (np.abs(before.velocities) + np.abs(state.velocities))).sum()
        assert np.allclose(
            state.momentum, before.momentum, rtol=0.0, atol=min(0.1 * rounding, 1e-12) * momentum
        )
    scenes.check_inside(scene, state, rounding)
    if scene.walls and state.piston is None:
        scenes.check_outside_walls(scene, state, 1e-8)
    elif scene.walls:
        check_moving_wall(sim)


def energy_of(scene, piston, axis, high, place, velocity):
    """The energy of a piston with a load."""
    length = scene.container.lengths[axis]
    room = scene.container.volume / length * (place if high else length - place)
    return 0.5 * piston.mass * velocity**2 + piston.pressure * room


def check_moving_wall(sim):
    """The wall has the energy that the gases have lost, and each particle is still on its side."""
    (wall,), state, start, tally = sim.scene.walls, sim.state, sim.initial_state, sim.tally
    axis = int(wall.start[0] != wall.end[0])
    place, velocity = state.piston
    moving = 0.5 * wall.mass * velocity**2
    assert state.energy + moving == pytest.approx(start.energy, rel=1e-12)
    assert tally.wall_energy[2 * state.dimension] == pytest.approx(moving, abs=1e-12 * start.energy)
    from_ends = tally.wall_impulse[2 * axis] - tally.wall_impulse[2 * axis + 1]
    gained = state.momentum[axis] + wall.mass * velocity - start.momentum[axis]
    largest = max(1.0, abs(from_ends), tally.wall_impulse.max())
    assert gained == pytest.approx(from_ends, abs=1e-10 * largest)
    below = start.positions[:, axis] < start.piston[0]
    x = state.positions[:, axis]
    assert (x[below] + state.radii[below] <= place + 1e-9).all()
    assert (x[~below] - state.radii[~below] >= place - 1e-9).all()
