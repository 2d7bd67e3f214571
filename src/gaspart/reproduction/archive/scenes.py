"""The scene files that a config names."""

from __future__ import annotations

import posixpath
from typing import Any


def scene_files(config: Any) -> list[str]:
    """Paths of the scene files of all experiments of a merged config, each once, without "./" and the like.

    They are the values of `scene` in a point and in a grid; anything else under that key is left to the
    validation of configs.
    """
    found: dict[str, None] = {}
    blocks = [config.get("experiments") if isinstance(config, dict) else None]
    while blocks:
        block = blocks.pop()
        if isinstance(block, dict):
            named = block.get("scene")
            for name in named if isinstance(named, list) else [named]:
                if isinstance(name, str):
                    found[posixpath.normpath(name)] = None
            blocks += block.values()
        elif isinstance(block, list):
            blocks += block
    return list(found)
