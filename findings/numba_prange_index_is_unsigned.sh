#!/usr/bin/env bash
# In numba, the index of a parallel loop is unsigned: -i is not minus i.
#
# Usual guess: `for i in prange(n)` counts as `range` does, and -i is negative.
#
# What happens: with parallel=True the index has the type uint64, and -1 is 2^64 - 1. The same function
# without parallel=True has the expected value; nothing warns.
#
# Way out: n - i, or int(i), or a plain range inside the loop.
#
# Seen with numba 0.68.1:
#
#     serial    [0.0, -1.0, -2.0]
#     parallel  [0.0, 1.8446744073709552e+19, 1.8446744073709552e+19]
set -euo pipefail

packages=(numba==0.68.1)
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder"
"$folder/bin/python" -m pip --disable-pip-version-check install --quiet --no-compile "${packages[@]}"
cd "$folder"
PATH=$folder/bin:$PATH python - <<'PYTHON'
import numba
import numpy as np


def negatives(n):
    found = np.zeros(n)
    for i in numba.prange(n):
        found[i] = -i
    return found


serial, parallel = numba.njit(negatives)(3), numba.njit(parallel=True)(negatives)(3)
print("serial   ", serial.tolist())
print("parallel ", parallel.tolist())
assert serial.tolist() == [0.0, -1.0, -2.0]
assert parallel[1] == 2.0**64, "the behaviour has changed"
PYTHON
