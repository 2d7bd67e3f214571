"""Scene of a point, made from its settings, or read from a scene file.

Settings may replace values of the scene file. The planning of a workflow makes the scene of every point, so
slow imports are made inside functions.
"""

from __future__ import annotations

import math
from copy import deepcopy
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from gaspart.errors import SceneError, short_repr
from gaspart.keys.values import MOST_PARTICLES
from gaspart.reproduction.points.point_keys import EXTENTS, GAS, PREFIX
from gaspart.scene.sizes import DISTRIBUTIONS, ball_volume
from gaspart.yaml_text import read_yaml

if TYPE_CHECKING:
    from gaspart.reproduction.points.point import Point
    from gaspart.scene.scene import Scene


class Extents(NamedTuple):
    """Number of particles, largest radius, and side lengths (d,). For a polydisperse species the radius is
    the mean radius.
    """

    particles: int
    radius: float
    lengths: tuple[float, ...]


def scene(point: Point) -> Scene:
    """Return the ``Scene`` of a point."""
    return _read(point) if "scene" in point.settings else _made(point)


def extents(point: Point) -> Extents:
    """Return the extents of a point. Three of count, radius, packing fraction and side are given, and the
    fourth is computed. A computed count is rounded to an integer. A computed side is equal on all axes. With
    a scene file, all extents are known from the file.
    """
    settings = point.settings
    if "scene" in settings:
        read = point.scene
        if read.count == 0:
            raise point.make_error("scene", "a point needs at least one particle")
        return Extents(read.count, read.largest_radius, read.container.lengths)
    _check_gas(point)
    dimension = settings["dimension"]
    unit = ball_volume(dimension) * _mean_volume(point)
    values: list[Any] = [settings.get(key) for key in EXTENTS]
    count, radius, fraction, side = values
    if side is None:
        edge = (count * unit * radius**dimension / fraction) ** (1.0 / dimension)
        return Extents(int(count), float(radius), (edge,) * dimension)
    lengths = tuple(map(float, side)) if isinstance(side, (list, tuple)) else (float(side),) * dimension
    if len(lengths) != dimension:
        raise point.make_error("side", f"must have {dimension} lengths")
    volume = math.prod(lengths)
    if count is None:
        number = fraction * volume / (unit * radius**dimension)
        if not 0.5 < number <= MOST_PARTICLES:
            rule = f"makes {number:g} particles, which must be from 1 to {MOST_PARTICLES}"
            raise point.make_error("packing_fraction", rule)
        count = round(number)
    elif radius is None:
        radius = (fraction * volume / (unit * count)) ** (1.0 / dimension)
    return Extents(int(count), float(radius), lengths)


def _check_gas(point: Point) -> None:
    """Raise SceneError for settings that do not describe a gas in a container."""
    settings = point.settings
    replaced = next((key for key in settings if key.startswith(PREFIX)), None)
    if replaced:
        raise point.make_error(replaced, "replaces a value of a scene file, but there is no scene")
    if "dimension" not in settings:
        raise point.make_error("dimension", "is required, unless there is a scene file")
    extents = [key for key in EXTENTS if key in settings]
    if len(extents) != 3:
        rule = f"exactly three of {', '.join(EXTENTS)} must be given"
        raise SceneError(f"experiments.{point.experiment}", extents, rule)


def _small_count(point: Point) -> int:
    """Return the number of particles of the second species."""
    count = int(point.settings["count"])
    return min(max(round(count * point.settings["small_fraction"]), 1), count - 1)


def _mean_volume(point: Point) -> float:
    """Compute the mean of (radius / radius in the settings)^d over the particles."""
    from gaspart.scene.sizes import relative_radii

    settings = point.settings
    mixed = [key for key in ("size_ratio", "small_fraction") if key in settings]
    sized = [key for key in ("polydispersity", "radius_distribution") if key in settings]
    if not mixed and not sized:
        return 1.0
    if settings.get("count", 1) < 2 or "count" not in settings:
        raise point.make_error((mixed + sized)[0], "needs a count of two or more")
    count, dimension = int(settings["count"]), settings["dimension"]
    if mixed:
        if len(mixed) == 1 or sized:
            raise point.make_error(mixed[0], "needs size_ratio and small_fraction, and no polydispersity")
        small = _small_count(point)
        return (count - small + small * settings["size_ratio"] ** dimension) / count
    if "polydispersity" not in settings:
        raise point.make_error("radius_distribution", "needs a polydispersity")
    distribution = settings.get("radius_distribution", DISTRIBUTIONS[0])
    radii = relative_radii(count, float(settings["polydispersity"]), distribution)
    return math.fsum(radius**dimension for radius in radii.tolist()) / count


