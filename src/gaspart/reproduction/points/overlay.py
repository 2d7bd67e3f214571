"""A config merged over the full one, as the workflow uses it."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from gaspart.errors import SceneError
from gaspart.files import resolved
from gaspart.yaml_text import read_yaml


def laid_over(path: Path, base: Path | None = None) -> tuple[dict[str, Any], list[Path]]:
    """A config merged over another, as the workflow does, and the files it consists of.

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
