"""Which loops of the engines a process has compiled or loaded; a file lists those of `compile_kernels`."""

import hashlib
import sys
from functools import cache
from pathlib import Path

LOOPS = {
    "gaspart.kernels.event.loop": "run",
    "gaspart.kernels.event.growth": "run",
    "gaspart.kernels.step.box_search": "run_steps",
    "gaspart.kernels.dsmc.loop": "run_steps",
}
"""The kernels that take longest to compile, by module: each kind of scene has its own."""
LIST = Path(__file__).parents[2] / ".pytest_cache/canonical_kernels"


def loops_in_use():
    """Return digests of the engines' loops that this process has compiled or loaded."""
    loops = {name: getattr(sys.modules[name], loop) for name, loop in LOOPS.items() if name in sys.modules}
    return set().union(*(digests_of(name, len(loop.overloads)) for name, loop in loops.items()))


@cache
def digests_of(name, number):
    """Return digests of the types of arguments of a loop, of which there are so many."""
    types = getattr(sys.modules[name], LOOPS[name]).overloads
    return {hashlib.sha256(f"{name} {of}".encode()).hexdigest() for of in list(types)[:number]}
