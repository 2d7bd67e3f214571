"""Short runs of the kinds of scenes, one for each engine that serves a kind, shared by all observables."""

import warnings
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
from exact.kinds import kinds

import gaspart as gp
from gaspart.errors import SceneError
from gaspart.state.tally import ImpulseTally, StressTally
from gaspart.trajectory.correlator import Correlations
from gaspart.trajectory.reading import open_trajectory

SEED = 7
LAGS = 8
IMPULSE_BINS = 40


def engines(kind):
    """Return the engines that serve a kind, by name: event-driven always, the others as its run states."""
    found = {"event": gp.EventDriven()}
    if "step" in kind.run:
        found["step"] = gp.TimeStepped(kind.run["step"])
    if "dsmc" in kind.run:
        found["dsmc"] = gp.DSMC(kind.run["dsmc"], (2, 2, 2)[: kind.dimension])
    return found


def options(kind, scene, engine):
    """Return what the run keeps: paths, collisions of pairs, correlations, impulses, where it can."""
    found = {}
    if not kind.opened:
        found["displacements"] = True
        if engine.records_events and not kind.singles:
            found["pairs"] = True
    if kind.stress and not kind.opened:
        try:
            engine.check_tally(StressTally(), scene)
            found["correlations"] = Correlations(kind.run["interval"] / 2.0, LAGS, stress=True)
        except SceneError:
            pass
    if "impulses" in kind.run and ImpulseTally.name in engine.tallies:
        found["tallies"] = [ImpulseTally(kind.run["impulses"], IMPULSE_BINS)]
    return found


@cache
def recorded(name, engine_name="event", seed=SEED, longer=1.0):
    """Return the trajectory of a run, in memory."""
    kind = kinds()[name]
    scene, engine = gp.Scene.from_dict(kind.scene), engines(kind)[engine_name]
    initial = None
    if "drift" in kind.run:
        drawn = gp.Simulation(scene, engine, seed).initial_state
        from dataclasses import replace

        initial = replace(drawn, velocities=drawn.velocities + np.array(kind.run["drift"]))
    interval = kind.run["interval"]
    with TemporaryDirectory() as folder, warnings.catch_warnings():
        warnings.simplefilter("ignore")
        path = Path(folder) / "run.nc"
        duration = longer * kind.run["duration"]
        kept = options(kind, scene, engine) | {"initial": initial}
        gp.run(scene, engine, seed, duration, interval, path, **kept)
        with open_trajectory(path) as data:
            return data.load()
