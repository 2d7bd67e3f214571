#!/usr/bin/env bash
# A GSD frame without velocities is read with those of frame 0.
#
# Usual guess: None or zeros where a frame has no velocities.
#
# What happens: the schema takes what frame n lacks from frame 0, at another time. HOOMD's writer stores
# velocities in frame 0 only unless it is told otherwise (dynamic=["property", "momentum"]), so that its
# usual files give an energy that is conserved to the last bit, and velocities that have nothing to do with
# the positions beside them.
#
# Way out: file.file.chunk_exists(frame=n, name="particles/velocity").
#
# Seen with gsd 5.0.1:
#
#     velocity in frame 1: [[1.0, 2.0, 3.0]]
#     stored in frame 1: False
set -euo pipefail

packages=(gsd==5.0.1 numpy==2.4.6)
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder"
"$folder/bin/python" -m pip --disable-pip-version-check install --quiet --no-compile "${packages[@]}"
cd "$folder"
PATH=$folder/bin:$PATH python - <<'PYTHON'
import gsd.hoomd

with gsd.hoomd.open("a.gsd", "w") as file:
    for n in range(2):
        frame = gsd.hoomd.Frame()
        frame.configuration.step, frame.configuration.box = n, [9, 9, 9, 0, 0, 0]
        frame.particles.N, frame.particles.position = 1, [[n, 0, 0]]
        if n == 0:
            frame.particles.velocity = [[1, 2, 3]]
        file.append(frame)
with gsd.hoomd.open("a.gsd") as file:
    velocity = file[1].particles.velocity.tolist()
    stored = file.file.chunk_exists(frame=1, name="particles/velocity")
print("velocity in frame 1:", velocity)
print("stored in frame 1:", stored)
assert velocity == [[1.0, 2.0, 3.0]] and not stored, "the behaviour has changed"
PYTHON
