"""Recipes of docs/tools.md: positions, velocities, energies, pairs of six scenes as other programs read them.

The blocks of that page are run as they stand there.
"""

import re
import warnings
from functools import cache
from pathlib import Path

import numpy as np
from finding import PART, Finding
from heaps import lammps

PAGE = Path(__file__).parents[2] / "docs/tools.md"
SCENES = "periodic", "walls", "discs", "species", "open", "piston"
REACH = 1.5
"""Distance of the pairs that are counted: three radii, beyond contact."""
RESOLUTION = 1e-6
"""Allowed deviation, in units of a diameter, the thermal speed, or relative: single precision."""
SUFFIXES = {
    "freud": ".gsd",
    "lammps": ".data",
    **{f"{name}_xyz": ".xyz" for name in ("ase", "ovito", "chemfiles")},
}


@cache
def recipes():
    """The functions of the page, by name."""
    names = {}
    for text in re.findall(r"^```py\n(.*?)^```", PAGE.read_text(encoding="utf-8"), re.M | re.S):
        exec(compile(text, PAGE.name, "exec"), names)
    return names


def read(program, path):
    """What a program reads in a file, frame by frame."""
    more = (lammps(),) if program == "lammps" else ()
    with warnings.catch_warnings(action="ignore"):  # of units and elements that a gas does not have
        return list(recipes()[f"with_{program}"](str(path), REACH, *more))


def compared(folder, program):
    """The largest deviation of all that a program reads in any frame of any scene."""
    ours, worst, frames, where = np.load(folder / "readers.npz"), 0.0, 0, ""
    for scene in SCENES:
        path = folder / f"reader_{scene}{SUFFIXES.get(program, '.nc')}"
        found = read(program, path)
        frames += len(found)
        first = len(ours[f"{scene}_time"]) - len(found)  # data files have the last frame
        for n, frame in enumerate(found, first):
            deviation = deviation_of(frame, {key: ours[f"{scene}_{key}"][n] for key in KEYS}, path.suffix)
            if not deviation <= worst:
                worst, where = deviation, f" ({scene})"
    number = f"{frames} frames of {len(SCENES)} scenes"
    return Finding(
        number, "the same" if worst <= RESOLUTION else f"different{where}", worst, RESOLUTION, PART
    )


KEYS = "positions", "velocities", "energy", "lengths", "time", "pairs"


def deviation_of(frame, ours, suffix):
    """The largest deviation in a frame; a pair more or less is one of 1."""
    positions, velocities, energy, lengths, time, pairs = frame
    inside = np.isfinite(ours["positions"]).all(axis=1)
    if len(positions) != inside.sum():
        return np.inf
    apart = positions - ours["positions"][inside]
    apart -= ours["lengths"] * np.round(apart / ours["lengths"])
    flat = 2 if suffix == ".gsd" and not lengths[2] else 3  # GSD has no height of discs
    deviations = [apart, velocities - ours["velocities"][inside], energy / ours["energy"] - 1.0]
    deviations += [lengths[:flat] / ours["lengths"][:flat] - 1.0, float(pairs - ours["pairs"])]
    deviations += [] if time is None else [time - ours["time"]]
    return max(float(np.abs(values).max(initial=0.0)) for values in deviations)
