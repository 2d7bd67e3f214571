"""What is compiled by the shortcuts is, instruction by instruction, what numba compiles without them."""

import math
import os
import subprocess
import sys
from typing import NamedTuple

import numpy as np

from gaspart.kernels.compile.policy import allocating_kernel, inner_helper, inner_kernel

PROGRAM = """
import re, sys
from types import SimpleNamespace
import gaspart.kernels.compile as package
if sys.argv[1] == "plain":
    name = "gaspart.kernels.compile.shortcuts"
    package.shortcuts = sys.modules[name] = SimpleNamespace(take=lambda: None)
import numpy as np
from kernels.compile.test_shortcuts import EXAMPLE, example
from numba.core.types.functions import BaseFunction

print(BaseFunction.get_call_type.__module__, example(*EXAMPLE))
numbers = {}  # of functions, by which no two processes name one
for text in (*example.inspect_asm().values(), *example.inspect_llvm().values()):
    number = lambda found: f"#{numbers.setdefault(found[0], len(numbers))}"
    print(re.sub("(?<=B)[0-9]+v[0-9]+|[0-9]{9,}", number, text))
"""


class Parts(NamedTuple):
    """As a `Model` has them: one of these two is None."""

    force: tuple | None
    walls: np.ndarray | None


EXAMPLE = np.linspace(0.0, 1.0, 12).reshape(4, 3), Parts((1.0, 0.0, -1.0), None), 3


@inner_helper
def bent(place, force):
    if force is None:
        return place
    return place + 0.5 * math.sqrt(abs(force))


@inner_kernel
def nearer(least, n, walls):
    if walls is None:
        return least
    return min(least, walls[n])


@inner_kernel
def nearest(places, n, parts):
    """The least distance from the others, and which is that near."""
    least, which = math.inf, -1
    for k in range(len(places)):
        squared = 0.0
        for axis in range(places.shape[1]):
            apart = places[k, axis] - bent(places[n, axis], parts.force[axis])
            squared += apart**2
        if k != n and squared < least:
            least, which = squared, k
    return math.sqrt(nearer(least, n, parts.walls)), which


@allocating_kernel
def example(places, parts, repeated):
    """Arrays, loops, branches, tuples, numbers of several kinds, and functions of numba."""
    found = np.zeros((repeated, len(places)), dtype=np.float32)
    for n in range(len(places)):
        least, which = nearest(places, n, parts)
        found[n % repeated, which] += np.float32(least) if n & 1 else 2 * least
    return found.sum() + float(np.argmax(found[0])) + round(places[:, 0].max())


def test_the_shortcuts_change_no_instruction(tmp_path):
    printed = []
    for way in ("plain", "short"):
        environment = os.environ | {
            "GASPART_CACHE": str(tmp_path / way),
            "PYTHONPATH": os.pathsep.join(filter(None, sys.path)),
        }
        command = [sys.executable, "-c", PROGRAM, way]
        done = subprocess.run(command, env=environment, capture_output=True, text=True)
        assert done.returncode == 0, done.stderr
        printed.append(done.stdout)
    (plain, result, code), (short, same_result, same_code) = (one.split(maxsplit=2) for one in printed)
    assert (plain, short) == ("numba.core.types.functions", "gaspart.kernels.compile.shortcuts")
    assert result == same_result and code.count("\n") > 500
    assert code == same_code
