"""In numba, an integer to a negative integer power is an integer: 2 ** -2 is 0.

Usual guess: 0.25, as in Python; or an error, as in numpy ("Integers to negative integer powers are not
allowed").

What happens: the result has the type int64, and the fraction is cut off. No warning.

Way out: a float base, float(n) ** -2, or 1.0 / n**2.

Seen with numba 0.68.1:

    python  0.25
    numba   0
    float   0.25
"""

import os
import subprocess
import sys
import tempfile

PACKAGES = ["numba==0.68.1"]

# The script runs again with these packages, in an environment that is removed afterwards.
if "FINDING_RUNS" not in os.environ:
    with tempfile.TemporaryDirectory() as folder:
        subprocess.run([sys.executable, "-m", "venv", "--without-pip", folder], check=True)
        python = os.path.join(folder, "bin", "python")
        install = [sys.executable, "-m", "pip", "--python", python, "install", "--quiet", "--no-compile"]
        subprocess.run([*install, *PACKAGES], check=True)
        inside = {**os.environ, "FINDING_RUNS": "1"}
        sys.exit(subprocess.run([python, os.path.abspath(__file__)], env=inside, cwd=folder).returncode)

import numba


def inverse_square(n):
    return n**-2


compiled = numba.njit(inverse_square)
print("python ", inverse_square(2))
print("numba  ", compiled(2))
print("float  ", compiled(2.0))
assert inverse_square(2) == compiled(2.0) == 0.25
assert compiled(2) == 0, "the behaviour has changed"
