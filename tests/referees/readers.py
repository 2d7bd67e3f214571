"""Programs that open the exported states of gaspart: the same positions, container and times."""

import MDAnalysis
import mdtraj
import numpy as np
from finding import LENGTH, Finding
from ovito.io import import_file

FRAMES = 0, 17, -1
"""Of gas.nc, that are compared; GSD and data files have the last one."""
RESOLUTION = 1e-6
"""Allowed difference: single precision of lengths of 12."""


def compared(folder, read):
    """The largest difference from what gaspart reads. read: list of (frame, positions (N, 3), lengths (3,) of
    the container, time or None); positions may be those of periodic images."""
    ours = np.load(folder / "gas.npz")
    lengths, worst = ours["lengths"], 0.0
    for frame, positions, container, time in read:
        apart = np.asarray(positions, dtype=float) - ours["positions"][frame]
        apart -= lengths * np.round(apart / lengths)
        differences = [apart, np.asarray(container, dtype=float) - lengths]
        differences += [] if time is None else [time - ours["times"][frame]]
        worst = max(worst, *(float(np.abs(found).max()) for found in differences))
    number = f"{len(read)} frame{'s' if len(read) > 1 else ''} of {len(ours['positions'][0])}"
    return Finding(number, "the same" if worst <= RESOLUTION else "different", worst, RESOLUTION, LENGTH)


def mdanalysis_gsd(folder):
    frame = MDAnalysis.Universe(str(folder / "gas.gsd")).trajectory[0]
    lengths = frame.dimensions[:3]
    return compared(folder, [(-1, frame.positions + 0.5 * lengths, lengths, None)])


def mdanalysis_data(folder):
    columns = "id type diameter density x y z"
    frame = MDAnalysis.Universe(str(folder / "gas.data"), atom_style=columns).trajectory[0]
    return compared(folder, [(-1, frame.positions, frame.dimensions[:3], None)])


def mdtraj_gsd(folder):
    frame = mdtraj.load(str(folder / "gas.gsd"))
    lengths = frame.unitcell_lengths[0]
    return compared(folder, [(-1, frame.xyz[0] + 0.5 * lengths, lengths, None)])


def ovito(folder, suffix):
    """In OVITO a cell has an origin, so that positions are where they are."""
    pipeline = import_file(str(folder / f"gas{suffix}"))
    frames = []
    for k in FRAMES if suffix == ".nc" else FRAMES[-1:]:
        data = pipeline.compute(k % pipeline.source.num_frames)
        origin = np.asarray(data.cell)[:, 3]
        place = np.asarray(data.particles.positions) - origin
        time = data.attributes.get("time")
        frames.append((k, place, np.diag(np.asarray(data.cell)[:, :3]), time))
    return compared(folder, frames)
