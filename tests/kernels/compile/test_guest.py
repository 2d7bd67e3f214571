"""The library is a guest in the user's process: what it changes there is its own."""

import itertools
import subprocess
import sys
from typing import NamedTuple

import numba
import numpy as np
from numba.core.bytecode import FunctionIdentity
from numba.core.datamodel import default_manager
from numba.core.datamodel.models import TupleModel

from gaspart.kernels.compile.parts import _FIRST, PartCache
from gaspart.kernels.compile.policy import inner_kernel, kernel
from gaspart.kernels.model import Space


class Pair(NamedTuple):
    values: np.ndarray
    factor: float


def largest(x):
    return max(x, 0.5)


def test_garbage_of_the_user_is_collected_after_a_simulation():
    code = """
import gc, weakref, gaspart as gp
class InACycle:
    def __init__(self):
        self.itself = self
objects = [InACycle() for _ in range(50)]
left = [weakref.ref(one) for one in objects]
scene = gp.Scene(gp.Container((10.0, 10.0)), [gp.Species(8, 0.5, temperature=1.0)])
gp.Simulation(scene, gp.EventDriven(), 1)
del objects
gc.collect()
assert not any(one() for one in left) and not gc.get_freeze_count()
"""
    subprocess.run([sys.executable, "-c", code], check=True)


def test_named_tuples_of_others_are_passed_as_numba_passes_them():
    foreign = default_manager.lookup(numba.typeof(Pair(np.arange(4.0), 2.0)))
    own = default_manager.lookup(numba.typeof(Space((1.0, 1.0), (True, True), 1.0)))
    numbas = TupleModel(default_manager, foreign.fe_type)
    assert foreign.get_argument_type() == numbas.get_argument_type() != foreign.get_value_type()
    assert own.get_argument_type() == own.get_value_type()

    @numba.njit
    def scaled_sum(pair):
        return pair.values.sum() * pair.factor

    assert scaled_sum(Pair(np.arange(4.0), 2.0)) == 12.0


def test_functions_of_others_keep_their_numbers_and_no_two_processes_number_kernels_alike():
    before = FunctionIdentity._unique_ids
    part = inner_kernel(largest)
    kernel(lambda x: part(x) + 1.0)(0.25)
    assert FunctionIdentity._unique_ids is before
    (translated,) = part.overloads.values()
    assert translated.library.name and int(translated.fndesc.unique_name.split("$")[1]) >= _FIRST


def test_a_translation_with_numbers_of_this_process_is_not_kept_for_others(monkeypatch, tmp_path):
    """Another process may have given them to other functions of the same name."""
    part = inner_kernel(largest)
    kernel(lambda x: part(x) + 1.0)(0.25)
    (translated,) = part.overloads.values()
    monkeypatch.setattr(numba.config, "CACHE_DIR", str(tmp_path))
    contents = PartCache(largest, {})._impl
    assert contents.check_cachable(translated)
    monkeypatch.setattr("gaspart.kernels.compile.parts._numbers", itertools.count(1))
    ordinary = inner_kernel(largest)
    kernel(lambda x: ordinary(x) + 2.0)(np.float32(0.25))
    (translated,) = ordinary.overloads.values()
    assert not contents.check_cachable(translated)


def test_another_numba_compiles_in_its_own_way_to_the_same_bits():
    code = """
import warnings, numba, numpy as np
{change}
with warnings.catch_warnings(record=True) as issued:
    warnings.simplefilter("always")
    from gaspart.kernels.physics.rng import log_of, random_words
    words = random_words(np.array([1, 2], dtype=np.uint64), 3, 4, 5)
print(len(issued), *words, *(log_of(x).hex() for x in (0.1, 3.7, 1e300)))
"""
    lines = []
    for change in ("", "numba.__version__ = '0.99.0'"):
        command = [sys.executable, "-c", code.format(change=change)]
        done = subprocess.run(command, capture_output=True, text=True, check=True)
        lines.append(done.stdout.split(maxsplit=1))
    assert [warned for warned, _ in lines] == ["0", "1"]
    assert lines[0][1] == lines[1][1]