def _made(point: Point) -> Scene:
    """Return the scene that the settings describe: one species, or two sizes."""
    from gaspart.scene.container import Container
    from gaspart.scene.scene import Scene
    from gaspart.scene.species import Species

    settings = point.settings
    count, radius, lengths = point.extents
    boundary = settings.get("boundary", "wall")
    species = Species(
        count=count,
        radius=radius,
        polydispersity=settings.get("polydispersity"),
        radius_distribution=settings.get("radius_distribution"),
        mass=settings.get("mass", 1.0),
        speed=settings.get("speed"),
        temperature=settings.get("temperature"),
        exact_temperature=settings.get("exact_temperature", False),
        arrangement=settings.get("arrangement", "random"),
    )
    container = Container(
        lengths=lengths, boundary=boundary if isinstance(boundary, str) else tuple(boundary)
    )
    mixed: tuple[Species, ...] = (species,)
    if "size_ratio" in settings:
        small = _small_count(point)
        smaller = replace(species, count=small, radius=radius * settings["size_ratio"])
        mixed = replace(species, count=count - small), smaller
    return Scene(container=container, species=mixed, centres_to_walls=settings.get("centres_to_walls", False))


def _read(point: Point) -> Scene:
    """Read the scene of the scene file, or of its content. Settings replace values of the scene."""
    from gaspart.scene.scene import Scene

    settings = point.settings
    for key in (*GAS, *EXTENTS):
        if key in settings:
            rule = f"has no meaning beside a scene file, of which {PREFIX}... replaces single values"
            raise point.make_error(key, rule)
    replaced = [key for key in settings if key.startswith(PREFIX)]
    stated = settings["scene"]
    content, unchanged = (stated, None) if isinstance(stated, dict) else _of_file(point, stated)
    if not replaced:
        return unchanged or Scene.from_dict(content)
    content = deepcopy(content)
    for key in replaced:
        _replace(content, key, point)
    return Scene.from_dict(content)


def _of_file(point: Point, path: str) -> tuple[Any, Scene]:
    """Return the content of the scene file of a point, and its unmodified scene."""
    try:
        changed = Path(path).stat().st_mtime_ns
    except OSError as error:
        raise point.make_error("scene", f"cannot be read: {error.strerror}") from None
    except ValueError:  # a NUL, or a character that file names cannot contain
        raise point.make_error("scene", "is not a file name") from None
    return _file(path, changed)


@cache
def _file(path: str, changed: int) -> tuple[Any, Scene]:
    """Return the content of a scene file, and its scene. A changed file is read again."""
    from gaspart.scene.scene import Scene

    content = read_yaml(path)
    return content, Scene.from_dict(content, path)


def _replace(content: dict, key: str, point: Point) -> None:
    """Replace the value at a dotted key; add the key if it is missing. The key is `scene.`, followed by names
    in mappings and indices in lists.
    """
    _, *parents, last = key.split(".")
    block = content
    for part in parents:
        at = _place(block, part, key, point)
        if block[at] is None:
            block[at] = {}
        block = block[at]
    block[_place(block, last, key, point)] = deepcopy(point.settings[key])


def _place(block: object, part: str, key: str, point: Point) -> str | int:
    """Return the key or index that `part` of a dotted key denotes. The `block` is a mapping or a list."""
    if isinstance(block, dict):
        block.setdefault(part, None)
        return part
    if not isinstance(block, list):
        raise point.make_error(key, f"the scene file has {short_repr(block)} where this looks for {part}")
    if not part.isdecimal() or len(part) > 9 or int(part) >= len(block):
        rule = f"{part} must be the number of an item, of which the scene file has {len(block)}, from 0"
        raise point.make_error(key, rule)
    return int(part)
