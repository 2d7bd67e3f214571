"""A checkpoint belongs to a scene, a seed and an engine, whatever the search and the threads that made it."""

from dataclasses import replace

import numpy as np
import pytest

import gaspart as gp
from gaspart.engines.engine import ENGINES, engine_from_dict, required_settings
from gaspart.state.tally import ImpulseTally, PairImpulseTally, StressTally

DISCS = gp.Scene(gp.Container((12.0, 12.0), "periodic"), [gp.Species(20, 0.5, temperature=1.0)])
MIXED = gp.Scene(
    gp.Container((8.0, 9.0, 7.0), ("wall", "periodic", "wall")),
    [gp.Species(40, 0.5, temperature=1.0), gp.Species(10, 0.3, mass=3.0, temperature=1.0)],
)
PERIODIC = replace(MIXED, container=gp.Container((8.0, 9.0, 7.0), "periodic"))
COUNTS = ("collisions", "wall_hits", "wall_impulse", "wall_energy", "virial_sum", "dissipated_energy", "time")


def bits(sim):
    state, tally = sim.state, sim.tally
    arrays = [state.positions, state.velocities, state.images, state.spins]
    arrays += [np.asarray(getattr(tally, name)) for name in COUNTS]
    return [array.tobytes() for array in arrays]


@pytest.mark.thorough
@pytest.mark.parametrize(
    ("change", "rule"),
    [
        (
            {"scene": replace(DISCS, species=[gp.Species(20, 0.5, temperature=1.1)])},
            "is of another scene than this",
        ),
        ({"scene": MIXED}, "is of another scene than this"),
        ({"seed": 2}, "checkpoint = '1': is of another seed than this simulation, which has 2"),
        ({"seed": (1, 0)}, r"another seed than this simulation, which has \[1, 0\]"),
        ({"engine": gp.TimeStepped(0.01)}, 'another engine than this simulation, which has {"name": "step"'),
    ],
)
def test_another_simulation_is_refused_in_one_line(change, rule):
    begun = gp.Simulation(DISCS, gp.EventDriven(), 1)
    begun.advance(until=1.0)
    sim = gp.Simulation(**{"scene": DISCS, "engine": gp.EventDriven(search="lists"), "seed": 1, **change})
    before = bits(sim)
    with pytest.raises(gp.SceneError, match=rule) as caught:
        sim.restore(begun.checkpoint())
    assert "\n" not in str(caught.value) and bits(sim) == before


@pytest.mark.interpreted
@pytest.mark.parametrize(
    "other", [{"time_step": 0.02}, {"precision": "float32"}, {"rewind": False}, {"passes": 1}]
)
def test_settings_that_change_results_are_refused(other):
    begun = gp.Simulation(MIXED, gp.TimeStepped(0.01), 1)
    begun.advance(until=0.1)
    with pytest.raises(gp.SceneError, match="is of another engine than this simulation"):
        gp.Simulation(MIXED, gp.TimeStepped(**{"time_step": 0.01, **other}), 1).restore(begun.checkpoint())


OPTIONAL = {
    "stress": StressTally(),
    "impulses": ImpulseTally("x", 8),
    "pair_impulses": PairImpulseTally.from_text("2:20:0.5"),
}


def one_of_each():
    """One of every engine that is known, with what it needs, and others that keep more in a checkpoint."""
    for name, kind in ENGINES.items():
        yield engine_from_dict({"name": name, **dict.fromkeys(required_settings(kind), 0.01)})
    yield from (gp.EventDriven(search="lists"), gp.TimeStepped(0.01, skin=0.3), gp.DSMC(model="enskog"))


SEARCH = {"search", "boxes_per_side", "origin", "skin", "per_side", "threads"}
"""What a checkpoint of another search does not have, or of another value."""


@pytest.mark.thorough
@pytest.mark.filterwarnings("ignore:gaspart")
@pytest.mark.parametrize(
    ("engine", "tally"),
    [
        (engine, tally)
        for engine in one_of_each()
        for tally in (None, *sorted(engine.tallies & OPTIONAL.keys()))
    ],
)
def test_a_checkpoint_that_lacks_anything_is_refused(engine, tally):
    """Whatever the engine, with each optional tally that it makes, and with nothing changed."""
    scene, asked = (MIXED, []) if tally is None else (PERIODIC, [OPTIONAL[tally]])
    begun, sim = (gp.Simulation(scene, engine, 1, tallies=asked) for _ in range(2))
    begun.advance(until=1.0)
    before, whole = bits(sim), begun.checkpoint()
    for key in {*whole} - SEARCH:
        with pytest.raises(gp.SceneError, match="checkpoint"):
            sim.restore({name: value for name, value in whole.items() if name != key})
    for wrong in (None, {}, {**whole, "images": whole["images"][1:]}, {**whole, "lost": np.array("x")}):
        with pytest.raises(gp.SceneError, match="checkpoint"):
            sim.restore(wrong)
    assert bits(sim) == before
