"""A gas in a browser: an HTML page with the engine's kernels as WebAssembly."""

from __future__ import annotations

import base64
import hashlib
import json
import math
import struct
import zlib
from dataclasses import replace
from itertools import product
from pathlib import Path

import llvmlite
import numpy as np

from gaspart import __version__, theory
from gaspart.accuracy.scales import scales
from gaspart.engines.event.image import START, Image, check_scene, image_of
from gaspart.errors import SceneError
from gaspart.kernels.compile.cache import load_numba
from gaspart.kernels.compile.webassembly import modules
from gaspart.rendering.controls import RULES, Controls
from gaspart.rendering.particles import FASTEST, FIXED
from gaspart.rendering.view import View, page_of
from gaspart.scene.boundaries import piston_end
from gaspart.scene.scene import Scene, require_scene
from gaspart.scene.surfaces import FACES
from gaspart.scene.walls import Wall
from gaspart.state.given import state_at_time_zero
from gaspart.state.initial import initial_state
from gaspart.state.state import State

_MARK = "gaspart play"
_DENSITIES = 0.25, 0.5, 1.0, 2.0
"""Numbers of particles, divided by the number in the scene."""
_DENSEST = 0.45
"""Largest packing fraction of a start with another density."""
_FEW = 1000
"""Largest number of particles for which a page has other densities."""
_PUSHED, _SPEED = 0.4, 0.25
"""Smallest distance of a piston from the opposite side, divided by the length, and its speed, divided by the
thermal speed.
"""
_TABLE, _POSITIONS, _COLOURS, _STILL = 65, 13, 64, 8
"""Numbers of values in a table, of positions of a piston in it, of colours of speeds, and of colours in the
still picture.
"""
_FASTEST, _HIGHEST = 3.0, 8.0
"""Ends of the tables of Maxwell's distribution (rms speeds) and of the barometric law (scale heights)."""
_PICTURES = 100
"""Number of pictures in the time in which a particle crosses the container."""
_HEIGHT = 860
"""Height of the page in a notebook, in pixels."""


def play(scene: Scene, seed: int = 0) -> View:
    """Return a page on which a gas runs in any browser, without Python or a server.

    One can heat walls, change gravity, restitution, roughness and density, move a piston, remove interior
    walls, and reverse all velocities. Gauges show temperatures and pressures with errors and theory. The page
    contains the kernels of the event-driven engine, and computes the same bits. After each change the gas
    continues as ``Simulation(scene, seed=seed, initial=state)`` of the changed scene.

    The first page of a kind of scene compiles its kernels, in about a minute.

    Parameters
    ----------
    scene : Scene
        Two-dimensional scene.
    seed : int, default 0
        Seed of the initial state and of the random numbers of thermal walls.

    Returns
    -------
    View
        The page, which shows itself in a notebook and can be saved.

    Raises
    ------
    SceneError
        If the scene has three dimensions or a feature that is not available in a browser, or if no particle
        moves or falls.

    Examples
    --------
    >>> import gaspart as gp
    >>> species = [gp.Species(20, 0.2, temperature=1.0), gp.Species(3, 0.5, fixed=True)]
    >>> scene = gp.Scene(gp.Container((9.0, 9.0), "periodic"), species)
    >>> gp.play(scene).save("gas.html").name
    'gas.html'
    """
    require_scene(scene)
    if scene.dimension != 2:
        raise SceneError(
            "container.lengths", scene.container.lengths, "must be of two dimensions in a browser"
        )
    check_scene(scene)
    if scales(scene).crossing_time == float("inf"):
        raise SceneError("scene", scene, "nothing moves at the start, and nothing falls")
    engine = Path(__file__).with_name("gas.js").read_text(encoding="utf-8")
    content = _content(scene, seed)
    still = _still(content["starts"][content["first"]], content)
    box = f"0 0 {scene.container.lengths[0]:g} {scene.container.lengths[1]:g}"
    page = page_of("play.html", _MARK, VIEWBOX=box, STILL=still, GAS=engine, DATA=_packed(content))
    return View(page, _HEIGHT)


def _still(start: dict, content: dict) -> str:
    """Return the particles at the start as paths of an SVG, one for each radius and colour. The picture
    stands in the page until the gas is ready, or for ever if the browser does not run it.
    """
    from matplotlib.colors import to_hex

    positions, velocities = (np.frombuffer(start[key]).reshape(-1, 2) for key in ("positions", "velocities"))
    radii, weights = (np.frombuffer(start[key]) for key in ("radii", "weights"))
    share = np.hypot(*velocities.T) / content["fastest"]
    colours = np.minimum((_STILL * share).astype(int), _STILL - 1)
    discs: dict[tuple, str] = {}
    for (x, y), radius, colour, weight in zip(positions, radii, colours, weights, strict=True):
        kind = radius, colour if weight else _STILL
        discs[kind] = f"{discs.get(kind, '')}M{x:.4g} {content['lengths'][1] - y:.4g}h0"
    palette = [*_viridis(_STILL), FIXED]
    return "".join(
        f'<path stroke="{to_hex(palette[colour])}" stroke-width="{2 * radius:g}" d="{line}"/>'
        for (radius, colour), line in discs.items()
    )


