"""Checks of a run of gaspart with open faces, in which the number of particles changes."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import xarray as xr

from gaspart.analysis.fluxes import particle_numbers
from gaspart.inspection.checks import judge_places
from gaspart.inspection.conserved import judge_flights
from gaspart.inspection.energy import conserved_energy
from gaspart.inspection.frames import Frames
from gaspart.inspection.verdict import Check
from gaspart.scene.scene import Scene
from gaspart.trajectory.reading import open_trajectory
from gaspart.trajectory.recipe import read_recipe

ENERGY_DRIFT = 1e-9
"""Largest drift of the energy, relative to the energy that particles have had and have carried."""
_CHANGING = "particles come and go: its theory is of those that stay"


def judge_open(path: Path, tolerance: float | None = None) -> tuple[str, list[Check]]:
    """Check a trajectory with open faces.

    Returns a line that names its particles, and the checks of positions, of the books of particles and of
    energy, and of flights. `tolerance` is the allowed overlap, as a fraction of a diameter.
    """
    scene = read_recipe(path).scene
    with open_trajectory(path) as data:
        data.load()
    counts = particle_numbers(scene, data)
    kind = "discs" if scene.dimension == 2 else "spheres"
    title = f"{path}: {counts.min()} to {counts.max()} {kind} in {len(counts)} frames"
    checks = [_particles(data, counts), _energy(scene, data)]
    if "keep" not in data.attrs:
        frames = _frames(scene, data)
        checks = [*judge_places(frames, tolerance), *checks, judge_flights(frames)]
    unknown = "speed law", "pressure Z", "diffusion coefficient D"
    return title, [*checks, *(Check(name, None, _CHANGING) for name in unknown)]


def _frames(scene: Scene, data: xr.Dataset) -> Frames:
    """Return the frames of a run; absent particles have no position (NaN), and are at rest."""
    lengths = np.array(scene.container.lengths)
    positions, velocities = (data[name].values.astype(float) for name in ("coordinates", "velocities"))
    return Frames(
        positions=positions,
        lengths=lengths,
        radii=data["radius"].values.astype(float),
        periodic=scene.container.periodic,
        velocities=np.nan_to_num(velocities),
        time=data["time"].values,
        resolution=float(np.finfo(np.float32).eps * lengths.max()),
        scene=scene,
    )


def _particles(data: xr.Dataset, counts: np.ndarray) -> Check:
    """Compare the particles in each frame with those that have entered and left since the start."""
    stored = data["coordinates"] if "coordinates" in data else data["velocities"]
    there = np.isfinite(stored.values[..., 0]).sum(axis=1)
    wrong = int(np.abs(there - counts).argmax())
    text = f"{counts[0]} at the start, with those that have entered less those that have left"
    if there[wrong] == counts[wrong]:
        return Check("particles", True, f"{text}, are in all frames")
    text += f", are {counts[wrong]} in frame {wrong}, which has {there[wrong]}"
    return Check("particles", False, text)


def _energy(scene: Scene, data: xr.Dataset) -> Check:
    """Compare the energy in each frame with what particles and faces have brought and taken."""
    total = conserved_energy(scene, data)
    carried = np.abs(data["wall_energy"].values).sum(axis=1)
    scale = max(float((data["kinetic_energy"].values + carried).max()), np.finfo(float).tiny)
    drift = float(np.abs(total - total[0]).max()) / scale
    text = f"changes by {drift:.1e} of itself at most, less what particles and faces have brought and taken"
    return Check("energy", drift <= ENERGY_DRIFT, text)
