"""Compiled kernels of the DSMC engine against their own source, run as plain Python."""

import os
import subprocess
import sys
from pathlib import Path

import numpy as np
from kernels.dsmc.interpreted_dsmc import ends


def test_python_gives_the_bits_of_the_compiled_kernels(tmp_path):
    env = {**os.environ, "NUMBA_DISABLE_JIT": "1", "PYTHONPATH": os.pathsep.join(sys.path)}
    script = Path(__file__).with_name("interpreted_dsmc.py")
    subprocess.run([sys.executable, script, tmp_path / "ends.npz"], env=env, check=True)
    compiled = ends()
    with np.load(tmp_path / "ends.npz") as plain:
        assert set(compiled) == set(plain)
        for name, end in plain.items():
            assert np.array_equal(end, compiled[name]), name
