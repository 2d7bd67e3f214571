"""SPARTA, the DSMC program of Sandia National Laboratories, repeats what the DSMC engine has computed.

Its variable soft spheres are hard ones with omega = 1/2, which makes the diameter depend on no speed, and
alpha = 1, isotropic scattering. It knows SI units only; with k_B kg as the mass of a sphere k_B T / m is the
number of kelvins, and all other numbers are those of gaspart.
"""

import json
import math
import os
import re
import subprocess
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
import pytest
from finding import SIGMA, Finding

VARIABLE = "GASPART_SPARTA"
BOLTZMANN = 1.380649e-23
FACES = 6
FASTEST = 3.0
"""Temperature for SPARTA's first bound of relative speeds, 2 sqrt(2 T). In each cell it rises to the largest
speed met so far, and until then pairs that are faster collide too rarely: with T = 1/3, that of the spheres,
the fourth moment was too low by 0.0045(4), which is 2.4 % of its rise; from 1 on it depends on T no more."""
SPECIES = f"A 1.0 {BOLTZMANN} 0 0.0 0 0.0 0.0 1.0 0.0\n"
"""Name, molar weight and mass; no inner degrees of freedom; weight 1 and no charge."""
GAS = """\
seed {seed}
dimension 3
global gridcut -1.0
boundary {boundary} p p
create_box 0 {lengths[0]!r} 0 {lengths[1]!r} 0 {lengths[2]!r}
create_grid {cells[0]} {cells[1]} {cells[2]}
species species A
mixture gas A temp {temperature}
global nrho {density!r} fnum 1.0
collide vss gas collisions
timestep {step!r}
"""
PLATES = """\
surf_collide hot diffuse {hot!r} 1.0
surf_collide cold diffuse {cold!r} 1.0
bound_modify xlo collide hot
bound_modify xhi collide cold
create_particles gas n {count}
run {warming}
compute heat boundary gas etot
fix mean ave/time 1 {block} {block} c_heat[*] mode vector file averages
run {steps}
"""
RELAXATION = """\
read_particles start 0
variable square particle vx*vx+vy*vy+vz*vz
variable fourth particle v_square*v_square
compute two reduce ave v_square
compute four reduce ave v_fourth
fix last ave/time {steps} 1 {steps} c_two c_four file averages
run {steps}
"""
START = """\
ITEM: TIMESTEP
0
ITEM: NUMBER OF ATOMS
{count}
ITEM: BOX BOUNDS pp pp pp
0 {lengths[0]!r}
0 {lengths[1]!r}
0 {lengths[2]!r}
ITEM: ATOMS id type x y z vx vy vz"""


def program():
    """Where SPARTA is; skips the test if that is not said."""
    if VARIABLE not in os.environ:
        pytest.skip(f"SPARTA is elsewhere or not at all: make referees {VARIABLE}=/path/to/spa_serial")
    return os.environ[VARIABLE]


def printed(folder, script):
    """Run a script in a folder; returns what SPARTA prints."""
    (folder / "script").write_text(script)
    command = [program(), "-in", "script", "-log", "none"]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout[-2000:]
    return done.stdout


def version():
    """The date by which its makers call a version."""
    with TemporaryDirectory() as folder:
        return re.search(r"SPARTA \((.+?)\)", printed(Path(folder), "\n"))[1]


def averages(folder, row, script, columns, **values):
    """Run a script with what a row and `values` state. Returns (M, columns), the averages that it writes."""
    (folder / "species").write_text(SPECIES)
    (folder / "collisions").write_text(f"A {row['diameter']!r} 0.5 1.0 1.0\n")  # with omega, T_ref and alpha
    density = row["count"] / math.prod(row["lengths"])
    printed(folder, (GAS + script).format(**row, **values, density=density))
    lines = (line.split() for line in (folder / "averages").read_text().splitlines() if line[0] != "#")
    return np.array([line for line in lines if len(line) == columns], dtype=float)


def fluxes(folder, row):
    """(K,) the flux through the gas, the mean of both plates, over each block of time."""
    more = {"warming": 2 * row["block"], "steps": row["blocks"] * row["block"]}
    more |= {"boundary": "s", "temperature": 0.5 * (row["hot"] + row["cold"])}
    found = averages(folder, row, PLATES, 2, seed=11, **more)
    found = found.reshape(row["blocks"], 1 + FACES, 2)[:, 1:, 1]  # after a line with the step
    return 0.5 * (found[:, 1] - found[:, 0]) / BOLTZMANN


def moments(folder, row):
    """(K,) <v^4> / <v^2>^2 of each replica at the end."""
    found = []
    for seed in range(1, row["replicas"] + 1):
        rng = np.random.default_rng(seed)
        flights = rng.standard_normal((row["count"], 3))
        columns = [np.arange(1, row["count"] + 1), np.ones(row["count"])]
        columns += [*(rng.random((row["count"], 3)) * row["lengths"]).T]
        columns += [*(flights / np.linalg.norm(flights, axis=1)[:, None]).T]
        text = {"fmt": "%d %d" + 6 * " %.12g", "header": START.format(**row), "comments": ""}
        np.savetxt(folder / "start", np.column_stack(columns), **text)
        ends = averages(folder, row, RELAXATION, 3, seed=seed, boundary="p", temperature=FASTEST)
        found.append(ends[-1, 2] / ends[-1, 1] ** 2)
    return np.array(found)


def compared(folder, which, measure):
    """Our number of one row and the mean of what SPARTA gives by `measure`, each with its standard error."""
    row = next(row for row in json.loads((folder / "dilute.json").read_text()) if row["name"] == which)
    with TemporaryDirectory() as made:
        values = measure(Path(made), row)
    theirs, error = values.mean(), values.std(ddof=1) / math.sqrt(len(values))
    distance = abs(row["ours"] - theirs) / math.hypot(row["error"], error)
    texts = (
        f"{value:.5g} ± {spread:.2g}" for value, spread in ((row["ours"], row["error"]), (theirs, error))
    )
    return Finding(*texts, float(distance), 3.0, SIGMA)
