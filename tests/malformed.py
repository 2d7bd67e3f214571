"""Malformed input: valid scenes, configs and texts that hypothesis mutates."""

import copy
import itertools
import time
from contextlib import contextmanager
from datetime import date
from decimal import Decimal
from fractions import Fraction
from functools import cache
from pathlib import Path

import numpy as np
from hypothesis import strategies as st
from numba.core.event import install_timer

from gaspart.errors import SceneError
from gaspart.reproduction.points.points import POINT
from gaspart.yaml_text import dump_yaml

ROOT = Path(__file__).parents[1]
LIMIT = 2.0
"""Seconds in which every input must be accepted or refused."""

SCENES = [
    {
        "container": {"lengths": [10.0, 12.0], "boundary": ["wall", "periodic"]},
        "species": [{"count": 5, "radius": 0.5, "speed": 1.0, "moment_of_inertia": 0.1, "mass": 2.0}],
        "particles": [{"position": [5.0, 5.0], "velocity": [1.0, 0.0], "radius": 0.3, "spin": 0.5}],
        "walls": [{"start": [1.0, 1.0], "end": [1.0, 3.0]}],
        "gravity": [-1.0, 0.0],
        "restitution": {"normal": 0.9, "tangential": 0.5},
        "faces": {"x_low": {"kind": "thermal", "temperature": 2.0, "components": "normal"}},
    },
    {
        "container": {"lengths": [8.0, 9.0, 10.0], "boundary": "wall"},
        "species": [
            {
                "count": 20,
                "radius": 0.2,
                "temperature": 1.0,
                "exact_temperature": True,
                "arrangement": "lattice",
            }
        ],
        "centres_to_walls": True,
        "faces": {
            "z_low": {"kind": "well", "depth": 1.0, "width": 0.5, "temperature": 1.0},
            "z_high": {"kind": "sticky", "momentum": 0.1},
            "y_low": {"kind": "vibrating", "amplitude": 0.3, "period": 2.0, "waveform": "sawtooth"},
        },
    },
    {
        "container": {"lengths": [8.0, 9.0], "boundary": ["wall", "periodic"]},
        "species": [{"count": 5, "radius": 0.3, "speed": 1.0}],
        "faces": {"x_low": {"kind": "piston", "mass": 20.0, "pressure": 0.5}},
    },
    {
        "container": {"lengths": [8.0, 9.0, 10.0], "boundary": "periodic"},
        "species": [{"count": 2, "radius": 0.2, "fixed": True, "vibration": 0.1}],
        "particles": [{"position": [4, 4, 4], "velocity": [0, 0, 1], "radius": 0.3, "spin": [0, 0, 1]}],
        "walls": [{"corner": [1, 1, 1], "edges": [[2, 0, 0], [0, 2, 0]]}],
    },
    {
        "container": {"lengths": [8.0, 9.0], "boundary": ["wall", "periodic"]},
        "species": [
            {"count": 2, "radius": 0.3, "speed": 1.0, "region": [[0, 0], [4, 9]]},
            {"count": 2, "radius": 0.3, "speed": 1.0, "region": [[4, 0], [8, 9]]},
        ],
        "walls": [{"start": [4, 0], "end": [4, 9], "mass": 20.0}],
    },
    {
        "container": {"lengths": [8.0, 9.0], "boundary": "periodic"},
        "species": [{"count": 5, "radius": 0.3, "temperature": 1.0}],
        "faces": {"y_high": {"kind": "lees_edwards", "shear_rate": -0.5}},
    },
]  # fmt: skip