def _packed(content: dict) -> str:
    """Return data as base64 of compressed JSON; bytes follow the JSON, which contains their positions."""
    stored = bytearray()

    def store(part: bytes) -> dict:
        start = len(stored)
        stored.extend(part)
        return {"bytes": [start, len(stored)]}

    text = json.dumps(content, default=store, separators=(",", ":"))
    return base64.b64encode(zlib.compress(text.encode() + b"\0" + stored, 9)).decode()


def _viridis(number: int) -> np.ndarray:
    """Return colours of speeds, from 0 to the fastest, as red, green and blue."""
    import matplotlib

    return matplotlib.colormaps["viridis"](np.linspace(0.0, 1.0, number))[:, :3]


def _numbers(values: np.ndarray) -> bytes:
    return np.ascontiguousarray(values, dtype="<f8").tobytes()


def _content(scene: Scene, seed: int) -> dict:
    """Return the data of the page."""
    controls, speed = Controls(scene), scales(scene).thermal_speed
    starts = [_start(item, controls, seed) for item in _densities(scene)]
    stored = [image for start in starts for image in start["images"].values()]
    kinds = {repr(image["kernels"]): image["kernels"] for image in stored}
    for image in stored:
        image["module"] = list(kinds).index(repr(image.pop("kernels")))
    code = modules(list(kinds.values()))
    numba = load_numba().__version__
    return {
        "made": f"gaspart {__version__}, numba {numba}, llvmlite {llvmlite.__version__}",
        "seed": seed,
        "lengths": scene.container.lengths,
        "periodic": scene.container.periodic,
        "margin": float(not scene.centres_to_walls),
        "constant": controls.constant,
        "pistonFace": next((number for number, _ in scene.pistons), FACES.index("x_high")),
        "rules": RULES,
        "controls": [
            {
                "name": item.name,
                "group": item.group,
                "values": item.values,
                "start": item.start,
                "flags": item.flags,
            }
            for item in controls.all
        ],
        "walls": [[wall.start, wall.end] for wall in scene.walls if isinstance(wall, Wall)],
        "fastest": FASTEST * math.sqrt(2.0) * (speed or math.sqrt(2.0 * _fall(scene))),
        "pushed": _SPEED * speed,
        "interval": scales(scene).crossing_time / _PICTURES,
        "colours": np.rint(255.0 * _viridis(_COLOURS)).astype(int).dot([1, 1 << 8, 1 << 16]).tolist(),
        "maxwell": _maxwell(),
        "barometric": np.exp(-np.linspace(0.0, _HIGHEST, _TABLE)).tolist(),
        "ends": [_FASTEST, _HIGHEST],
        "gravity": scene.gravity or [0.0] * scene.dimension,
        "first": [start["count"] for start in starts].index(scene.count),
        "digest": hashlib.sha256(b"".join(code)).hexdigest()[:16],
        "starts": starts,
        "modules": code,
    }


def _fall(scene: Scene) -> float:
    """Return the product of gravity and the height of the container."""
    return sum(
        abs(g) * length for g, length in zip(scene.gravity or (), scene.container.lengths, strict=False)
    )


def _densities(scene: Scene) -> list[Scene]:
    """Return the scene with fewer and more particles if they are placed at random."""
    random = scene.species and not scene.particles and not scene.has_fixed and not scene.walls
    random = random and all(kind.arrangement == "random" and kind.region is None for kind in scene.species)
    if not random or scene.count > _FEW:
        return [scene]
    scenes = []
    for share in _DENSITIES:
        species = [replace(kind, count=max(1, round(share * kind.count))) for kind in scene.species]
        changed = replace(scene, species=species)
        if share == 1.0 or changed.packing_fraction <= _DENSEST:
            scenes.append(changed)
    return scenes


def _start(scene: Scene, controls: Controls, seed: int) -> dict:
    """Return the data of a start: particles, theory, and an image for each kind of scenes."""
    state = initial_state(scene, seed)
    images = {kind: _image(scene, controls, kind, state, seed) for kind in controls.kinds()}
    moving = np.isfinite(state.masses)
    freedom = scene.dimension * max(int(moving.sum()) - scene.is_periodic, 1)
    weights = np.where(moving, state.masses, 0.0) / freedom
    low, high = scene.reach(scene.largest_moving_radius)
    return {
        "fraction": scene.packing_fraction,
        "count": scene.count,
        "positions": _numbers(state.positions),
        "velocities": _numbers(state.velocities),
        "spins": _numbers(state.spins),
        "radii": _numbers(state.radii),
        "masses": _numbers(state.masses),
        "inertia": _numbers(state.moments_of_inertia),
        "weights": _numbers(weights),
        "alike": len(set(state.masses[moving].tolist())) == 1,
        "freedom": freedom,
        "diameter": 2.0 * scene.smallest_radius,
        "insets": [length - (b - a) for length, a, b in zip(scene.container.lengths, low, high, strict=True)],
        "end": min(piston_end(scene), 1e300),
        "pressure": _pressure(scene, controls),
        "entropy": _entropy(int(moving.sum())),
        "images": images,
    }


