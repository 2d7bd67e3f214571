"""A GSD frame without velocities is read with those of frame 0.

Usual guess: None or zeros where a frame has no velocities.

What happens: the schema takes what frame n lacks from frame 0, at another time. HOOMD's writer stores
velocities in frame 0 only unless it is told otherwise (dynamic=["property", "momentum"]), so that its
usual files give an energy that is conserved to the last bit, and velocities that have nothing to do with
the positions beside them.

Way out: file.file.chunk_exists(frame=n, name="particles/velocity").

Seen with gsd 5.0.1:

    velocity in frame 1: [[1.0, 2.0, 3.0]]
    stored in frame 1: False
"""

import os
import subprocess
import sys
import tempfile

PACKAGES = ["gsd==5.0.1", "numpy==2.4.6"]

# The script runs again with these packages, in an environment that is removed afterwards.
if "FINDING_RUNS" not in os.environ:
    with tempfile.TemporaryDirectory() as folder:
        subprocess.run([sys.executable, "-m", "venv", "--without-pip", folder], check=True)
        python = os.path.join(folder, "bin", "python")
        install = [sys.executable, "-m", "pip", "--python", python, "install", "--quiet", "--no-compile"]
        subprocess.run([*install, *PACKAGES], check=True)
        inside = {**os.environ, "FINDING_RUNS": "1"}
        sys.exit(subprocess.run([python, os.path.abspath(__file__)], env=inside, cwd=folder).returncode)

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
