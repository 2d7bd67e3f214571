"""The scene of a point: made of its settings, or read from a scene file in which some values are replaced.

Planning a workflow makes the scene of every point, so slow imports are made inside functions.
"""

from __future__ import annotations

import json
import math
from copy import deepcopy
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

from gaspart.errors import SceneError, shown
from gaspart.reproduction.points.keys import EXTENTS, GAS, PREFIX
from gaspart.reproduction.points.point import Point
from gaspart.scene.geometry import ball_volume
from gaspart.scene.validation import MOST_BODIES
from gaspart.yaml_text import read_yaml

if TYPE_CHECKING:
    from gaspart.scene.scene import Scene


def check_scene(point: Point) -> None:
    """Refuse settings that describe no scene, or two, with SceneError; the cheap part, without reading a
    file."""
    settings, where = point.settings, f"experiments.{point.experiment}"
    replaced = [key for key in settings if key.startswith(PREFIX)]
    if "scene" in settings:
        for key in (*GAS, *EXTENTS):
            if key in settings:
                rule = f"has no meaning beside a scene file, of which {PREFIX}... replaces single values"
                raise SceneError(f"{where}.{key}", settings[key], rule)
        return
    if replaced:
        rule = "replaces a value of a scene file, but there is no scene"
        raise SceneError(f"{where}.{replaced[0]}", settings[replaced[0]], rule)
    if "dimension" not in settings:
        raise SceneError(f"{where}.dimension", None, "is required, unless there is a scene file")
    given = [key for key in EXTENTS if key in settings]
    if len(given) != 3:
        raise SceneError(where, given, f"exactly three of {', '.join(EXTENTS)} must be given")


def scene(point: Point) -> Scene:
    """The point's ``Scene``. Raises SceneError."""
    check_scene(point)
    return _read(point) if "scene" in point.settings else _made(point)


def extents(point: Point) -> tuple[int, float, tuple[float, ...]]:
    """Number of particles, largest radius and side lengths. Raises SceneError.

    Three of count, radius, packing fraction and side are given and the fourth follows: a count that follows
    is rounded to a whole number; a side that follows is the same on every axis. A scene file states all of
    them.
    """
    check_scene(point)
    settings, where = point.settings, f"experiments.{point.experiment}"
    if "scene" in settings:
        read = scene(point)
        if read.count == 0:
            raise SceneError(f"{where}.scene", settings["scene"], "a point needs at least one particle")
        return read.count, read.largest_radius, read.container.lengths
    dimension = settings["dimension"]
    unit = ball_volume(dimension)
    given: list[Any] = [settings.get(key) for key in EXTENTS]
    count, radius, fraction, side = given
    if side is not None:
        lengths = tuple(map(float, side)) if isinstance(side, (list, tuple)) else (float(side),) * dimension
        if len(lengths) != dimension:
            raise SceneError(f"{where}.side", side, f"must have {dimension} lengths")
        volume = math.prod(lengths)
        if count is None:
            found = fraction * volume / (unit * radius**dimension)
            if not 0.5 < found <= MOST_BODIES:
                rule = f"makes {found:g} particles, which must be from 1 to {MOST_BODIES}"
                raise SceneError(f"{where}.packing_fraction", fraction, rule)
            count = round(found)
        elif radius is None:
            radius = (fraction * volume / (unit * count)) ** (1.0 / dimension)
    else:
        lengths = ((count * unit * radius**dimension / fraction) ** (1.0 / dimension),) * dimension
    return int(count), float(radius), lengths


def _made(point: Point) -> Scene:
    """The scene of one species that the settings describe."""
    from gaspart.scene.container import Container
    from gaspart.scene.scene import Scene
    from gaspart.scene.species import Species

    settings = point.settings
    count, radius, lengths = extents(point)
    boundary = settings.get("boundary", "wall")
    species = Species(
        count=count,
        radius=radius,
        mass=settings.get("mass", 1.0),
        speed=settings.get("speed"),
        temperature=settings.get("temperature"),
        exact_temperature=settings.get("exact_temperature", False),
        arrangement=settings.get("arrangement", "random"),
    )
    container = Container(
        lengths=lengths, boundary=boundary if isinstance(boundary, str) else tuple(boundary)
    )
    return Scene(
        container=container, species=(species,), centres_to_walls=settings.get("centres_to_walls", False)
    )


def _read(point: Point) -> Scene:
    """The scene of the scene file, with the values that the settings replace."""
    path, where = point.settings["scene"], f"experiments.{point.experiment}"
    try:
        changed = Path(path).stat().st_mtime_ns
    except OSError as error:
        raise SceneError(f"{where}.scene", path, f"cannot be read: {error.strerror}") from None
    except ValueError:  # a NUL, or a character that no file name can hold
        raise SceneError(f"{where}.scene", path, "is not a file name") from None
    replaced = {key: value for key, value in point.settings.items() if key.startswith(PREFIX)}
    return _with(path, changed, json.dumps(replaced), where)


@cache
def _with(path: str, changed: int, replaced: str, where: str) -> Scene:
    """The scene of a file with values `replaced`, JSON; kept, since planning asks for each several times."""
    from gaspart.scene.scene import Scene

    content, alone = _file(path, changed)
    values = json.loads(replaced)
    if not values:
        return alone
    content = deepcopy(content)
    for key, value in values.items():
        _put(content, key, value, where)
    return Scene.from_dict(content)


@cache
def _file(path: str, changed: int) -> tuple[Any, Scene]:
    """What a scene file holds, and the scene that it is by itself. Read again when it has changed."""
    from gaspart.scene.scene import Scene

    content = read_yaml(path)
    return content, Scene.from_dict(content, path)


def _put(content: dict, key: str, value: object, where: str) -> None:
    """Replace the value at a dotted key, `scene.` and then names in mappings and numbers in lists; what a
    mapping does not hold yet is added."""
    _, *parents, last = key.split(".")
    block = content
    for part in parents:
        at = _place(block, part, key, value, where)
        if block[at] is None:
            block[at] = {}
        block = block[at]
    block[_place(block, last, key, value, where)] = value


def _place(block: object, part: str, key: str, value: object, where: str) -> str | int:
    """Where `part` of a dotted key leads in a mapping or a list."""
    if isinstance(block, dict):
        block.setdefault(part, None)
        return part
    if not isinstance(block, list):
        rule = f"the scene file has {shown(block)} where this looks for {part}"
        raise SceneError(f"{where}.{key}", value, rule)
    if not part.isdecimal() or len(part) > 9 or int(part) >= len(block):
        rule = f"{part} must be the number of an item, of which the scene file has {len(block)}, from 0"
        raise SceneError(f"{where}.{key}", value, rule)
    return int(part)