NASTY_TEXT = ["", " ", "\0", "\n", "wall\n", "periodic", "random", "all", "thermal", "1e3", "..", "/"]
NASTY_TEXT += ["\ud800", "\x1b[31m", "é", "results/x\n", "2001-02-30", "0x_", "x_low", "a" * 10_000]
NASTY_TEXT += ["scene.species.0.count", "scene.particles.0.mass", "scene.", "auto", "step", "compressed"]
NASTY = [None, True, False, [], {}, [[]], [{}], {"": 1}, {"kind": []}, {"a": {"b": {"c": [1]}}}]
NASTY += [[[1, 1]], [1, "a"], 0, 1, -1, 2, 3, 2.5, 0.1, -0.5, 2**31, 2**63, 10**30, 10**400]
NASTY += [1e20, 1e300, -1e300, 1e-300, 5e-324, 1e-61, float("nan"), float("inf"), float("-inf")]
NASTY += [[1e300] * 3, [1e-300] * 2, [0, 0], [0, 0, 0], [1] * 1000, *NASTY_TEXT]
OBJECTS = [object(), b"12", 1 + 2j, Decimal("1"), Fraction(10**400, 3), np.float32(0.5), np.int64(3)]
OBJECTS += [np.array([1.0, 2]), np.array(1.0), np.array([["a"]]), np.bool_(True), {1, 2}, {3: 4}]
OBJECTS += [range(10**9), itertools.count(), print, int, (), (1,), date(2001, 2, 3)]
"""What no YAML holds, but a call from Python may."""
TEXTS = ["[", "]", "{", "}", ":", ",", "- ", "? ", "&a ", "*a", "<<: *a", "!!int ", "!x ", "|\n", ">\n"]
TEXTS += ["'", '"', "#", "---\n", "...\n", "%YAML 9.9\n", "\t", "\r", "\n", " ", "\0", "\ufeff", "\x85"]
TEXTS += ["\u2028", "0x_", "2001-02-30", "1:2:3", "1e3", ".inf", "=", "~", "@", "`", "\\x", "\\ud800"]
TEXTS += ["{a: ", "[[[[[[[[", "9" * 5000, "0b_", "1__", "_"]
KINDS = ["replace", "replace", "replace", "delete", "rename", "exchange", "double", "wrap"]


def paths(value, so_far=()):
    """The places in a tree, the root first."""
    found = [so_far]
    items = value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ()
    for key, item in items:
        found += paths(item, (*so_far, key))
    return found


def at(tree, path):
    for key in path:
        tree = tree[key]
    return tree


@st.composite
def mutated(draw, trees, values, most=3):
    """One of `trees` with some places deleted, doubled, renamed, exchanged or replaced by one of `values`."""
    tree = copy.deepcopy(draw(st.sampled_from(trees)))
    for _ in range(draw(st.integers(1, most))):
        places = paths(tree)[1:]
        if not places:
            break
        *way, key = draw(st.sampled_from(places))
        block = at(tree, way)
        kind = draw(st.sampled_from(KINDS))
        if kind == "replace":
            block[key] = copy.deepcopy(draw(st.sampled_from(values)))
        elif kind == "delete":
            del block[key]
        elif kind == "exchange":
            block[key] = copy.deepcopy(at(tree, draw(st.sampled_from(places))))
        elif kind == "wrap":
            block[key] = draw(st.sampled_from([[block[key]], {"a": block[key]}, str(block[key])]))
        elif isinstance(block, list):
            block.insert(0, copy.deepcopy(block[key]))
        elif kind == "rename":
            block[draw(st.sampled_from([*NASTY_TEXT, f"{key} ", f"{key}s", 3, None]))] = block.pop(key)
        else:
            block[f"{key}"], block[f"{key}2"] = block[key], copy.deepcopy(block[key])
    return tree


def texts():
    """Texts of valid scenes and of small trees."""
    plain = st.one_of(
        st.none(), st.booleans(), st.integers(), st.floats(allow_nan=False), st.text("ab :-#'[]{}&*!1e+")
    )
    key = st.text("abc", min_size=1)
    trees = st.recursive(plain, lambda inner: st.lists(inner) | st.dictionaries(key, inner), max_leaves=10)
    return st.one_of(st.sampled_from(SCENES), trees).map(dump_yaml)


@st.composite
def mutated_texts(draw):
    """Valid texts into which parts are inserted, repeated or moved, or of which parts are missing."""
    text = draw(texts())
    for _ in range(draw(st.integers(1, 6))):
        start = draw(st.integers(0, len(text)))
        end = min(len(text), start + draw(st.integers(0, 20)))
        part = draw(
            st.one_of(
                st.sampled_from(TEXTS), st.sampled_from([text[start:end], "", text]), st.text(max_size=3)
            )
        )
        times = draw(st.sampled_from([1, 1, 1, 2, 70, 3000]))
        text = text[:start] + (part * times)[:100_000] + text[draw(st.sampled_from([start, end])) :]
    return text


@cache
def configs():
    """The smoke config's experiments, one of each kind, each as a config of its own with a figure."""
    from gaspart.reproduction.config import merged_with_default

    whole, _ = merged_with_default(ROOT / "config/smoke.yaml")
    found = {}
    for name, block in whole["experiments"].items():
        point = block["point"]
        kind = block.get("job"), point.get("engine"), "scene" in point, "boxes_per_side" in point
        film = {"film": {"experiment": name, "size": [64, 64], "colour": "speed"}}
        one = {"experiments": {name: block}, "figures": {"radius_grid": {"experiments": [name]}}}
        found[kind] = whole | one | {"animations": {} if "job" in block else film}
    return list(found.values())


