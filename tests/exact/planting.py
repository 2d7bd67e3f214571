"""Errors planted in functions of gaspart, in memory: a replaced piece of source, compiled and swapped in.

The code of the functions that change is exchanged in place, so that all modules that have imported them call
the planted one. A piece that is not in the source exactly once is an error: a plant cannot fail silently.
"""

import importlib
import types
from contextlib import contextmanager
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path


@dataclass(frozen=True)
class Plant:
    """A planted error and the cell that must catch it.

    module: below `gaspart.`; old, new: the piece of source, with as many lines; cell: of the exact table
    (scene, observable), or with an engine (scene, observable, engine), or of the battery (symmetry, scene,
    observable) if `battery`.
    """

    name: str
    module: str
    old: str
    new: str
    cell: tuple[str, ...]
    battery: bool = False


class NotPlanted(AssertionError):
    """A piece of source that is not there once, or changes no function."""


@contextmanager
def planted(plant):
    """Exchange the code of the functions that a plant changes; restore it at the end."""
    module = importlib.import_module(f"gaspart.{plant.module}")
    path = Path(module.__file__)
    source = path.read_text(encoding="utf-8")
    if source.count(plant.old) != 1 or plant.old.count("\n") != plant.new.count("\n"):
        raise NotPlanted(f"{plant.name}: {source.count(plant.old)} times in {path.name}: {plant.old!r}")
    before = _codes(compile(source, str(path), "exec"))
    after = _codes(compile(source.replace(plant.old, plant.new), str(path), "exec"))
    changed = {name: code for name, code in after.items() if before.get(name) != code}
    functions = {name: _function(module, name) for name in changed}
    if not changed:
        raise NotPlanted(f"{plant.name}: no function changes")
    kept = {name: function.__code__ for name, function in functions.items()}
    try:
        for name, function in functions.items():
            function.__code__ = changed[name]
        yield
    finally:
        for name, function in functions.items():
            function.__code__ = kept[name]


def _codes(code):
    """Return the code of the functions of a module and of the methods of its classes, by qualified name."""
    found = {}
    for constant in code.co_consts:
        if isinstance(constant, types.CodeType) and "<" not in constant.co_name:
            if constant.co_flags & 2:  # a function, with fast locals
                found[constant.co_qualname] = constant
            else:
                found |= _codes(constant)
    return found


def _function(module, name):
    """Return the function object of a qualified name, below decorators."""
    thing = module
    for part in name.split("."):
        thing = vars(thing)[part]
    if isinstance(thing, property):
        thing = thing.fget
    elif isinstance(thing, cached_property):
        thing = thing.func
    elif isinstance(thing, (staticmethod, classmethod)):
        thing = thing.__func__
    while hasattr(thing, "__wrapped__"):
        thing = thing.__wrapped__
    return thing
