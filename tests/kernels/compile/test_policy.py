"""Which functions become machine code, and that an inner one gives the bits of a kernel of its own."""

import math
import os
import subprocess
import sys
from pathlib import Path

import numba
import numpy as np
import pytest
from numba.core.runtime import _nrt_python, rtsys

from gaspart.kernels.compile import policy as compilation
from gaspart.kernels.compile.policy import (
    allocating_kernel,
    inner_allocating_kernel,
    inner_helper,
    inner_kernel,
    kernel,
)


def polynomial(x):
    return ((0.1 * x + 0.3) * x - 0.7) * x + math.sqrt(x)


inlined, called, alone = inner_helper(polynomial), inner_kernel(polynomial), kernel(polynomial)


@inner_kernel
def both(x):
    return inlined(x), called(x)


def outer_function(x):
    return both(x)


@inner_allocating_kernel
def powers(x, count):
    found = np.empty(count)
    for n in range(count):
        found[n] = x**n
    return found


@allocating_kernel
def total(x):
    return powers(x, 5).sum()


def machine_code(function):
    """Whether some overload of a function has been compiled to the end."""
    return any(hasattr(one.library, "_compiled_object") for one in function.overloads.values())


def test_inner_functions_give_the_same_bits_and_only_the_outermost_is_machine_code(monkeypatch):
    monkeypatch.setattr(compilation, "_CACHE", None)  # what is loaded from it compiles nothing
    outer = kernel(outer_function)
    for x in (0.1, 1.0 / 3.0, 2.0**40):
        assert outer(x) == (alone(x), alone(x))
    assert machine_code(outer)
    assert both.overloads and not machine_code(both) and not machine_code(inlined)


def test_an_inner_function_may_make_arrays_and_none_is_left():
    assert total(2.0) == 31.0
    _nrt_python.memsys_enable_stats()
    before = rtsys.get_allocation_stats()
    for _ in range(100):
        total(2.0)
    after = rtsys.get_allocation_stats()
    assert after.alloc - before.alloc == after.free - before.free


PROGRAM = """
import sys
from gaspart.kernels.compile.policy import inner_helper, inner_kernel, kernel

def cubed(x):
    return 0.1 * x * x * x

inlined, called, alone = inner_helper(cubed), inner_kernel(cubed), kernel(cubed)

@inner_kernel
def shared(x):
    return inlined(x) + called(x)

@kernel
def first(x):
    return x + shared(x)

@kernel
def second(x):
    return 2.0 * x + shared(x)

outer, factor = {"first": (first, 1.0), "second": (second, 2.0)}[sys.argv[1]]
print(outer(1.3) == factor * 1.3 + (alone(1.3) + alone(1.3)))
print([sum(function.stats.cache_hits.values()) for function in (outer, shared, inlined, called, alone)])
"""


def test_what_one_process_translates_another_loads_for_another_kernel(tmp_path):
    """With all that it calls; and one function compiled in three ways has three files."""
    program = tmp_path / "program.py"
    program.write_text(PROGRAM)
    environment = os.environ | {"GASPART_CACHE": str(tmp_path / "cache")}
    for name, hits in (("first", [0, 0, 0, 0, 0]), ("second", [0, 1, 0, 0, 1]), ("first", [1, 0, 0, 0, 1])):
        command = [sys.executable, program, name]
        done = subprocess.run(command, env=environment, capture_output=True, text=True, check=True)
        assert done.stdout == f"True\n{hits}\n"


PROJECT = Path(__file__).parents[3]
OLDEST = Path(__file__).parent / "oldest_numba.txt"
SIMULATION = """
import hashlib, warnings
warnings.simplefilter("error")
import numba
import gaspart as gp
scene = gp.Scene(gp.Container((8.0, 8.0), "periodic"), [gp.Species(20, 0.5, temperature=1.0)])
simulation = gp.Simulation(scene, gp.EventDriven(), 1)
simulation.advance(5.0)
parts = simulation.state.positions, simulation.state.velocities
print(numba.__version__, *(hashlib.sha256(part.tobytes()).hexdigest() for part in parts))
"""


def simulated(*others, cache=None):
    """What a simulation prints, with packages in `others` first, and when cached kernels were written."""
    environment = os.environ | {"PYTHONPATH": os.pathsep.join(map(str, others))}
    environment |= {"GASPART_CACHE": str(cache)} if cache else {}
    command = [sys.executable, "-c", SIMULATION]
    done = subprocess.run(command, env=environment, capture_output=True, text=True, check=True)
    kept = {path: path.stat().st_mtime_ns for path in cache.rglob("*.nbc")} if cache else {}
    return done.stdout.split(), kept


@pytest.mark.thorough
def test_the_oldest_numba_that_is_allowed_gives_the_same_bits_and_keeps_its_kernels(tmp_path):
    """The locked release is the newest one: the upper bound of pyproject.toml."""
    release = OLDEST.read_text().partition("\nnumba==")[2].split()[0]
    assert f'"numba>={release.removesuffix(".0")},<' in (PROJECT / "pyproject.toml").read_text()
    oldest, cache = tmp_path / "oldest", tmp_path / "cache"
    command = [sys.executable, "-m", "pip", "--quiet", "--disable-pip-version-check", "install", "--no-deps"]
    command += ["--no-compile", "--require-hashes", "--target", oldest, "--requirement", OLDEST]
    subprocess.run(command, check=True)
    (locked, *bits), _ = simulated()
    assert locked == numba.__version__ != release
    first, kept = simulated(oldest, cache=cache)
    assert first == [release, *bits] and kept
    assert simulated(oldest, cache=cache) == (first, kept)
