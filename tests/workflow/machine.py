"""This machine as others find it: without root's rights, without a network, with a disk that fills."""

import os
import subprocess
import tempfile
from contextlib import contextmanager
from pathlib import Path

NOBODY = 65534
# Whoever runs the tests, but without root's right to write to what is read-only.
WITHOUT_RIGHTS = (
    ["unshare", "--user", "--map-user=1000", "--map-group=1000"] if os.geteuid() == 0 else ["env"]
)
OFFLINE = ["unshare", "--user", "--map-current-user", "--net"]
OWN_DISKS = ["unshare", "--map-root-user", "--mount"]


def why_not(isolated):
    """Why a command cannot be isolated so here; None if it can."""
    try:
        done = subprocess.run([*isolated, "true"], capture_output=True, text=True)
    except FileNotFoundError:
        return f"there is no {isolated[0]} here"
    return f"{' '.join(isolated)} is not permitted here: {done.stderr.strip()}" if done.returncode else None


def ordinary_user():
    """What tells subprocess to run a command as a user without root's rights: nobody, or whoever this is."""
    root = os.geteuid() == 0
    return {"user": NOBODY, "group": NOBODY, "extra_groups": []} if root else {}


@contextmanager
def folder_of_user():
    """A new folder that belongs to this user; those of pytest are for its own alone."""
    with tempfile.TemporaryDirectory(prefix="gaspart ") as folder:
        give(Path(folder))
        yield Path(folder)


def give(path):
    """Let the ordinary user own a folder and all that is in it."""
    if os.geteuid() == 0:
        for inner in (path, *path.rglob("*")):
            os.chown(inner, NOBODY, NOBODY, follow_symlinks=False)
