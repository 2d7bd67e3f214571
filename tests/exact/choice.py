"""A sample of the runs for `make test`, chosen by the sources of gaspart: the same for all at one commit."""

import hashlib
import random
import subprocess
from functools import cache
from pathlib import Path

from battery.kinds_of_runs import canonical_kernels, kernels_of
from exact.kinds import kinds
from exact.runs import engines

import gaspart
from gaspart.kernels.compile.sources import file_digests
from gaspart.scene.scene import Scene

ENGINES = {"event": ("event", "obstacles"), "step": ("step",), "dsmc": ("dsmc",), "enskog": ("dsmc",)}
"""Folders of the sources of an engine."""


def is_canonical(scene, engine="event"):
    """Return True if `make test` compiles the kernels of a run anyway."""
    kind = kinds()[scene]
    content = Scene.from_dict(kind.scene)
    sizes = {one.radius for one in content.kinds}
    if "impulses" in kind.run or (len(sizes) > 1 and not all(content.container.periodic)):
        return False  # sums of impulses, and of the areas of the sizes between walls
    return kernels_of(engines(scene)[engine], content) in canonical_kernels()


def chosen(items, number):
    """Return some of the items."""
    sources = sorted(Path(gaspart.__file__).parent.rglob("*.py"))
    seed = hashlib.sha256("".join(file_digests(sources)).encode()).hexdigest()
    return random.Random(seed).sample(items, min(number, len(items)))


@cache
def touched_engines():
    """Return the engines that the last commit or the working tree changes; none without git."""
    command = ["git", "diff", "--name-only", "HEAD~1", "--", "src/gaspart/engines", "src/gaspart/kernels"]
    try:
        found = subprocess.run(
            command, capture_output=True, text=True, check=True, cwd=Path(__file__).parents[2]
        ).stdout
    except (OSError, subprocess.CalledProcessError):
        return ()
    folders = {part for line in found.splitlines() for part in Path(line).parts}
    return tuple(engine for engine, names in ENGINES.items() if folders.intersection(names))


def sample(runs, number, more):
    """Return a number of runs (kind of scene, engine), and more of the engines that a change touches."""
    touched = [run for run in runs if run[1] in touched_engines()]
    return sorted({*chosen(runs, number), *chosen(touched, more)})
