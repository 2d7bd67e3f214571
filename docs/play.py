"""A page to play with: python docs/play.py FOLDER

Writes index.html and the recorded runs that it shows, one for each point of a small grid of two parameters of
some templates, without a server. A template is run in a container of half the length with a quarter of the
particles, so that all pages together have at most `MOST` bytes.
"""

from __future__ import annotations

import json
import sys
from collections.abc import Callable
from dataclasses import dataclass, replace
from itertools import product
from math import inf
from pathlib import Path

import yaml

import gaspart as gp
from gaspart.accuracy.scales import scales
from gaspart.cli.new import templates
from gaspart.rendering.live import meters_of
from gaspart.rendering.live_gas import LiveGas

MOST = 4_000_000
"""Bytes of all files."""
_FRAMES, _CROSSINGS = 37, 0.9
"""Frames of a run, and its duration in times in which a particle crosses the container."""
_STEPS = 400
"""Steps of the gauges."""


@dataclass(frozen=True)
class Dial:
    """A parameter of a scene: its name, its values, and the scene with a value."""

    name: str
    values: tuple[float, ...]
    turned: Callable[[gp.Scene, float], gp.Scene]


def _filled(scene: gp.Scene, fraction: float) -> gp.Scene:
    factor = fraction / scene.packing_fraction
    species = [replace(one, count=max(1, round(factor * one.count))) for one in scene.species]
    return replace(scene, species=species)


def _face(name: str, key: str) -> Callable[[gp.Scene, float], gp.Scene]:
    def turned(scene: gp.Scene, value: float) -> gp.Scene:
        return replace(scene, faces={**scene.faces, name: replace(scene.faces[name], **{key: value})})

    return turned


def _pulled(scene: gp.Scene, gravity: float) -> gp.Scene:
    return replace(scene, gravity=(0.0, -gravity))


def _damped(scene: gp.Scene, normal: float) -> gp.Scene:
    return replace(scene, restitution=replace(scene.restitution, normal=normal))


_DENSITY = Dial("packing fraction", (0.05, 0.15, 0.3), _filled)
GRIDS = {
    "gas": (_DENSITY, Dial("gravity", (0.0, 0.05, 0.2), _pulled)),
    "heat": (_DENSITY, Dial("temperature of the hot wall", (1.0, 2.0, 4.0), _face("x_low", "temperature"))),
    "shock": (_DENSITY, Dial("speed of the piston", (0.5, 1.0, 1.5), _face("x_low", "speed"))),
    "cooling": (_DENSITY, Dial("restitution", (0.99, 0.9, 0.7), _damped)),
}
"""The two dials of each template."""


def small(name: str) -> gp.Scene:
    """Return the scene of a template in half the length, with a quarter of the particles."""
    scene = gp.Scene.from_dict(yaml.safe_load(templates()[name].text))
    lengths = tuple(0.5 * length for length in scene.container.lengths)
    species = [replace(one, count=one.count // 4) for one in scene.species]
    return replace(scene, container=replace(scene.container, lengths=lengths), species=species)


def record(scene: gp.Scene) -> tuple[str, str]:
    """Return the page of a run of a scene, and what its gauges read."""
    longest = min(
        (0.5 * scene.container.lengths[0] / piston.speed for _, piston in scene.pistons), default=inf
    )
    simulation, gas = gp.Simulation(scene, seed=1), LiveGas(scene, seed=1)
    simulation.advance(duration=min(longest, _CROSSINGS * scales(scene).crossing_time))
    for _ in range(int(min(longest / gas.interval, _STEPS))):
        gas.step()
    return gp.view(simulation, frames=_FRAMES).page, meters_of(gas)


def write(folder: Path, grids: dict[str, tuple[Dial, Dial]] = GRIDS) -> int:
    """Write the page and its runs; return their size in bytes."""
    folder.mkdir(parents=True, exist_ok=True)
    content = {}
    for name, dials in grids.items():
        meters = {}
        for i, j in product(*(range(len(dial.values)) for dial in dials)):
            scene = small(name)
            for dial, n in zip(dials, (i, j), strict=True):
                scene = dial.turned(scene, dial.values[n])
            page, meters[f"{i}-{j}"] = record(scene)
            (folder / f"{name}-{i}-{j}.html").write_text(page, encoding="utf-8")
        controls = [{"name": dial.name, "values": dial.values} for dial in dials]
        content[name] = {"title": templates()[name].title, "dials": controls, "meters": meters}
    text = (Path(__file__).parent / "play.html").read_text(encoding="utf-8")
    (folder / "index.html").write_text(text.replace("DATA", json.dumps(content)), encoding="utf-8")
    size = sum(path.stat().st_size for path in folder.iterdir())
    if size > MOST:
        raise SystemExit(f"{folder} has {size} bytes, more than {MOST}")
    return size


if __name__ == "__main__":
    print(f"{sys.argv[1]}: {write(Path(sys.argv[1])) / 1e6:.1f} MB")
