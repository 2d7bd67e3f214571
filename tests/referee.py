"""How one search, or a run that is interrupted, is compared with the run that judges it: bit for bit."""

from dataclasses import fields

import numpy as np

import gaspart as gp

WORK = {"pair_tests", "box_visits", "crossings", "rebuilds"}
"""Counters of how particles were found."""


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


def contents(*parts):
    """Name -> value of all fields of states and tallies."""
    return {
        f"{type(part).__name__}.{field.name}": getattr(part, field.name)
        for part in parts
        for field in fields(part)
    }


def check_alike(expected, found):
    """Two mappings of names to values have the same bits."""
    assert expected.keys() == found.keys()
    for name, value in expected.items():
        floats = np.asarray(value).dtype.kind == "f"
        assert np.array_equal(value, found[name], equal_nan=floats), name


def check_same(one, other, without=()):
    """Two simulations have the same state and tally, but for some fields."""
    mine, its = (contents(sim.state, sim.tally) for sim in (one, other))
    for field in without:
        del mine[f"Tally.{field}"], its[f"Tally.{field}"]
    check_alike(mine, its)


def restored(sim):
    """A simulation that continues from a checkpoint of another one."""
    again = sim.again()
    again.restore({key: value.copy() for key, value in sim.checkpoint().items()})
    return again
