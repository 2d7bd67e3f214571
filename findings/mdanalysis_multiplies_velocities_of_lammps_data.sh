#!/usr/bin/env bash
# MDAnalysis multiplies the velocities of a LAMMPS data file by 1000, and the positions by 1.
#
# Usual guess: a data file has no units, so that numbers are as they stand there.
#
# What happens: velocities are taken for angstrom per femtosecond (LAMMPS's `units real`) and converted to
# angstrom per picosecond. Speeds, energies (a million times) and displacements by velocity times time are
# wrong in every other system of units.
#
# Way out: Universe(..., convert_units=False).
#
# Seen with MDAnalysis 2.11.0:
#
#     in the file [1.0, 2.0, 3.0]
#     default     [1000.0, 2000.0, 3000.0]
#     as it is    [1.0, 2.0, 3.0]
set -euo pipefail

packages=(MDAnalysis==2.11.0)
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder"
"$folder/bin/python" -m pip --disable-pip-version-check install --quiet --no-compile "${packages[@]}"
cd "$folder"
PATH=$folder/bin:$PATH python - <<'PYTHON'
import warnings

import MDAnalysis

warnings.simplefilter("ignore")
text = "lj units\n\n1 atoms\n1 atom types\n\n0 9 xlo xhi\n0 9 ylo yhi\n0 9 zlo zhi\n\nMasses\n\n1 1\n\n"
text += "Atoms # atomic\n\n1 1 4 5 6\n\nVelocities\n\n1 1 2 3\n"
with open("a.data", "w") as file:
    file.write(text)
found = []
for options in ({}, {"convert_units": False}):
    atoms = MDAnalysis.Universe("a.data", atom_style="id type x y z", **options).atoms
    assert atoms.positions.tolist() == [[4.0, 5.0, 6.0]]
    found.append([round(float(value), 3) for value in atoms.velocities[0]])
print("in the file [1.0, 2.0, 3.0]")
print("default    ", found[0])
print("as it is   ", found[1])
assert found == [[1000.0, 2000.0, 3000.0], [1.0, 2.0, 3.0]], "the behaviour has changed"
PYTHON