SIZES = [1, 2, 3, 7, 100, 10_000, 10**9, 2**31, 2**53, 10**18, 0.5, 0.1, 0.9, 0.3, 1e-3, 1e-9, 1e9]
SIZES += [1e-60, 1e60, 1e-30, 1e30, 1e-20, 1e20, 2.0, 5.0]


@st.composite
def extreme_configs(draw):
    """Configs whose points hold any keys, with values that the schema allows: planning has to refuse them."""
    config = copy.deepcopy(draw(st.sampled_from(configs())))
    (block,) = config["experiments"].values()
    for _ in range(draw(st.integers(1, 4))):
        key = draw(st.sampled_from([*POINT, "count", "radius", "side", "packing_fraction"]))
        values = [draw(_allowed(POINT[key])) for _ in range(2)]
        grid = block.get("grid")
        if isinstance(grid, dict) and draw(st.booleans()):
            grid[key] = values
        else:
            block["point"][key] = values[0]
    return config


@st.composite
def planned_configs(draw):
    """Configs with a coherent point of extreme values: only arithmetic can show that it cannot be run."""
    size, whole = st.sampled_from(SIZES), st.sampled_from([n for n in SIZES if n == int(n)])
    fraction = st.sampled_from([0.5, 0.1, 0.3, 0.9, 1e-3, 1e-9, 1e-30, 1e-60])
    extents = {"count": whole, "radius": size, "packing_fraction": fraction, "side": size}
    extents.pop(draw(st.sampled_from(list(extents))))
    point = {key: draw(values) for key, values in extents.items()} | {
        "dimension": draw(st.sampled_from([2, 3]))
    }
    engine = draw(st.sampled_from(["event", "step", "auto"]))
    length = draw(
        st.sampled_from(["collisions_per_particle", "duration", *(["steps"] if engine == "step" else [])])
    )
    point |= {"engine": engine, length: draw(whole if length == "steps" else size)}
    point[draw(st.sampled_from(["temperature", "speed"]))] = draw(size)
    if engine == "step":
        point["time_step"] = draw(size)
    if engine == "auto":
        point |= {
            "accuracy": draw(fraction),
            "observable": draw(st.sampled_from(["Z", "collision_rate", "D"])),
        }
    elif draw(st.booleans()):
        point[draw(st.sampled_from(["boxes_per_side", "boxes_per_particle"]))] = draw(whole)
    others = {
        "mass": size,
        "equilibration": size,
        "samples": whole,
        "replicas": st.integers(1, 3),
        "follow": whole,
        "lags": whole,
    }
    others |= {"boundary": st.sampled_from(["wall", "periodic"]), "centres_to_walls": st.booleans()}
    for key in draw(st.lists(st.sampled_from(list(others)), max_size=3)):
        point[key] = draw(others[key])
    job = draw(st.sampled_from(["simulate", "measure_cost", "echo", "compare"]))
    figures = {"radius_grid": {"experiments": ["gas"]}}
    experiment = {"job": job, "point": point}
    return {
        "title": "t",
        "seed": 1,
        "points": "results/p",
        "experiments": {"gas": experiment},
        "figures": figures,
    }


def _allowed(rule):
    """Values of the types that a rule names."""
    if "enum" in rule:
        return st.sampled_from(rule["enum"])
    numbers = {"number": SIZES, "integer": [n for n in SIZES if n == int(n)]}
    lists = [st.lists(st.sampled_from(numbers["integer"]), min_size=2, max_size=3)]
    lists += [st.lists(st.sampled_from(SIZES), min_size=2, max_size=3)]
    lists += [st.lists(st.sampled_from(["wall", "periodic"]), min_size=2, max_size=3)]
    kinds = {"boolean": st.booleans(), "null": st.none(), "array": st.one_of(lists)}
    kinds |= {"string": st.sampled_from(["wall", "periodic", "config/scenes/price.yaml"])}
    kinds |= {name: st.sampled_from(values) for name, values in numbers.items()}
    kinds["object"] = st.dictionaries(st.sampled_from(["container", "species"]), st.none() | st.just([]))
    return st.one_of([kinds[name] for name in rule["type"]])


@contextmanager
def within(seconds):
    """Fail if a block takes longer, in processor time: another process may hold this one up. The compilation
    of kernels is not counted."""
    begun, compiling = time.process_time(), []
    with install_timer("numba:compile", compiling.append):
        yield
    taken = time.process_time() - begun - sum(compiling)
    assert taken < seconds, f"{taken:.1f} s"


def one_line(work, *arguments):
    """Whether `work` accepts the arguments; if not it raises SceneError of one line, and in time."""
    with within(LIMIT):
        try:
            work(*arguments)
        except SceneError as error:
            text = str(error)
            assert text.isprintable() and len(text) < 4000, text
            return False
    return True
