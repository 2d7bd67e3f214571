"""How one search is held against another: the events of a run, compared bit for bit."""

from contextlib import nullcontext, suppress

import numpy as np

import gaspart as gp


def events_of(scene, search, most, seed=1, may_collapse=False, **settings):
    """A simulation that has recorded its first `most` events, or those up to a collapse if that may come."""
    sim = gp.Simulation(scene, gp.EventDriven(search, **settings), seed=seed)
    sim.record_events = True
    with suppress(gp.SimulationError) if may_collapse else nullcontext():
        sim.advance(max_events=most, duration=1e3)
    return sim


def same_bits(one, other):
    """Whether two simulations have recorded the same events, to the last bit."""
    return all(np.array_equal(one.events[key], other.events[key], equal_nan=True) for key in one.events)
