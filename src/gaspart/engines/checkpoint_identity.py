"""Identity of a checkpoint: the simulation to which it belongs.

It decides whether the checkpoint may be restored.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping
from typing import Any

import numpy as np

from gaspart import __version__
from gaspart.engines.engine import Engine, engine_to_dict
from gaspart.errors import SceneError
from gaspart.scene.scene import Scene
from gaspart.state.state import State


def checkpoint_identity(
    scene: Scene, engine: Engine, seed: int | tuple[int, ...], initial: State | None = None
) -> dict[str, np.ndarray]:
    """Return texts of all that the results of a simulation depend on, by checkpoint keys.

    initial : state at time 0, if it does not follow from the scene and the seed
    """
    settings = {key: x for key, x in engine_to_dict(engine).items() if key not in engine.neutral_settings}
    texts = {
        "version": __version__,
        "scene": hashlib.sha256(_text(scene.to_dict()).encode()).hexdigest(),
        "engine": _text(settings),
        "seed": _text(seed),
        "initial state": _digest(initial),
    }
    return {f"of_{key}": np.array(text) for key, text in texts.items()}


def _digest(state: State | None) -> str:
    if state is None:
        return "of the seed"
    moving = state.piston, state.displaced, state.vibrations
    parts = state.positions, state.velocities, state.spins, *moving
    there = (np.ascontiguousarray(part).tobytes() for part in parts if part is not None)
    return hashlib.sha256(b"".join(there)).hexdigest()


def _text(value: object) -> str:
    return json.dumps(value, sort_keys=True, default=int)  # a seed may be an integer of numpy


def check_identity(checkpoint: Any, identity: Mapping[str, np.ndarray]) -> None:
    """Raise SceneError, which names the difference, unless a checkpoint has this `identity`."""
    if not isinstance(checkpoint, Mapping) or not all(key in checkpoint for key in identity):
        raise SceneError("checkpoint", checkpoint, "must be what Simulation.checkpoint has returned")
    for key, text in identity.items():
        if str(checkpoint[key]) != str(text):
            subject = key.removeprefix("of_")
            this = "" if subject == "scene" else f", which has {text}"
            rule = f"is of another {subject} than this simulation{this}"
            raise SceneError("checkpoint", str(checkpoint[key]), rule)


def check_parts(parts: Mapping[str, np.ndarray], expected: Mapping[str, np.ndarray]) -> None:
    """Raise SceneError unless a checkpoint has all `expected` arrays.

    Each array must have the shape and the kind of number of the expected array.
    """
    for key, array in expected.items():
        value = parts.get(key)
        alike = isinstance(value, np.ndarray) and value.shape == np.shape(array)
        if not alike or value.dtype.kind != np.asarray(array).dtype.kind:  # type: ignore[union-attr]
            raise SceneError("checkpoint", key, "is missing or of another form: the checkpoint is damaged")
