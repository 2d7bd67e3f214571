#!/usr/bin/env bash
# In numba, an integer to a negative integer power is an integer: 2 ** -2 is 0.
#
# Usual guess: 0.25, as in Python; or an error, as in numpy ("Integers to negative integer powers are not
# allowed").
#
# What happens: the result has the type int64, and the fraction is cut off. No warning.
#
# Way out: a float base, float(n) ** -2, or 1.0 / n**2.
#
# Seen with numba 0.68.1:
#
#     python  0.25
#     numba   0
#     float   0.25
set -euo pipefail

packages=(numba==0.68.1)
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder"
"$folder/bin/python" -m pip --disable-pip-version-check install --quiet --no-compile "${packages[@]}"
cd "$folder"
PATH=$folder/bin:$PATH python - <<'PYTHON'
import numba


def inverse_square(n):
    return n**-2


compiled = numba.njit(inverse_square)
print("python ", inverse_square(2))
print("numba  ", compiled(2))
print("float  ", compiled(2.0))
assert inverse_square(2) == compiled(2.0) == 0.25
assert compiled(2) == 0, "the behaviour has changed"
PYTHON
