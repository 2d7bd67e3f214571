#!/usr/bin/env bash
# freud's direct structure factor has wave vectors of one octant only, and k = 0.
#
# Usual guess: S(k) is the mean over all directions of k, and k = 0 is left out.
#
# What happens: k runs over kx, ky, kz >= 0. A wave along (1, -1, 0), as in a crystal or a layered fluid
# that is not along an axis, is not seen at all. And the first bin has k = 0, where S is N.
#
# Way out: k_min above 0, and freud for isotropic fluids only.
#
# Seen with freud 3.4.0: 600 particles, a density wave along (2, -2, 0):
#
#     S along the wave 134, freud there 0.3; first bin 600
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

side, count, rng, places = 10.0, 600, np.random.default_rng(2), []
unit = 2.0 * np.pi / side
wave = 2.0 * unit * np.array([1.0, -1.0, 0.0])
while len(places) < count:
    place = rng.uniform(-0.5 * side, 0.5 * side, 3)
    if rng.random() < 0.5 * (1.0 + np.cos(wave @ place)):
        places.append(place)
exact = abs(np.exp(1j * np.array(places) @ wave).sum()) ** 2 / count
found = freud.diffraction.StaticStructureFactorDirect(bins=100, k_max=4.0 * unit, num_sampled_k_points=0)
found.compute((freud.box.Box.cube(side), np.array(places)))
at = np.argmin(np.abs(found.bin_centers - np.linalg.norm(wave)))
there = float(np.nanmax(found.S_k[at - 1 : at + 2]))
print(f"S along the wave {exact:.0f}, freud there {there:.1f}; first bin {found.S_k[0]:.0f}")
assert exact > 50.0 and there < 10.0 and abs(found.S_k[0] - count) < 1.0, "the behaviour has changed"
PYTHON
