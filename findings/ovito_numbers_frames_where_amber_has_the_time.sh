#!/usr/bin/env bash
# OVITO's netcdf/amber files have the number of the frame in `time`; the time is elsewhere.
#
# Usual guess: the variable `time` of AMBER's convention has the time of the frame, as OVITO knows it from
# the file that it read.
#
# What happens: `time` is 0, 1, 2, ...; the time is in a variable `Time`, and ids are in `identifier`, radii
# in `Radius`, where other readers look for `id` and `radius`. Velocities times "time" are off by the
# interval.
#
# Way out: read `Time` where the attribute program is OVITO, and follow `identifier`.
#
# Seen with ovito 3.17.2 (times 0, 0.25, 0.5 in the dump):
#
#     time [0.0, 1.0, 2.0], Time [0.0, 0.25, 0.5], identifier True, id False
set -euo pipefail

packages=(ovito==3.17.2 netCDF4==1.7.5.1.post1)
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder"
"$folder/bin/python" -m pip --disable-pip-version-check install --quiet --no-compile "${packages[@]}"
cd "$folder"
PATH=$folder/bin:$PATH python - <<'PYTHON'
import os

import warnings

import netCDF4

warnings.simplefilter("ignore")
os.environ["OVITO_GUI_MODE"] = "0"
from ovito.io import export_file, import_file

with open("a.dump", "w") as dump:
    for n in range(3):
        dump.write(f"ITEM: TIME\n{0.25 * n}\nITEM: TIMESTEP\n{n}\nITEM: NUMBER OF ATOMS\n2\n")
        dump.write(
            "ITEM: BOX BOUNDS pp pp pp\n0 9\n0 9\n0 9\nITEM: ATOMS id type x y z\n2 1 1 1 1\n1 1 2 2 2\n"
        )
columns = ["Particle Identifier", "Position.X", "Position.Y", "Position.Z"]
export_file(import_file("a.dump"), "a.nc", "netcdf/amber", columns=columns, multiple_frames=True)
with netCDF4.Dataset("a.nc") as file:
    time, other, names = file["time"][:].tolist(), file["Time"][:].tolist(), set(file.variables)
print(f"time {time}, Time {other}, identifier {'identifier' in names}, id {'id' in names}")
assert time == [0.0, 1.0, 2.0] and other == [0.0, 0.25, 0.5], "the behaviour has changed"
assert "identifier" in names and "id" not in names, "the behaviour has changed"
PYTHON
