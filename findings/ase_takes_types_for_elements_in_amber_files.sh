#!/usr/bin/env bash
# ASE gives the particles of an AMBER netCDF file the masses of elements by their types: energies change.
#
# Usual guess: momenta are velocities times the masses of the file, or ASE says that it has none.
#
# What happens: the variable "type" is taken for the atomic number, and "mass" is not read. Types 0 and 1
# are the elements X (mass 1) and H (1.008), whatever the file says of them.
#
# Way out: atoms.set_masses(...), then atoms.set_velocities(...) with the velocities read before.
#
# Seen with ase 3.29.0, two particles of masses 1 and 100 with speed 1:
#
#     masses [1.0, 1.008], kinetic energy 1.004, right 50.5
set -euo pipefail

packages=(ase==3.29.0 netCDF4==1.7.5.1.post1 numpy==2.4.6)
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder"
"$folder/bin/python" -m pip --disable-pip-version-check install --quiet --no-compile "${packages[@]}"
cd "$folder"
PATH=$folder/bin:$PATH python - <<'PYTHON'
import netCDF4
import numpy as np
from ase.io.netcdftrajectory import NetCDFTrajectory

masses = [1.0, 100.0]
with netCDF4.Dataset("a.nc", "w", format="NETCDF3_64BIT_OFFSET") as file:
    file.setncatts({"Conventions": "AMBER", "ConventionVersion": "1.0"})
    for name, size in (("frame", None), ("spatial", 3), ("cell_spatial", 3), ("atom", 2)):
        file.createDimension(name, size)
    for name, values in (("coordinates", np.zeros((1, 2, 3))), ("velocities", [[[1, 0, 0], [1, 0, 0]]])):
        file.createVariable(name, "f4", ("frame", "atom", "spatial"))[:] = values
    for name, value in (("cell_lengths", 9.0), ("cell_angles", 90.0)):
        file.createVariable(name, "f8", ("frame", "cell_spatial"))[:] = np.full((1, 3), value)
    file.createVariable("time", "f8", ("frame",))[:] = [0.0]
    file.createVariable("type", "i4", ("atom",))[:] = [0, 1]
    file.createVariable("mass", "f8", ("atom",))[:] = masses
atoms = NetCDFTrajectory("a.nc")[0]
energy = float(atoms.get_kinetic_energy())
print(f"masses {atoms.get_masses().tolist()}, kinetic energy {energy:.4g}, right {0.5 * sum(masses)}")
assert abs(energy - 1.004) < 1e-6, "the behaviour has changed"
PYTHON
