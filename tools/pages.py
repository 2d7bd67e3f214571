"""Cost and gauges of the page of `gaspart play`: CPU time an event against native code, and true errors.

    PYTHONPATH=tests python tools/pages.py FOLDER

prints the ratio of CPU times for each kind of kernels (median of three runs in turns), and for each gauge
with a theory the rms of (mean - theory) / error over 20 stretches of one gas between thermal walls, which
should be .8 to 1.3. A page is written to the folder.
"""

from __future__ import annotations

import math
import sys
from dataclasses import replace
from pathlib import Path
from statistics import median

import yaml
from browsers import CHROMIUM, found_in
from sessions import SEED, in_node, natively, page_data

import gaspart as gp
from gaspart.cli.new import templates
from gaspart.rendering.controls import Controls

COUNTS, EVENTS, TURNS, STRETCHES = (300, 1000), 1_000_000, 3, 20
GAUGES = """
while (busy) await new Promise(go => setTimeout(go, 20));
for (const name of Object.keys(NAMES)) values[name] = 4;
await change({ anew: true });
const found = [], run = steps => { for (let n = 0; n < steps; n++) advance(16 * data.interval); };
for (let n = 0; n < STRETCHES; n++) { run(300); await change(); run(2000); found.push(gauges()); }
return found;
"""


def gas(count: int) -> gp.Scene:
    """The template gas with another number of discs at the same density."""
    scene = gp.Scene.from_dict(yaml.safe_load(templates()["gas"].text))
    scale = math.sqrt(count / scene.count)
    lengths = tuple(scale * length for length in scene.container.lengths)
    return replace(
        scene,
        container=replace(scene.container, lengths=lengths),
        species=[replace(scene.species[0], count=count)],
    )


def print_costs(count: int, folder: Path) -> None:
    """Print the ratio of CPU times in node and natively for each kind of kernels."""
    scene = gas(count)
    controls, data = Controls(scene), page_data(scene, folder)
    for kind in controls.kinds():
        if "r" in kind and "g" in kind:  # ever more collisions in a pile
            continue
        step = {"settings": controls.typical(kind), "reverse": False, "duration": 1.0}
        natively(controls, [step])  # compiles
        step["duration"] = EVENTS / max(natively(controls, [step])[0]["collisions"], 1)
        ratios = []
        for _ in range(TURNS):
            (native,), (ours,) = natively(controls, [step]), in_node(controls, [step], data, folder)
            ratios.append(ours["seconds"] / native["seconds"])
        print(f"{count} discs, kind {kind or 'plain'!r}: {median(ratios):.2f} times native, {ratios}")


def print_gauges(folder: Path) -> None:
    """Print the rms deviation from theory of each gauge, in units of its error."""
    page = gp.play(gas(150), SEED).save(folder / "gauges.html", overwrite=True)
    found, lines = found_in(CHROMIUM, page, GAUGES.replace("STRETCHES", str(STRETCHES)), folder, seconds=1200)
    assert not lines, lines
    for n, (name, *_) in enumerate(found[0]):
        if name == "temperature" or "pressure" in name:
            rows = [stretch[n][1:] for stretch in found]
            scaled = [(value - theory) / error for value, error, theory in rows]
            rms = math.sqrt(sum(x * x for x in scaled) / len(scaled))
            print(f"{name}: rms {rms:.2f}, mean {sum(scaled) / len(scaled):+.2f}")


if __name__ == "__main__":
    target = Path(sys.argv[1])
    print_gauges(target)
    for number in COUNTS:
        print_costs(number, target)
