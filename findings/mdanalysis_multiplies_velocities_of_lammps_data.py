"""MDAnalysis multiplies the velocities of a LAMMPS data file by 1000, and the positions by 1.

Usual guess: a data file has no units, so that numbers are as they stand there.

What happens: velocities are taken for angstrom per femtosecond (LAMMPS's `units real`) and converted to
angstrom per picosecond. Speeds, energies (a million times) and displacements by velocity times time are
wrong in every other system of units.

Way out: Universe(..., convert_units=False).

Seen with MDAnalysis 2.11.0:

    in the file [1.0, 2.0, 3.0]
    default     [1000.0, 2000.0, 3000.0]
    as it is    [1.0, 2.0, 3.0]
"""

import os
import subprocess
import sys
import tempfile

PACKAGES = ["MDAnalysis==2.11.0"]

# The script runs again with these packages, in an environment that is removed afterwards.
if "FINDING_RUNS" not in os.environ:
    with tempfile.TemporaryDirectory() as folder:
        subprocess.run([sys.executable, "-m", "venv", "--without-pip", folder], check=True)
        python = os.path.join(folder, "bin", "python")
        install = [sys.executable, "-m", "pip", "--python", python, "install", "--quiet", "--no-compile"]
        subprocess.run([*install, *PACKAGES], check=True)
        inside = {**os.environ, "FINDING_RUNS": "1"}
        sys.exit(subprocess.run([python, os.path.abspath(__file__)], env=inside, cwd=folder).returncode)

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
