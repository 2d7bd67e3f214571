"""Command-line options for declared settings of engines and of trajectory files."""

from __future__ import annotations

import argparse
from collections.abc import Iterable, Mapping
from functools import cache
from typing import Any

from gaspart.cli.arguments import alone, several
from gaspart.engines import ENGINES
from gaspart.errors import SceneError, short_repr
from gaspart.keys import Kind, describe, schema_of


@cache
def engine_settings() -> dict[str, Kind]:
    """Return the settings of all engines by name; descriptions list the engines that have them."""
    settings: dict[str, Kind] = {}
    for name, engine in ENGINES.items():
        for key, kind in schema_of(engine)["properties"].items():
            meaning = f"{name} engine: {kind['description']}"
            previous = settings.get(key)
            settings[key] = describe(kind, f"{previous['description']}; {meaning}" if previous else meaning)
    return settings


def add_setting(group: argparse._ArgumentGroup, name: str, kind: Kind) -> None:
    """Add the option of a setting: a number, a word, a text, or a flag. The option of a boolean setting is a
    flag that inverts the default.
    """
    option, meaning, default = name.replace("_", "-"), kind["description"], kind.get("default")
    usual = "" if default is None else f"; default: {default}"
    types = kind.get("type", ())
    if types == "boolean":
        option, action = (f"no-{option}", "store_false") if default else (option, "store_true")
        meaning = f"switches off: {meaning}" if default else meaning
        group.add_argument(f"--{option}", dest=name, action=action, default=None, help=meaning)
    elif "enum" in kind:
        words = one_of(choice for choice in kind["enum"] if choice is not None)
        group.add_argument(f"--{option}", metavar="NAME", help=f"{meaning}: {words}{usual}")
    elif types == "string":
        group.add_argument(f"--{option}", dest=name, metavar=kind["title"], help=f"{meaning}{usual}")
    else:
        sides = "array" in types
        read: Any = _sides if sides else int if "integer" in types else float
        metavar = "N[,N...]" if sides else "N" if read is int else "X"
        group.add_argument(f"--{option}", type=read, metavar=metavar, help=f"{meaning}{usual}")


def _sides(text: str) -> int | tuple[int, ...]:
    return alone(several(int)(text))


def one_of(words: Iterable[str]) -> str:
    """Join words to a text such as "a, b or c"."""
    *first, last = words
    return f"{', '.join(first)} or {last}" if first else last


def as_option(error: SceneError, engine: str) -> str:
    """Return the text of an error, with command-line options instead of engine settings."""
    name = error.key.removeprefix("engine.")
    option = {"name": "--engine", "rewind": "--no-rewind"}.get(name, f"--{name.replace('_', '-')}")
    rule = f"has no meaning with --engine {engine}" if "unknown key" in error.rule else error.rule
    return f"{option}: {'is required' if error.value is None else f'{short_repr(error.value)}: {rule}'}"


def changed_options(kinds: Mapping[str, Kind], settings: Mapping[str, Any]) -> list[str]:
    """Return the options for all settings that differ from their defaults. `kinds` contains the kinds of the
    settings. The result always includes the options of settings without a default.
    """
    options: list[str] = []
    for name, kind in kinds.items():
        value, option = settings.get(name), name.replace("_", "-")
        if isinstance(value, bool):
            if value != kind["default"]:
                options.append(f"--no-{option}" if kind["default"] else f"--{option}")
        elif value is not None:
            options += [f"--{option}", value if isinstance(value, str) else join_numbers(value)]
    return options


def join_numbers(numbers: float | tuple[int, ...] | list[int]) -> str:
    """Format numbers in the form that an option accepts."""
    return ",".join(map(repr, numbers)) if isinstance(numbers, tuple | list) else repr(numbers)
