"""Energy of a run of any scene: energy of the particles, and exchanged energy."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import xarray as xr

from gaspart.analysis.fluxes import particle_numbers
from gaspart.analysis.statistics import autocorrelation_time
from gaspart.errors import SceneError
from gaspart.scene.scene import Scene
from gaspart.scene.surfaces import Sticky, Well
from gaspart.state.initial import places_in_wells, well_energies
from gaspart.state.insertion import per_particle
from gaspart.trajectory.opening import open_netcdf_file
from gaspart.trajectory.reading import open_trajectory
from gaspart.trajectory.recipe import read_recipe

_FRAMES = 64  # maximum number of values in memory


def energy_line(scene: Scene, data: xr.Dataset) -> str:
    """Return a line that states the energy drift of a run. In every scene the total energy minus the energy
    that contacts, faces and kicks exchange with the particles is conserved. Its drift is relative to the
    largest kinetic energy.
    """
    kinetic = data["kinetic_energy"].values
    try:
        total = conserved_energy(scene, data)
    except SceneError as error:
        ends = f"kinetic energy from {kinetic[0]:.6g} to {kinetic[-1]:.6g}"
        return f"{ends}; drift of the energy not known: {error.rule}"
    scale = max(float(kinetic.max()), np.finfo(float).tiny)
    drift = np.abs(total - total[0]).max() / scale
    text = f"drift of the energy: {drift:.1e} of it at most"
    if _removed_energy(data).any():
        text += ", less what contacts, faces and kicks have exchanged"
    if scene.gravity is not None and "displacements" not in data:  # it follows from the positions
        text += " (positions have single precision)"
    return text


def conserved_energy(scene: Scene, data: xr.Dataset) -> np.ndarray:
    """Compute the conserved energy (T,) of the frames, up to a constant. The conserved energy is the sum of
    the kinetic, vibrational, potential and exchanged energy. Raises SceneError if the file does not contain
    the energy.
    """
    energy = data["kinetic_energy"].values + _removed_energy(data)
    if "vibrations" in data:
        energy += data["vibrations"].values.sum(axis=1)
    if scene.gravity is None and not any(isinstance(face, Well) for face in scene.faces.values()):
        return energy
    if data.sizes["atom"] < scene.count:
        raise SceneError("follow", data.sizes["atom"], "the file has not all particles")
    if "coordinates" not in data:
        raise SceneError("keep", data.attrs["keep"], "the file has no positions")
    if any(isinstance(face, Sticky) for face in scene.faces.values()):
        raise SceneError("faces", "sticky", "the file does not say which particles stick")
    frames = len(energy)
    for first in range(0, frames, _FRAMES):
        part = slice(first, first + _FRAMES)
        energy[part] += _potential(scene, data.isel(frame=part))
    return energy


def _removed_energy(data: xr.Dataset) -> np.ndarray:
    """Return the energy (T,) removed by contacts and faces since time 0, minus kicks."""
    removed = data["dissipated_energy"].values + data["wall_energy"].values.sum(axis=1)
    return np.asarray(removed - data["thermostat_energy"].values, dtype=float)


def _potential(scene: Scene, data: xr.Dataset) -> np.ndarray:
    """Compute the energy (T,) under gravity, from displacements relative to time 0, and in wells."""
    positions = data["coordinates"].values.astype(float)
    energy = np.zeros(len(positions))
    if scene.gravity is not None:
        falls = [along and g != 0.0 for along, g in zip(scene.container.periodic, scene.gravity, strict=True)]
        if any(falls) and "displacements" not in data:
            raise SceneError("displacements", False, "a fall through periodic faces needs --displacements")
        ways = data["displacements"].values if "displacements" in data else positions
        masses = np.where(per_particle(scene, "fixed").astype(bool), 0.0, per_particle(scene, "mass"))
        energy -= np.einsum("n,tnd,d->t", masses.astype(float), ways, np.array(scene.gravity))
    radii = per_particle(scene, "radius").astype(float)
    if any(isinstance(face, Well) for face in scene.faces.values()):
        energy += [well_energies(scene, places_in_wells(scene, row, radii)).sum() for row in positions]
    return energy


# Certificate of a gaspart run: its quality in a few lines, from its counters.


def certificate(path: Path) -> list[str]:
    """Return lines that state the energy drift, the worst contact, and the independent samples."""
    scene = read_recipe(path).scene
    with open_netcdf_file(path) as file:
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
    """Return a line that states the numbers of particles in an open run, and its capacity."""
    counts = particle_numbers(scene, data)
    ends = f"{counts[0]} particles at the start, {counts[-1]} at the end"
    return f"{ends}, {counts.min()} to {counts.max()} in between; room for {scene.capacity}"


def _contacts(series: dict) -> str:
    """Return a line that states the errors of the engine, from its counters."""
    counted = f"{series['collisions'][-1]:.0f} collisions"
    if "overlaps_left" in series:
        deepest, remaining = series["deepest_overlap"][-1], series["overlaps_left"][-1]
        overlaps = f"deepest overlap {deepest:.2g} of a contact distance, {remaining:.0f} left after a step"
        return f"{counted}; {overlaps}"
    return f"{counted}; worst contact off by {series['worst_contact'][-1]:.1e} of its distance, squared"


def _samples(scene: Scene, series: dict) -> str:
    """Return a line that states the number of independent values of the pressure. This is the intervals over
    twice their correlation time, or the collisions if these are fewer.
    """
    counted = np.diff(series["virial_sum"])
    per_particle = 2.0 * series["collisions"][-1] / max(scene.count, 1)
    collisions = f"{per_particle:.4g} collisions per particle"
    if not series["collisions"][-1]:
        return f"{collisions}; no sample of the pressure"
    if len(counted) < 4:
        return collisions
    independent = min(len(counted) / (2.0 * autocorrelation_time(counted)), series["collisions"][-1])
    return f"{collisions}; {independent:.3g} independent samples of the pressure in {len(counted)} intervals"
