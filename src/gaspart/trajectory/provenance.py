"""Provenance of a file: versions, and git revision of the program that wrote it."""

from __future__ import annotations

import errno
import os
import platform
import subprocess
from functools import cache
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

from gaspart import __version__

_PACKAGES = ("numpy", "numba", "netCDF4")


def _git(*arguments: str) -> str | None:
    """Return the output of a git command in the folder of this package, or None. Optional locks of git are
    disabled, because a process of git that is killed would leave `.git/index.lock`, which blocks later
    commits. The command `git describe --dirty` is not used, because its lock is not optional. OSError is
    raised if git could not be started for lack of file descriptors or memory, because the contents of a
    trajectory must not depend on this.
    """
    command = ["git", "-C", str(Path(__file__).parent), *arguments]
    environment = {**os.environ, "LC_ALL": "C", "GIT_OPTIONAL_LOCKS": "0"}
    try:
        done = subprocess.run(command, capture_output=True, text=True, env=environment)
    except (FileNotFoundError, PermissionError):
        return None
    if done.returncode == 0:
        return done.stdout.strip()
    for number in (errno.EMFILE, errno.ENFILE, errno.ENOMEM, errno.EAGAIN):
        if os.strerror(number) in done.stderr:
            raise OSError(number, os.strerror(number))
    return None


@cache
def git_revision() -> str:
    """Return the commit of the git checkout that contains this package; "" without a checkout. The suffix
    `-modified` is appended if files were changed after the commit.
    """
    if _git("ls-files", "--error-unmatch", Path(__file__).with_name("__init__.py").name) is None:
        return ""
    commit, edited = _git("rev-parse", "HEAD"), _git("status", "--porcelain", "--untracked-files=no")
    if commit is None or edited is None:
        return ""
    return f"{commit}-modified" if edited else commit


@cache
def versions() -> dict[str, str]:
    """Return the versions of gaspart, Python, and the packages that results depend on. May raise OSError."""
    attributes = {"gaspart_version": __version__, "python_version": platform.python_version()}
    for package in _PACKAGES:
        try:
            attributes[f"{package}_version"] = version(package)
        except PackageNotFoundError:
            os.scandir(Path(__file__).parent).close()  # OSError if a folder could not be searched, too
            attributes[f"{package}_version"] = "unknown"
    return attributes
