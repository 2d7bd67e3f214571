"""What the loading of numba leaves behind in a process."""

import subprocess
import sys

import pytest

CODE = """
import gc, sys
from gaspart.kernels.compile.cache import load_numba
load_numba(ours={ours})
assert gc.isenabled() and (gc.get_freeze_count() > 100_000) == {ours}
assert "scipy.linalg.cython_blas" not in sys.modules or not {ours}
import scipy.linalg.cython_blas, coverage  # whoever needs them still gets them
"""


@pytest.mark.parametrize("ours", [True, False])
def test_the_process_is_as_it_was_but_for_numba(ours):
    subprocess.run([sys.executable, "-c", CODE.format(ours=ours)], check=True)
