#!/usr/bin/env bash
# freud's windowed mean-squared displacement loses its digits far from the origin.
#
# Usual guess: displacements are differences, so that a shift of all positions changes nothing.
#
# What happens: the sum of squares is found by Fourier transforms of the positions themselves, of which the
# displacement is a small difference; results are in single precision. 1000 lengths from the origin, as
# unwrapped paths are after a long run, the value for steps of 0.01 is 0.99 instead of 0.0001.
#
# Way out: subtract the first position of each particle.
#
# Seen with freud 3.4.0:
#
#     exact 1.0e-04; at the origin 1.0e-04; 1000 away 9.9e-01
set -euo pipefail

packages=(freud-analysis==3.4.0 numpy==2.4.6)
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder"
"$folder/bin/python" -m pip --disable-pip-version-check install --quiet --no-compile "${packages[@]}"
cd "$folder"
PATH=$folder/bin:$PATH python - <<'PYTHON'
import freud
import numpy as np

steps = np.zeros((100, 20, 3))
steps[:, :, 0] = 0.01 * np.arange(100)[:, None]  # a step of 0.01 in each frame


def first(positions):
    return float(freud.msd.MSD(mode="window").compute(positions).msd[1])


near, far = first(steps), first(steps + 1000.0)
print(f"exact 1.0e-04; at the origin {near:.1e}; 1000 away {far:.1e}")
assert abs(near - 1e-4) < 1e-6 and abs(far - 1e-4) > 1e-3, "the behaviour has changed"
PYTHON
