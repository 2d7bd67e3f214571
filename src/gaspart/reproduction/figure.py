"""Parts of a figure, averages over blocks with errors, and the key of what was measured."""

from __future__ import annotations

import hashlib
import json
import sys
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from functools import cache
from importlib import import_module
from importlib.util import module_from_spec, spec_from_file_location
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np

from gaspart.analysis.estimate import Estimate
from gaspart.analysis.statistics import jackknife
from gaspart.keys import Kind


@dataclass(frozen=True)
class Parts:
    """The parts of a figure: the settings of its config entry, and three functions.

    measure(points, settings) returns the data set, claims(dataset) its claims, draw(dataset) the picture.
    `key` is the number of the panel that shows the finding; None if it is the whole picture.
    """

    settings: dict[str, Kind]
    measure: Callable[..., Any]
    claims: Callable[..., Iterable[Any]]
    draw: Callable[..., Any]
    key: int | None = 0


@cache
def load_module(module: str) -> ModuleType:
    """Return a module by its import name, or by its path, which ends in .py."""
    if not module.endswith(".py"):
        return import_module(module)
    spec = spec_from_file_location(module, module)
    assert spec is not None and spec.loader is not None
    sys.modules[module] = loaded = module_from_spec(spec)  # where dataclasses look for it
    spec.loader.exec_module(loaded)
    return loaded


def find_parts(module: str, name: str) -> Parts:
    """Return the parts of a figure, or of a kind of figures, in a module."""
    loaded = load_module(module)
    parts = {**getattr(loaded, "KINDS", {}), **getattr(loaded, "FIGURES", {})}.get(name)
    if isinstance(parts, Parts):
        return parts
    folder = (import_module(f"{module}.{part}") for part in ("measure", "claims", "figure"))
    return Parts(parts or {}, *(getattr(part, name) for part in folder))


def content_key(paths: Iterable[str | Path], *stated: Any) -> str:
    """Return a digest of files, of those in folders too, and of plain values.

    A data set with this key was made from the same content: it need not be measured again.
    """
    key = hashlib.sha256(json.dumps(stated).encode())
    for path in map(Path, paths):
        for file in sorted(path.rglob("*.nc")) if path.is_dir() else [path]:
            with file.open("rb") as content:
                key.update(hashlib.file_digest(content, "sha256").digest())
    return key.hexdigest()


class Blocks:
    """Averages over independent blocks; a call returns a function of the means with its jackknife error.

    Each block is a tuple of numbers or arrays, which are the arguments of the function.
    """

    def __init__(self, blocks: Iterable[tuple]) -> None:
        self._series = [np.array(series) for series in zip(*blocks, strict=True)]

    def __call__(self, function: Callable[..., Any]) -> Estimate:
        """Return a function of the means with its error."""
        value, error = jackknife(function, *self._series)
        return Estimate(value, error, len(self._series[0]) - 1)
