"""Compiled kernels against their own source, run as plain Python: the same bits, and no bad index."""

import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from kernels.interpreted import FEW, PYTHON, end_of, ends, runs


@pytest.mark.interpreted
@pytest.mark.parametrize("name", runs())
def test_a_short_run_by_each_search(name):
    """Compiled, one alone: the battery compares the searches of compiled kernels."""
    scene, (first, *others), limits = runs()[name]
    end = end_of(name, first, scene, limits)
    assert np.isfinite(end).all()
    for engine in others if PYTHON else ():
        assert np.array_equal(end, end_of(name, engine, scene, limits)), engine


@pytest.mark.parametrize("names", [FEW, pytest.param(runs(), marks=pytest.mark.thorough)], ids=["few", "all"])
def test_python_gives_the_bits_of_the_compiled_kernels(tmp_path, names):
    env = {**os.environ, "NUMBA_DISABLE_JIT": "1", "PYTHONPATH": os.pathsep.join(sys.path)}
    script = Path(__file__).with_name("interpreted.py")
    subprocess.run([sys.executable, script, tmp_path / "ends.npz", *names], env=env, check=True)
    compiled = ends(names)
    with np.load(tmp_path / "ends.npz") as plain:
        assert set(compiled) == set(plain)
        for name, end in plain.items():
            assert np.array_equal(end, compiled[name], equal_nan=True), name
