"""The same changes of a gas in a page and natively: states and counters must have the same bits."""

import hashlib
import json
import random
import shutil
import subprocess
import time
from dataclasses import replace
from pathlib import Path

import numpy as np

import gaspart as gp
from gaspart.rendering import play
from gaspart.rendering.controls import Controls

NODE = shutil.which("node")
SESSION = Path(__file__).with_name("session.mjs")
SEED = 3


def page_data(scene, folder):
    """The file of the data of a page, without starts of other densities so that it is made quickly."""
    every = play._densities
    try:
        play._densities = lambda scene: [scene]
        content = play._content(scene, SEED)
    finally:
        play._densities = every
    path = folder / "data.txt"
    path.write_text(play._packed(content))
    return path


def random_steps(scene, number, seed, duration):
    """Changes of a scene: values of all controls, sometimes a reversal, and a duration."""
    controls, chance = Controls(scene), random.Random(seed)
    kinds, steps = set(controls.kinds()), []
    while len(steps) < number:
        settings = {one.name: chance.choice(one.values) for one in controls.all}
        for one in controls.all:
            off = [value for value, flag in zip(one.values, one.flags, strict=True) if flag in ("", "w")]
            if off and chance.random() < 0.5:
                settings[one.name] = off[0]
        if steps and steps[-1]["settings"].get("piston") is not None and settings.get("piston") is None:
            continue
        if steps and not steps[-1]["settings"].get("walls", True) and settings.get("walls"):
            continue
        flags = controls.flags(settings)
        warm = not {"g", "r"} <= set(flags) or "t" in flags
        if flags.replace("t", "") in kinds and warm and not _changes_type(settings, flags):
            # short where piles or a piston that nothing stops have ever more collisions
            share = 0.02 if {"g", "r"} <= set(flags) or settings.get("piston") == 0.0 else 1.0
            reverse = bool(steps) and chance.random() < 0.2
            steps.append(
                {
                    "settings": settings,
                    "reverse": reverse,
                    "duration": share * duration * chance.choice((0.3, 1.0)),
                }
            )
    return controls, steps


def _changes_type(settings, flags):
    return "g" in flags and (settings.get("restitution"), settings.get("roughness")) == (1.0, 1.0)


def asked(controls, steps, start=0):
    """The steps as the page counts values."""
    return [
        {
            "start": start,
            "values": {one.name: one.values.index(step["settings"][one.name]) for one in controls.all},
            **{key: step[key] for key in ("reverse", "piston", "duration") if key in step},
        }
        for step in steps
    ]


def in_node(controls, steps, data, folder):
    """Results of the steps in node."""
    path = folder / "steps.json"
    path.write_text(json.dumps(asked(controls, steps)))
    command = [NODE, SESSION, Path(play.__file__).with_name("gas.js"), data, path]
    done = subprocess.run(command, capture_output=True, text=True, timeout=600)
    assert not done.returncode, done.stderr
    return json.loads(done.stdout)


def natively(controls, steps):
    """Results of the steps by simulations."""
    results, present = [], None
    for step in steps:
        scene = controls.scene_for(step["settings"], controls.scene)
        if present is None:
            present = gp.Simulation(controls.scene, seed=SEED).state
        if step["reverse"]:
            present = replace(present, velocities=-present.velocities)
        if "piston" in step:
            present = replace(present, piston=np.array(step["piston"]), piston_face="x_high")
        elif not scene.pistons:
            present = replace(present, piston=None)
        simulation = gp.Simulation(scene, seed=SEED, initial=present)
        begin = time.process_time()
        simulation.advance(duration=step["duration"])
        seconds = time.process_time() - begin
        present, tally = simulation.state, simulation.tally
        piston = [] if present.piston is None else present.piston
        arrays = present.positions, present.velocities, present.images, present.spins, np.array(piston)
        digest = hashlib.sha256(b"".join(array.tobytes() for array in arrays)).hexdigest()
        walls = 2 * scene.dimension
        results.append(
            {
                "digest": digest,
                "time": present.time,
                "collisions": tally.collisions,
                "hits": tally.wall_hits[:walls].tolist(),
                "impulse": tally.wall_impulse[:walls].tolist(),
                "seconds": seconds,
            }
        )
    return results


def differences(controls, steps, ours, theirs):
    """What differs between the results of steps in a page and natively."""
    keys = "digest", "time", "collisions", "hits", "impulse"
    return [
        (controls.flags(step["settings"]), key)
        for step, a, b in zip(steps, ours, theirs, strict=True)
        for key in keys
        if a[key] != b[key]
    ]
