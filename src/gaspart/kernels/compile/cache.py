"""The folder in which compiled kernels are kept."""

from __future__ import annotations

import os
import stat
import tempfile
import warnings
from pathlib import Path

from gaspart.system import is_private, user

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

    It is a temporary one, with a warning, for a user without a cache folder that this user, and no other, can
    write to. None, also with a warning, where that cannot be written either, or $GASPART_CACHE cannot.
    """
    try:
        wanted: Path | None = cache_directory() / version
    except RuntimeError:
        wanted = None
    why = obstacle(wanted) if wanted else "there is no home for the kernel cache"
    if not why:
        return wanted
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


def obstacle(directory: Path) -> str:
    """Why kernels are not to be kept in a folder, which is made if it is missing; "" if they are."""
    try:
        directory.parent.mkdir(parents=True, exist_ok=True)
        directory.mkdir(mode=0o700, exist_ok=True)
        private = _is_private(directory.stat())
    except OSError:
        private = True
    if not private:
        return f"others may write to the kernel cache {directory}"
    return "" if os.access(directory, os.W_OK) else f"cannot write the kernel cache {directory}"


def _is_private(found: os.stat_result) -> bool:
    """Whether a folder is one that only this user may write to: no other places machine code in it."""
    return stat.S_ISDIR(found.st_mode) and is_private(found)


def _temporary(version: str) -> Path | None:
    """A folder of this user in the one for temporary files, where others may have made it before."""
    try:
        own = Path(tempfile.gettempdir()) / f"gaspart-{user()}"
        own.mkdir(mode=0o700, exist_ok=True)
        private = _is_private(own.lstat())
    except OSError:
        return None
    return own / version if private and not obstacle(own / version) else None
