"""What a file has to say about the program that made it."""

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
    """What git says about the folder of this package; None where there is no git, or it refuses.

    Raises OSError if it could not be asked, for want of file descriptors or memory: what is stored in a
    trajectory must not depend on that.
    """
    command = ["git", "-C", str(Path(__file__).parent), *arguments]
    try:
        done = subprocess.run(command, capture_output=True, text=True, env={**os.environ, "LC_ALL": "C"})
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
    """The commit of the checkout that the package runs from, `-modified` if edited since; "" outside of one.

    A package that is merely installed below somebody's repository is not tracked there, and has none.
    """
    if _git("ls-files", "--error-unmatch", Path(__file__).with_name("__init__.py").name) is None:
        return ""
    return _git("describe", "--always", "--abbrev=40", "--exclude=*", "--dirty=-modified") or ""


@cache
def versions() -> dict[str, str]:
    """Versions of gaspart, Python, and the packages that results depend on. May raise OSError."""
    found = {"gaspart_version": __version__, "python_version": platform.python_version()}
    for package in _PACKAGES:
        try:
            found[f"{package}_version"] = version(package)
        except PackageNotFoundError:
            os.scandir(Path(__file__).parent).close()  # OSError where a folder could not be searched either
            found[f"{package}_version"] = "unknown"
    return found
