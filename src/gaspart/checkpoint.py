"""The float64 state of an unfinished run, in a file that appears whole or not at all."""

from __future__ import annotations

import hashlib
import os
import zipfile
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

_DIGEST, _FRAMES = "trajectory header", "trajectory frames"


@dataclass(frozen=True)
class Checkpoint:
    """frames: how many frames of the trajectory were complete; arrays: for `Simulation.restore`."""

    frames: int
    arrays: dict[str, np.ndarray]


def checkpoint_path(path: Path) -> Path:
    """Where the float64 state of an unfinished trajectory is."""
    return path.with_name(path.name + ".checkpoint.npz")


def _digest(header: bytes) -> str:
    return hashlib.sha256(header).hexdigest()


def _new(path: Path) -> Path:
    return path.with_name(path.name + ".new")


def remove_checkpoint(path: Path) -> None:
    """Remove a checkpoint that has served, and what a kill may have left of its successor."""
    path.unlink(missing_ok=True)
    _new(path).unlink(missing_ok=True)


def write_checkpoint(path: Path, header: bytes, frames: int, arrays: dict[str, Any]) -> None:
    """Write the checkpoint of a run, which the header of its trajectory stands for. May raise OSError."""
    new = _new(path)
    try:
        with new.open("wb") as file:
            parts: dict[str, Any] = {_DIGEST: np.array(_digest(header)), _FRAMES: np.array(frames)}
            np.savez(file, **arrays, **parts)
            file.flush()
            os.fsync(file.fileno())
        os.replace(new, path)
    except OSError:
        new.unlink(missing_ok=True)
        raise


def read_checkpoint(path: Path, header: bytes) -> Checkpoint | None:
    """The checkpoint of the run that this header stands for, or None if there is none."""
    try:
        with np.load(path, allow_pickle=False) as file:
            arrays = {key: file[key] for key in file.files}
        digest, frames = str(arrays.pop(_DIGEST)), int(arrays.pop(_FRAMES))
    except (OSError, ValueError, KeyError, EOFError, zipfile.BadZipFile):
        return None
    return Checkpoint(frames, arrays) if digest == _digest(header) else None
