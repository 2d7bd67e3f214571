"""The files that a config consists of: merged as by Snakemake, and which of them holds a key."""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import suppress
from pathlib import Path
from typing import Any

from gaspart.errors import SceneError
from gaspart.files import resolved
from gaspart.yaml_text import is_exponential, read_yaml


def merged_with_default(path: Path, base: Path | None = None) -> tuple[dict[str, Any], list[Path]]:
    """A config merged over another, as by the workflow, and the files that it consists of.

    base: the other one, by default the `config.yaml` beside it. Raises SceneError for a file that cannot be
    read.
    """
    path = resolved(path)
    base = path.parent / "config.yaml" if base is None else resolved(base)
    files = [base, path] if base.exists() and base != path else [path]
    merged: dict[str, Any] = {}
    for file in files:
        content = read_yaml(file)
        if not isinstance(content, dict):
            raise SceneError("config", content, "must be a mapping of keys to values", str(file))
        merged = _merged(merged, content)
    return merged, files


def _merged(below: dict[str, Any], above: dict[str, Any]) -> dict[str, Any]:
    """Mappings are merged, key by key; anything else is replaced."""
    both = {key: value for key, value in above.items() if isinstance(value, dict)}
    both = {key: value for key, value in both.items() if isinstance(below.get(key), dict)}
    return {**below, **above, **{key: _merged(below[key], value) for key, value in both.items()}}


def read_numbers(config: dict, files: Sequence[str | Path]) -> None:
    """Change numbers such as 1e3, which Snakemake's reader takes for text, into numbers, in a merged config.

    files: those that were merged, in that order; what is in quotes there stays text. Raises SceneError for a
    file that cannot be read.
    """
    _read_numbers(config, [read_yaml(file) for file in files])


def _read_numbers(block: Any, held: list[Any]) -> None:
    """held: what the files have in this place."""
    for key, value in block.items() if isinstance(block, dict) else enumerate(block):
        below = []
        for part in held:
            with suppress(LookupError, TypeError):  # where this file has something else, or nothing
                below.append(part[key])
        if isinstance(value, dict | list):
            _read_numbers(value, below)
        elif isinstance(value, str) and is_exponential(value) and value not in below:
            block[key] = float(value)


def origin(key: str, config: dict, contents: list[tuple[str, Any]]) -> str | None:
    """The last of the files, given with their contents, that holds the longest part of ``key``; or the option
    of Snakemake, for a value that is in none of them."""
    parts = key.replace("[", ".").split(".")
    dotted = parts.index("scene") if "scene" in parts else len(parts)  # `scene.` and what follows is one key
    parts[dotted:] = [".".join(parts[dotted:])]

    def held(block: Any) -> tuple[int, Any]:
        reached = 0
        for part in parts:
            if not isinstance(block, dict) or part not in block:
                break
            block, reached = block[part], reached + 1
        return reached, block

    depth, value = held(config)
    if contents and depth and not isinstance(value, dict):
        # in their written form, in which nan is equal to itself
        if repr((depth, value)) not in [repr(held(content)) for _, content in contents]:
            return "--config"
    return max(reversed(contents), key=lambda content: held(content[1])[0])[0] if contents else None
