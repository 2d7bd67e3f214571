"""The folder in which compiled kernels are kept."""

from __future__ import annotations

import os
import stat
import tempfile
import warnings
from pathlib import Path

_REMEDY = "set GASPART_CACHE to a writable folder"


def cache_directory() -> Path:
    """$GASPART_CACHE, or the folder gaspart in $XDG_CACHE_HOME or ~/.cache.

    Raises RuntimeError where neither is set and the user has no home.
    """
    chosen = os.environ.get("GASPART_CACHE")
    if chosen:
        return Path(chosen)
    return Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "gaspart"


def usable_cache(version: str) -> Path | None:
    """The folder `version` of the cache, made if it is missing.

    It is a temporary one, with a warning, for a user without a cache folder that can be written to. None,
    also with a warning, where that cannot be written either, or $GASPART_CACHE cannot.
    """
    try:
        wanted: Path | None = cache_directory() / version
    except RuntimeError:
        wanted = None
    if wanted and _is_writable(wanted):
        return wanted
    why = f"cannot write the kernel cache {wanted}" if wanted else "there is no home for the kernel cache"
    found = None if os.environ.get("GASPART_CACHE") else _temporary(version)
    instead = f"using {found}" if found else "compiling anew in every process"
    warnings.warn(f"gaspart: {why}; {instead} ({_REMEDY})", stacklevel=3)
    return found


_reported: set[Path] = set()


def report_unwritable(directory: Path, error: OSError) -> None:
    """Warn, once in a process, that compiled kernels cannot be kept: on a full disk, for example."""
    if directory not in _reported:
        _reported.add(directory)
        why = f"cannot write the kernel cache {directory}: {error.strerror}"
        warnings.warn(f"gaspart: {why}; compiling anew in every process ({_REMEDY})", stacklevel=3)


def _is_writable(directory: Path) -> bool:
    try:
        directory.mkdir(parents=True, exist_ok=True)
    except OSError:
        return False
    return os.access(directory, os.W_OK)


def _temporary(version: str) -> Path | None:
    """A temporary folder that only this user may write to, so that no other places machine code in it."""
    try:
        own = Path(tempfile.gettempdir()) / f"gaspart-{os.getuid()}"
        own.mkdir(mode=0o700, exist_ok=True)
        found = own.lstat()
    except OSError:
        return None
    private = stat.S_ISDIR(found.st_mode) and found.st_uid == os.getuid() and not found.st_mode & 0o022
    return own / version if private and _is_writable(own / version) else None
