"""Jobs of a machine whose every cost is known, for the tests of the scaling figures."""

from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import xarray as xr

from gaspart.reproduction.points.points import all_points, figure_points
from gaspart.theory import dsmc as partition
from gaspart.yaml_text import read_yaml

ROOT = Path(__file__).parents[4]
PARTICLE, TEST, BOX, LIST = (
    30e-9,
    12e-9,
    0.3e-9,
    2e-9,
)  # s per particle and step (with a list), pair test, box
NEAR, CONTACTS = 20e-9, 10  # s per particle and step to leave out boxes; contacts in a timing
CONFIG = read_yaml(ROOT / "config/config.yaml")
SCALING = ("naive_scaling", "box_count", "ideal_boxes", "linear_scaling", "event_scaling")


def settings(figure):
    return {key: value for key, value in CONFIG["figures"][figure].items() if key != "experiments"}


def points(figure, folder):
    """The figure's points, with their files written below `folder`."""
    config = {**CONFIG, "points": str(folder)}
    made = figure_points(config, figure, all_points(config))
    for point in made:
        path = Path(point.path)
        path.parent.mkdir(parents=True, exist_ok=True)
        job(point).to_netcdf(path)
    return made


def job(point):
    """What `measure_cost` would write, with 1 % noise of the clock."""
    if "without" in point.settings:
        return _in_turn(point)
    count, radius, lengths = point.extents
    dimension, side = len(lengths), lengths[0]
    chosen = point.engines
    sides = np.array([_side(engine) for engine in chosen])
    gas = {"dimension": dimension, "side": side, "radius": radius}
    if point.settings["engine"] == "step":
        counted = _steps(count, tuple(np.maximum(sides, 1).tolist()), **gas)
        particle = PARTICLE
        if not sides.any():  # a list of one pair a particle
            particle, counted = LIST, {**counted, "pair_tests": np.array([10 * count])}
        seconds = 10 * (particle * count + BOX * sides**dimension) + TEST * counted["pair_tests"]
    else:
        counted = _events(count, sides, getattr(chosen[0], "search", ""), gas)
        seconds = TEST * counted["pair_tests"] + 4e-7 * counted["collisions"]
    rng = np.random.default_rng((count, *point.name.encode()))
    noise = 1.0 + 0.01 * rng.standard_normal((sides.size, 5))
    return xr.Dataset(
        {
            "seconds": (("partition", "repeat"), seconds[:, None] * noise),
            "boxes": ("partition", sides**dimension),
            "boxes_per_side": ("partition", sides),
            **{name: ("partition", values) for name, values in counted.items()},
        },
        attrs={
            "count": count,
            "dimension": dimension,
            "radius": radius,
            "side": side,
            "packing_fraction": 0.1,
            "engine": point.settings["engine"],
            "search": getattr(chosen[0], "search", ""),
            "time_step": 0.01,
        },
    )


def _in_turn(point):
    """A gas and, in turn, the same one: with a search of near boxes only, or without a huge sphere."""
    alone = {key: value for key, value in point.settings.items() if key != "without"}
    own, beside = (job(replace(point, settings=alone, name=name)) for name in (point.name, "beside"))
    count = own.attrs["count"]
    if "near_boxes" in point.settings:
        reached = partition.boxes_in_reach(own.side / own.boxes_per_side, 2.0 * own.radius, own.dimension)
        own["box_visits"] = np.round(5 * count * (1.0 + reached))
        own["seconds"] = own["seconds"] + 10 * NEAR * count
    else:
        beside["pair_tests"] = beside["pair_tests"] + 10 * count
        beside["seconds"] = beside["seconds"] + 10 * TEST * count
    return xr.concat([own, beside], "partition", combine_attrs="override")


def _side(engine):
    given = engine.boxes_per_side or (0 if engine.name == "step" else 1)
    return given[0] if isinstance(given, tuple) else given


@cache
def _steps(count, sides, dimension, side, radius):
    tests = [partition.expected_pair_tests(count, n, dimension, side, radius)[0] for n in sides]
    visits = [count * partition.expected_box_visits(n, dimension, side, radius) for n in sides]
    zeros = np.zeros(len(sides), dtype=int)
    return {
        "steps": zeros + 10,
        "collisions": zeros + CONTACTS,
        "wall_hits": zeros,
        "crossings": zeros,
        "pair_tests": np.round(10 * np.array(tests)).astype(int),
        "box_visits": np.round(10 * np.array(visits)).astype(int),
    }


def _events(count, sides, search, gas):
    near = (count - 1.0) * partition.neighbour_share(sides, **gas)
    crossings = 10.0 * (sides - 1.0)
    events = 1000
    tests = {
        "pairs": (events + 1) * count * (count - 1) / 2 + 0.0 * near,
        "direct": 2.0 * events * near,
        "boxes": near * (2.0 * events + crossings / 3.0) if sides.max() > 1 else 20.0 * events + 0.0 * near,
    }["boxes" if search == "automatic" else search]
    whole = np.ones(sides.size, dtype=int)
    return {
        "steps": 0 * whole,
        "collisions": (events - 10) * whole,
        "wall_hits": 10 * whole,
        "crossings": np.round(crossings).astype(int),
        "pair_tests": np.round(tests).astype(int),
        "box_visits": 20 * events * whole,
    }
