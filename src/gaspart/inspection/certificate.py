"""The certificate of a run of gaspart: its quality in a few lines, from its counters."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import xarray as xr

from gaspart.analysis.occupancy import particle_numbers
from gaspart.analysis.statistics import autocorrelation_time
from gaspart.inspection.energy import energy_line
from gaspart.scene.scene import Scene
from gaspart.trajectory.opening import opened
from gaspart.trajectory.reading import open_trajectory
from gaspart.trajectory.recipe import read_recipe


def certificate(path: Path) -> list[str]:
    """Lines on the drift of the energy, the worst contact, and how many independent samples there are."""
    scene = read_recipe(path).scene
    with opened(path) as file:
        if not len(file.dimensions["frame"]):
            return ["no frame yet"]
        names = ["collisions", "virial_sum", "worst_contact", "time"]
        names += [name for name in ("deepest_overlap", "overlaps_left") if name in file.variables]
        series = {name: np.asarray(file[name][:], dtype=float) for name in names}
    with open_trajectory(path) as data:
        drift = energy_line(scene, data)
        samples = _inside(scene, data) if scene.is_open else _samples(scene, series)
    return [drift, _contacts(series), samples]


def _inside(scene: Scene, data: xr.Dataset) -> str:
    """How many particles there were in the frames of a run with open faces, and the room for them."""
    counts = particle_numbers(scene, data)
    ends = f"{counts[0]} particles at the start, {counts[-1]} at the end"
    return f"{ends}, {counts.min()} to {counts.max()} in between; room for {scene.capacity}"


def _contacts(series: dict) -> str:
    """Errors of the engine, from its counters."""
    counted = f"{series['collisions'][-1]:.0f} collisions"
    if "overlaps_left" in series:
        deepest, remaining = series["deepest_overlap"][-1], series["overlaps_left"][-1]
        overlaps = f"deepest overlap {deepest:.2g} of a contact distance, {remaining:.0f} left after a step"
        return f"{counted}; {overlaps}"
    return f"{counted}; worst contact off by {series['worst_contact'][-1]:.1e} of its distance, squared"


def _samples(scene: Scene, series: dict) -> str:
    """Independent values of the pressure: intervals between frames over twice their correlation time, but no
    more than there are collisions."""
    counted = np.diff(series["virial_sum"])
    per_particle = 2.0 * series["collisions"][-1] / max(scene.count, 1)
    collisions = f"{per_particle:.4g} collisions per particle"
    if not series["collisions"][-1]:
        return f"{collisions}; no sample of the pressure"
    if len(counted) < 4:
        return collisions
    independent = min(len(counted) / (2.0 * autocorrelation_time(counted)), series["collisions"][-1])
    return f"{collisions}; {independent:.3g} independent samples of the pressure in {len(counted)} intervals"
