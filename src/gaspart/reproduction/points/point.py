"""A point of a grid: its name, its paths, and its seeds, which follow from the name."""

from __future__ import annotations

import hashlib
import re
from dataclasses import asdict, dataclass

from gaspart.errors import SceneError

_LONGEST_NAME = 200  # of the 255 bytes of a file name, with which suffixes and names of logs are made


@dataclass(frozen=True)
class Point:
    """One point of a grid: one job of the workflow, with one output at ``path``."""

    experiment: str
    name: str
    job: str
    settings: dict
    root: str
    config_seed: int

    @property
    def path(self) -> str:
        """Where the result lies: a folder of trajectories (``simulate``) or one netCDF file."""
        suffix = "" if self.job == "simulate" else ".nc"
        return f"{self.root}/{self.experiment}/{self.name}{suffix}"

    @property
    def replicas(self) -> int:
        """Number of independent runs of this point."""
        return self.settings.get("replicas", 1)

    def replica_path(self, replica: int) -> str:
        """The trajectory of one replica (``simulate`` only)."""
        return f"{self.path}/replica-{replica}.nc"

    @property
    def replica_paths(self) -> list[str]:
        """The trajectories of all replicas, in order."""
        return [self.replica_path(k) for k in range(self.replicas)]

    def seed(self, replica: int = 0) -> tuple[int, ...]:
        """Four 32-bit words that depend on the names alone, not on the point's place in its grid."""
        text = f"{self.config_seed}/{self.experiment}/{self.name}/{replica}"
        digest = hashlib.sha256(text.encode()).digest()
        return tuple(int.from_bytes(digest[i : i + 4], "little") for i in range(0, 16, 4))

    def to_dict(self) -> dict:
        """Plain values only: the parameters of a job."""
        return asdict(self)

    @classmethod
    def from_dict(cls, values: dict) -> Point:
        """The inverse of ``to_dict``."""
        return cls(**values)


def name_of(varying: dict, where: str) -> str:
    """The name of a point, fit for a file system: its varying keys and their values.

    Raises SceneError, naming the key below ``where``, for a value that no file name can hold, and a name that
    is too long.
    """
    parts = [f"{_text(key, where)}={_text(value, f'{where}.{key}')}" for key, value in varying.items()]
    name = ",".join(parts) or "single"
    if len(name) > _LONGEST_NAME:
        raise SceneError(where, name, f"the name of a point may have {_LONGEST_NAME} characters")
    return name


def _text(value: object, where: str) -> str:
    if isinstance(value, (list, tuple)):
        return "x".join(_text(item, where) for item in value)
    text = str(value).lower() if isinstance(value, bool) or value is None else str(value)
    if not re.fullmatch(r"[A-Za-z0-9_.+-]+", text):
        raise SceneError(where, value, "a value that names a point may hold letters, digits and _ . + - only")
    return text
