#!/usr/bin/env bash
# netCDF reads every second frame of a trajectory in many times the time of all frames.
#
# Usual guess: half of the frames take half of the time, or at most the same.
#
# What happens: a step in a slice, along any dimension, is a strided read of the C library, whose cost grows with
# the numbers and not with the bytes. Classic files (AMBER's) and netCDF-4 files behave alike; values are right.
#
# Way out: read without a step, in blocks, and take every second frame of the array: variable[:][::2], or frame by
# frame. xarray passes the step on: data.isel(frame=slice(None, None, 2)) of an open file is as slow.
#
# Seen with netCDF4 1.7.5.1, 400 frames of 4000 particles (processor time of the slice over that of all):
#
#     NETCDF3_64BIT_OFFSET: [::2] 18 times, frame by frame 2.4 times
#     NETCDF4: [::2] 67 times, frame by frame 9.6 times
set -euo pipefail

packages=(netCDF4==1.7.5.1.post1 numpy==2.4.6)
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder"
"$folder/bin/python" -m pip --disable-pip-version-check install --quiet --no-compile "${packages[@]}"
cd "$folder"
PATH=$folder/bin:$PATH python - <<'PYTHON'
import time

import netCDF4
import numpy as np

FRAMES, PARTICLES = 400, 4000


def spend(read):
    times = []
    for _ in range(5):
        start = time.process_time()
        read()
        times.append(time.process_time() - start)
    return min(times)


positions = np.random.default_rng(1).random((FRAMES, PARTICLES, 3), dtype="f4")
for kind in ("NETCDF3_64BIT_OFFSET", "NETCDF4"):
    with netCDF4.Dataset("a.nc", "w", format=kind) as file:
        for name, size in (("frame", None), ("atom", PARTICLES), ("spatial", 3)):
            file.createDimension(name, size)
        file.createVariable("coordinates", "f4", ("frame", "atom", "spatial"))[:] = positions
    with netCDF4.Dataset("a.nc") as file:
        variable = file["coordinates"]
        variable.set_auto_mask(False)
        assert (variable[::2] == positions[::2]).all()
        whole = spend(lambda: variable[:])
        half = spend(lambda: variable[::2]) / whole
        single = spend(lambda: [variable[n] for n in range(0, FRAMES, 2)]) / whole
    print(f"{kind}: [::2] {half:.3g} times, frame by frame {single:.2g} times")
    assert half > 4.0 and single < 0.5 * half, "the behaviour has changed"
PYTHON
