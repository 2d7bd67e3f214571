#!/usr/bin/env bash
# The netCDF library reads a truncated netCDF-3 file without an error: what is missing is 0.
#
# Usual guess: an error when the file is opened, or when the missing values are read.
#
# What happens: a file that lost its second half, as on a full disk or in a broken transfer, opens with all
# of its frames; the missing ones are zeros, which look like particles at rest in a corner.
#
# Way out: compare the size of the file with the one that follows from its header.
#
# Seen with netCDF4 1.7.5.1.post1:
#
#     4000 of 8000 bytes of data are left; values 0, 499, 510, 999: [1.0, 1.0, 0.0, 0.0]
set -euo pipefail

packages=(netCDF4==1.7.5.1.post1 numpy==2.4.6)
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder"
"$folder/bin/python" -m pip --disable-pip-version-check install --quiet --no-compile "${packages[@]}"
cd "$folder"
PATH=$folder/bin:$PATH python - <<'PYTHON'
import os

import netCDF4
import numpy as np

with netCDF4.Dataset("a.nc", "w", format="NETCDF3_64BIT_OFFSET") as file:
    file.createDimension("frame", None)
    file.createVariable("x", "f8", ("frame",))[:] = np.ones(1000)
os.truncate("a.nc", os.path.getsize("a.nc") - 4000)
with netCDF4.Dataset("a.nc") as file:
    values = np.ma.getdata(file["x"][:])
some = values[[0, 499, 510, 999]].tolist()
print(f"4000 of 8000 bytes of data are left; values 0, 499, 510, 999: {some}")
assert len(values) == 1000 and some == [1.0, 1.0, 0.0, 0.0], "the behaviour has changed"
PYTHON
