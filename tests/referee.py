"""How one search, or a run that is interrupted, is compared with the run that judges it: bit for bit."""

from dataclasses import fields
from operator import attrgetter

import numpy as np

import gaspart as gp
from gaspart.state.tally import Tally

WHOLE_TALLY = tuple(f"tally.{field.name}" for field in fields(Tally))
"""All counters and sums, as attributes of a simulation."""


def events_of(scene, search, most, seed=1, may_collapse=False, **settings):
    """A simulation that has recorded its first `most` events, or those up to a collapse if that may come."""
    sim = gp.Simulation(scene, gp.EventDriven(search, **settings), seed=seed)
    sim.record_events = True
    try:
        sim.advance(max_events=most, duration=1e3)
    except gp.SimulationError as error:
        if not may_collapse or "collapse" not in str(error):
            raise
    return sim


def same_bits(one, other):
    """Whether two simulations have recorded the same events, to the last bit."""
    return all(np.array_equal(one.events[key], other.events[key], equal_nan=True) for key in one.events)


def check_same(one, other, *names):
    """Two simulations have the same values of attributes such as state.positions or tally.wall_energy."""
    for name in names:
        assert np.array_equal(attrgetter(name)(one), attrgetter(name)(other)), name


def check_boxes(scene, events):
    """Any number of boxes gives the same bits."""
    first = events_of(scene, "boxes", events)
    for boxes_per_side in (1, 2, 3, tuple(range(4, 4 + scene.dimension))):
        assert same_bits(first, events_of(scene, "boxes", events, boxes_per_side=boxes_per_side))


def check_searches(scene, most, seed, *names, may_collapse=False):
    """The boxes and the direct search give the events of the referee, which tests all pairs, and the same
    values of the attributes `names`. Returns the referee's simulation."""
    referee = events_of(scene, "pairs", most, seed, may_collapse)
    for search in ("boxes", "direct"):
        other = events_of(scene, search, most, seed, may_collapse)
        assert same_bits(referee, other)
        check_same(referee, other, *names)
    return referee


def restored(sim):
    """A simulation that continues from a checkpoint of another one."""
    again = gp.Simulation(sim.scene, sim.engine, sim.seed)
    again.restore({key: value.copy() for key, value in sim.checkpoint().items()})
    return again


def check_restored(scene, ends, *names, engine=None, seed=3):
    """A run that is restored from a checkpoint at each of the times `ends` has the same values of the
    attributes `names` as one that is not. Returns the simulation of the latter."""
    undisturbed, parts = (gp.Simulation(scene, engine or gp.EventDriven(), seed) for _ in range(2))
    for end in ends:
        parts.advance(until=end)
        parts = restored(parts)
    undisturbed.advance(until=ends[-1])
    check_same(undisturbed, parts, *names)
    return undisturbed
