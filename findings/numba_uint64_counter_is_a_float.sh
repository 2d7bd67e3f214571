#!/usr/bin/env bash
# In numba, a uint64 that a loop increments by 1 is a float, which has 53 bits.
#
# Usual guess: a uint64 plus a literal is a uint64, as in numpy 2, and as numba itself has it in one
# expression.
#
# What happens: n + 1 alone is an integer. Where the sum is assigned to n in a loop, the types of n before
# and after are unified, and the common type of uint64 and int64 is float64. Hashes, bit masks and random
# number generators lose their last digits without a warning.
#
# Way out: n += np.uint64(1).
#
# Seen with numba 0.68.1 and numpy 2.4.6:
#
#     once     9007199254740993
#     5 times  9007199254740992.0
set -euo pipefail

packages=(numba==0.68.1 numpy==2.4.6)
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder"
"$folder/bin/python" -m pip --disable-pip-version-check install --quiet --no-compile "${packages[@]}"
cd "$folder"
PATH=$folder/bin:$PATH python - <<'PYTHON'
import numba
import numpy as np


@numba.njit
def counted(n, times):
    for _ in range(times):
        n += 1
    return n


start = np.uint64(2**53)
once, often = numba.njit(lambda n: n + 1)(start), counted(start, 5)
print("once    ", once)
print("5 times ", often)
assert once == 2**53 + 1
assert isinstance(often, float) and often == 2.0**53, "the behaviour has changed"
PYTHON
