"""Short runs of the kinds of scenes, one for each engine that takes a kind, shared by all observables."""

import math
import warnings
from functools import cache, lru_cache
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
from exact.kinds import FREE, kinds

import gaspart as gp
from gaspart.errors import SceneError
from gaspart.state.tally import ImpulseTally, StressTally
from gaspart.trajectory.correlator import Correlations
from gaspart.trajectory.reading import open_trajectory

SEED = 7
LAGS = 8
STEP = 0.02
"""Distance of a step in diameters: one contact in 4000 is missed."""
GAP = 0.25
"""Distance of a step in mean gaps between bodies: about one contact in two steps."""
MOST_STEPS = 1e6
"""Steps of a run, at most."""
IMPULSE_BINS = 40


@cache
def engines(name):
    """Return the engines that model all features of a kind, by name; the others are in `refusals`."""
    return {engine: one for engine, one in _offered(kinds()[name]).items() if engine not in refusals(name)}


@cache
def refusals(name):
    """Return why engines do not model a kind, by the name of the engine."""
    scene, found = gp.Scene.from_dict(kinds()[name].scene), {}
    for engine, settings in _offered(kinds()[name]).items():
        if isinstance(settings, str):
            found[engine] = settings
            continue
        try:
            settings.check_features(scene)
        except SceneError as error:
            found[engine] = f"{error.key}: {error.rule}"
    return found


def _offered(kind):
    """Return engines by name, or why one is not tried.

    The stepped engine has a step of a small error, the kinetic ones their own settings.
    """
    step = kind.run["interval"] / math.ceil(kind.run["interval"] / time_step(kind))
    stepped, kinetic = gp.TimeStepped(step), (gp.DSMC(), gp.DSMC(model="enskog"))
    if kind.run["duration"] > MOST_STEPS * step:
        stepped = "(not tried) too many steps"
    if "short" in kind.run:
        kinetic = 2 * ("(not tried) the first lags are short beside a step",)
    return {"event": gp.EventDriven(), "step": stepped, "dsmc": kinetic[0], "enskog": kinetic[1]}


@cache
def refusal(*run):
    """Return why an engine refuses to start a run, None if it has made it."""
    try:
        recorded(*run)
    except SceneError as error:
        if run[1] == "event":
            raise
        return f"{error.key}: {error.rule}"
    return None


def time_step(kind):
    """Return a step in which the fastest pair moves by the part `STEP` of its diameter, or `GAP` of a gap."""
    sizes = [group for group in kind.case.groups if group.radius > FREE]
    if not sizes:
        return kind.run["interval"] / 8.0
    part = min(STEP, GAP * (kind.packed ** (-1.0 / kind.dimension) - 1.0))
    solid = kind.temperature ** -0.5 * min(
        (one.radius + other.radius) / math.sqrt(1.0 / one.mass + 1.0 / other.mass)
        for one in sizes for other in sizes
    )  # fmt: skip
    return min(part * solid, kind.run["interval"] / 8.0)


def options(kind, scene, engine, interval):
    """Return what the run keeps: paths, collisions of pairs, correlations, impulses, where it can."""
    found = {}
    if not kind.opened:
        found["displacements"] = True
        if engine.records_events and not kind.singles:
            found["pairs"] = True
    if kind.stress and not kind.opened and (not kind.wide or "transport" in kind.run):
        try:
            engine.check_tally(StressTally(), scene)
            # transport needs lags as long as those of the usual interval
            finer = round(kind.run["interval"] / interval) if "transport" in kind.run else 1
            found["correlations"] = Correlations(interval / 2.0, finer * LAGS, stress=True)
        except SceneError:
            pass
    if "impulses" in kind.run and ImpulseTally.name in engine.tallies:
        found["tallies"] = [ImpulseTally(kind.run["impulses"], IMPULSE_BINS)]
    return found


@lru_cache(maxsize=32)  # all of the table take several GB
def recorded(name, engine_name="event", seed=SEED, longer=1.0, finer=1):
    """Return the trajectory of a run, in memory.

    longer: times the duration of the kind; finer: part of its interval between frames
    """
    kind = kinds()[name]
    scene, engine = gp.Scene.from_dict(kind.scene), engines(name)[engine_name]
    initial = None
    if "drift" in kind.run:
        drawn = gp.Simulation(scene, engine, seed).initial_state
        from dataclasses import replace

        initial = replace(drawn, velocities=drawn.velocities + np.array(kind.run["drift"]))
    interval = kind.run["interval"] / finer
    with TemporaryDirectory() as folder, warnings.catch_warnings():
        warnings.simplefilter("ignore")
        path = Path(folder) / "run.nc"
        duration = longer * kind.run["duration"]
        kept = options(kind, scene, engine, interval) | {"initial": initial}
        gp.run(scene, engine, seed, duration, interval, path, **kept)
        with open_trajectory(path) as data:
            return data.load()
