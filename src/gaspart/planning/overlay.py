"""A config as the workflow sees it: laid over the full one."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from gaspart.files import read_yaml


def laid_over(path: Path) -> tuple[dict[str, Any], list[Path]]:
    """A config as the workflow sees it, laid over the `config.yaml` beside it, and the files that it is of.

    Raises SceneError for a file that cannot be read.
    """
    path = path.resolve()
    base = path.parent / "config.yaml"
    files = [base, path] if base.exists() and base != path else [path]
    merged: dict[str, Any] = {}
    for file in files:
        _lay_over(merged, read_yaml(file))
    return merged, files


def _lay_over(below: dict[str, Any], above: dict[str, Any]) -> None:
    """Mappings are merged, key by key; anything else is replaced."""
    for key, value in above.items():
        if isinstance(value, dict) and isinstance(below.get(key), dict):
            _lay_over(below[key], value)
        else:
            below[key] = value
