"""SHA-256 digests of files, of the numbers in a trajectory, and of sets of files."""

from __future__ import annotations

import hashlib
from bisect import bisect_left as bisect
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import IO

from gaspart.trajectory.opening import opened

_CHUNK = 1 << 20
_CHECKSUM = "checksum"
"""The variable of a trajectory that depends on the file's header, and so on versions and git revision."""


def digest(file: IO[bytes], copy: IO[bytes] | None = None) -> str:
    """The digest of what is left of an open file, which is written to `copy` on the way, if given."""
    total = hashlib.sha256()
    while data := file.read(_CHUNK):
        total.update(data)
        if copy is not None:
            copy.write(data)
    return total.hexdigest()


def digest_of_file(path: Path) -> str:
    """The digest of a file. May raise OSError."""
    with path.open("rb") as file:
        return digest(file)


def digest_of_numbers(path: Path) -> str:
    """The digest of a trajectory's variables: equal for equal bits, whatever versions and git revision its
    attributes state. Raises SceneError for a file that is no trajectory of gaspart.

    Each variable contributes its name, type, shape and bytes, in the order of the names.
    """
    total = hashlib.sha256()
    with opened(path) as file:
        file.set_auto_mask(False)
        for name in sorted(file.variables.keys() - {_CHECKSUM}):
            values = file.variables[name][...]
            values = values.astype(values.dtype.newbyteorder("<"))
            total.update(f"{name} {values.dtype.str} {values.shape}\n".encode())
            total.update(values.tobytes())
    return total.hexdigest()


def joint_digest(paths: Iterable[str], known: Mapping[str, str]) -> str:
    """The digest of a set of files: of the lines "<digest>  <path>" in the order of the paths.

    paths: files, or folders, which stand for all `known` files in them; known: the digest of each file.
    Raises KeyError for a path that is neither.
    """
    lines: set[str] = set()
    names = sorted(known)
    for path in paths:
        below = slice(bisect(names, f"{path}/"), bisect(names, f"{path}0"))  # "0" comes after "/"
        files = [path] if path in known else names[below]
        if not files:
            raise KeyError(path)
        lines |= {f"{name}\0{known[name]}" for name in files}
    ordered = (line.split("\0") for line in sorted(lines))
    return hashlib.sha256("".join(f"{value}  {name}\n" for name, value in ordered).encode()).hexdigest()
