"""SHA-256 digests of files, of the numbers in a trajectory, and of sets of files."""

from __future__ import annotations

import hashlib
from bisect import bisect_left as bisect
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import IO

from gaspart.trajectory.opening import open_netcdf_file

_CHUNK = 1 << 20
_CHECKSUM = "checksum"
"""Variable of a trajectory that depends on the file's header, and therefore on versions and git revision."""


def digest(file: IO[bytes], copy: IO[bytes] | None = None) -> str:
    """Compute the digest of the rest of an open file, which is also written to `copy`."""
    total = hashlib.sha256()
    while data := file.read(_CHUNK):
        total.update(data)
        if copy is not None:
            copy.write(data)
    return total.hexdigest()


def digest_of_file(path: Path) -> str:
    """Return the digest of a file; may raise OSError."""
    with path.open("rb") as file:
        return digest(file)


def digest_of_numbers(path: Path) -> str:
    """Compute the digest of the names, types, shapes and bytes of a trajectory's variables. Equal bits have
    equal digests, even if the attributes state different versions and git revisions. Raises SceneError for a
    file that is no trajectory of gaspart.
    """
    total = hashlib.sha256()
    with open_netcdf_file(path) as file:
        file.set_auto_mask(False)
        for name in sorted(file.variables.keys() - {_CHECKSUM}):
            values = file.variables[name][...]
            values = values.astype(values.dtype.newbyteorder("<"))
            total.update(f"{name} {values.dtype.str} {values.shape}\n".encode())
            total.update(values.tobytes())
    return total.hexdigest()


def joint_digest(paths: Iterable[str], digests: Mapping[str, str]) -> str:
    """Compute a joint digest of lines "<digest> <path>" in order; a folder stands for its files in
    `digests`.
    """
    files: set[str] = set()
    names = sorted(digests)
    for path in paths:
        # in the order of characters, "0" follows "/"
        below = names[bisect(names, f"{path}/") : bisect(names, f"{path}0")]
        if path not in digests and not below:
            raise KeyError(path)
        files.update([path] if path in digests else below)
    return hashlib.sha256(
        "".join(f"{digests[name]}  {name}\n" for name in sorted(files)).encode()
    ).hexdigest()
