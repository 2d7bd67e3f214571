#!/usr/bin/env bash
# ASE reads positions of an AMBER netCDF file that are packed in two bytes (scale_factor) as whole numbers.
#
# Usual guess: a reader that applies `scale_factor` returns packed numbers to their resolution, as netCDF4
# and MDAnalysis do; or it refuses them.
#
# What happens: the numbers are scaled, and then cut to integers, without a warning.
#
# Way out: positions in float32 (24 B a particle and frame, with velocities). Of other readers, mdtraj 1.11
# scales, chemfiles 0.10.4 refuses the type, and OVITO 3.17 says that there is no variable `coordinates`.
#
# Seen with ase 3.29.0, MDAnalysis 2.11.0 and netCDF4 1.7.5, a particle at 2.74, 0.07, 6.46 in a box of side 10:
#
#     netCDF4 [2.74, 0.07, 6.46], MDAnalysis [2.74, 0.07, 6.46], ASE [2.0, 0.0, 6.0]
set -euo pipefail

packages=(ase==3.29.0 MDAnalysis==2.11.0 netCDF4==1.7.5.1.post1 numpy==2.4.6)
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder"
"$folder/bin/python" -m pip --disable-pip-version-check install --quiet --no-compile "${packages[@]}"
cd "$folder"
PATH=$folder/bin:$PATH python -W ignore - <<'PYTHON'
import MDAnalysis
import netCDF4
import numpy as np
from ase.io.netcdftrajectory import NetCDFTrajectory

with netCDF4.Dataset("a.nc", "w", format="NETCDF3_64BIT_OFFSET") as file:
    file.setncatts({"Conventions": "AMBER", "ConventionVersion": "1.0", "program": "a", "programVersion": "1"})
    for name, size in (("frame", None), ("spatial", 3), ("cell_spatial", 3), ("cell_angular", 3), ("atom", 1)):
        file.createDimension(name, size)
    places = file.createVariable("coordinates", "i2", ("frame", "atom", "spatial"))
    places.setncatts({"units": "angstrom", "scale_factor": np.float32(10.0 / 32767)})
    places[:] = [[[2.74, 0.07, 6.46]]]  # netCDF4 packs
    for name, over, value in (("cell_lengths", "cell_spatial", 10.0), ("cell_angles", "cell_angular", 90.0)):
        file.createVariable(name, "f8", ("frame", over))[:] = np.full((1, 3), value)
    file["cell_lengths"].units, file["cell_angles"].units = "angstrom", "degree"
    time = file.createVariable("time", "f4", ("frame",))
    time.units, time[:] = "picosecond", [0.0]

with netCDF4.Dataset("a.nc") as file:
    right = file["coordinates"][0, 0]
universe = MDAnalysis.Universe.empty(1, trajectory=False)
universe.load_new("a.nc", format="NCDF")
scaled, cut = universe.atoms.positions[0], NetCDFTrajectory("a.nc")[0].get_positions()[0]
readers = (("netCDF4", right), ("MDAnalysis", scaled), ("ASE", cut))
print(", ".join(f"{name} {np.round(np.asarray(place, float), 2).tolist()}" for name, place in readers))
assert np.allclose(scaled, right, atol=1e-5) and cut.tolist() == [2.0, 0.0, 6.0], "the behaviour has changed"
PYTHON