def _image(scene: Scene, controls: Controls, kind: str, state: State, seed: int) -> dict:
    """Return the image of a kind of scenes, and the words that controls change."""
    typical = controls.typical(kind)
    base = controls.scene_for(typical, scene)
    image = _image_at_zero(base, state, seed, scaled=True)
    patches: dict[str, list] = {}
    touched: set[int] = set()
    for group in dict.fromkeys(control.group for control in controls.all):
        members = [control for control in controls.all if control.group == group]
        allowed = [set(flag) <= {*kind, "t"} for control in members for flag in control.flags]
        if group == "walls" or (group == "x_high" and "p" in kind) or not any(allowed):
            continue
        changed: set[int] = set()
        patches[group] = []
        for values in product(*(control.values for control in members)):
            settings = typical | dict(zip((control.name for control in members), values, strict=True))
            if set(controls.flags(settings)) - {"t"} != set(kind):
                patches[group].append(None)
                continue
            changed_scene = controls.scene_for(settings, scene)
            patch = _patch(image, _image_at_zero(changed_scene, state, seed))
            if set(patch) & touched:  # patches of different groups are combined
                patches[group].append(None)
                continue
            words = b"".join(struct.pack("<I8s", *item) for item in patch.items())
            patches[group].append([words, _changes(base.to_dict(), changed_scene.to_dict())])
            changed |= set(patch)
        touched |= changed
    return {
        "kernels": image.kernels,
        "start": START,
        "unit": image.unit,
        "blob": bytes(image.data),
        "words": image.words,
        "slots": image.slots,
        "arrays": image.arrays,
        "times": image.times,
        "scaled": image.scaled,
        "boxes": image.boxes,
        "patches": patches,
        "scene": base.to_dict(),
    }


def _image_at_zero(scene: Scene, state: State, seed: int, scaled: bool = False) -> Image:
    return image_of(scene, state_at_time_zero(scene, state), seed, scaled)


def _patch(base: Image, other: Image) -> dict[int, bytes]:
    """Return the words of another image that differ, by their addresses."""
    assert (base.kernels, base.words, base.arrays) == (other.kernels, other.words, other.arrays)
    ours, theirs = (np.frombuffer(bytes(image.data), dtype="<i8") for image in (base, other))
    return {START + 8 * n: theirs[n].tobytes() for n in np.flatnonzero(ours != theirs).tolist()}


def _changes(base: dict, other: dict) -> dict:
    """Return the entries of a mapping that differ from another one, None if they are missing."""
    return {
        key: _changes(base.get(key) or {}, other.get(key) or {}) if key == "faces" else other.get(key)
        for key in base.keys() | other.keys()
        if base.get(key) != other.get(key)
    }


# Tables of theory.


def _pressure(scene: Scene, controls: Controls) -> dict | None:
    """Return p A / k_B T for positions of the side x high; None if unknown. A is the accessible area. The
    walls of a rectangle count as the walls of a square with the same ratio of perimeter and area.
    """
    gas, lengths = scene.gas, scene.container.lengths
    if gas is None or scene.walls or scene.has_piston:
        return None
    moves = any(control.name == "piston" for control in controls.all)
    least = max(_PUSHED, scene.packing_fraction / _DENSEST) if moves else 1.0
    positions = np.linspace(least, 1.0, _POSITIONS if moves else 1) * lengths[0]
    low, high = scene.reach(scene.largest_moving_radius)
    walled = list(scene.walled_axes)
    values = []
    for position in positions:
        sides = np.array([position, lengths[1]])
        area = float(np.prod(sides - np.array(lengths) + np.array(high) - np.array(low)))
        try:
            if not walled:
                value = float(theory.compressibility_factor(gas.packing_fraction, gas.dimension))
                value *= scene.count - 1
            else:
                side = len(walled) / float((1.0 / sides[walled]).sum()) / gas.diameter
                density = scene.count / area * gas.diameter**2
                value = theory.wall_pressure(side, density, scene.count, 2, len(walled))[0]
                value *= area / gas.diameter**2
        except ValueError:
            return None
        values.append(value)
    return {"positions": positions.tolist(), "values": values}


def _maxwell() -> list[float]:
    """Return Maxwell's density of speeds in units of the rms speed, at equal intervals."""
    speeds = np.linspace(0.0, _FASTEST, _TABLE)
    return np.asarray(theory.maxwell_pdf(speeds, 2, temperature=0.5)).tolist()


def _entropy(count: int) -> list[float]:
    """Return the logarithm of the number of ways to choose n particles, for each n."""
    ways = [
        math.lgamma(count + 1) - math.lgamma(n + 1) - math.lgamma(count - n + 1) for n in range(count + 1)
    ]
    return [round(value, 6) for value in ways]
