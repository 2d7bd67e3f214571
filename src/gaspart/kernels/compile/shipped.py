"""Kernels that come with the package: machine code that was compiled when its wheel was made.

It is for every processor of the level x86-64-v3. A path has the digest of the sources and one of the release
of numba, the function and the types of its arguments, and the version of Python: a file for anything else is
not found. The list of the files has their sha256. It is as trustworthy as the package's modules, which stand
beside it, and what does not agree with it is never read as code.
"""

from __future__ import annotations

import hashlib
import json
from functools import cache
from pathlib import Path

FOLDER = Path(__file__).parents[1] / "shipped"
LIST = "sha256.json"
PROCESSOR = "x86-64-v3"
FEATURES = (
    "+avx,+avx2,+bmi,+bmi2,+cx16,+f16c,+fma,+lzcnt,+movbe,+popcnt,+sahf,+sse3,+sse4.1,+sse4.2,+ssse3,+xsave"
)
"""What the level x86-64-v3 requires of a processor, in the words of LLVM."""


def shipped_key(key: tuple) -> tuple | None:
    """The key of a kernel that this package may bring, from that of one for this processor: types of
    arguments, processor, digest of the bytecode. None where the processor lacks what such a kernel uses."""
    types, (system, _, features), bytecode = key
    if not set(FEATURES.split(",")) <= set(features.split(",")):
        return None
    return types, (system, PROCESSOR, FEATURES), bytecode


def shipped_content(path: str) -> bytes | None:
    """The content of a file, by its path in the folder. None where it is not listed, is missing, or differs
    from what the list states."""
    expected = _digests().get(path)
    if expected is None:
        return None
    try:
        content = (FOLDER / path).read_bytes()
    except OSError:
        return None
    return content if hashlib.sha256(content).hexdigest() == expected else None


@cache
def _digests() -> dict[str, str]:
    """The sha256 of each file, by its path; none in a copy of the repository, which has no kernels."""
    try:
        listed = json.loads((FOLDER / LIST).read_bytes())
    except (OSError, ValueError, RecursionError):
        return {}
    return listed if isinstance(listed, dict) else {}
