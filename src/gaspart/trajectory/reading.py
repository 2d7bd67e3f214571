"""Trajectories as datasets with dimensions, coordinates and units; values are read on demand."""

from __future__ import annotations

from dataclasses import fields
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from gaspart.errors import SceneError
from gaspart.state.tally import ENERGY, Tally
from gaspart.trajectory import amber
from gaspart.trajectory.correlator import pair_names, stress_units
from gaspart.trajectory.opening import open_checked, run_path
from gaspart.trajectory.recipe import Recipe, stored_recipe

if TYPE_CHECKING:
    import xarray as xr

_REDUCED = {
    "angstrom": "length",
    "picosecond": "time",
    "angstrom/picosecond": "length/time",
    "1/picosecond": "1/time",
}
_UNUSED = ["spatial", "cell_spatial", "cell_angular", "checksum", *amber.INITIAL]
"""Variables of a file that `open_trajectory` does not read.

These variables are names of axes, checksums, and variables that belong to the recipe.
"""
GIVEN_START = "given_start"
"""Attribute that is 1 for a trajectory that starts from a state supplied by the user."""
_UNITS = {field.name: field.metadata["units"] for field in fields(Tally) if "units" in field.metadata} | {
    "kinetic_energy": ENERGY,
    "mass": "mass",
    "vibrations": ENERGY,
    "velocity_product_sum": "length^2/time^2",
    "squared_displacement_sum": "length^2",
    "displacement_velocity_sum": "length^2/time",
    **stress_units(),
}


def open_trajectory(path: str | Path) -> xr.Dataset:
    """Open a trajectory, or the finished part of a `.partial` file, as an xarray.Dataset.

    Values are read on demand. Close the Dataset, or use it in a `with` statement.

    Attributes contain the scene (YAML), the engine and the seed (JSON), and properties of the scene:
    dimension and, unless faces are open, count, packing_fraction and number_density. The attribute
    given_start is 1 if the run starts from a state that the user supplied.

    With open faces, the dimension atom counts particle numbers. If no particle in the container has a number
    in a frame, its coordinates and velocities are NaN.

    When a file is opened, only the times of its frames are read. The checksum of a frame is for all of its
    variables together, so that all of them are read before one of them is used.

    Parameters
    ----------
    path : str or Path
        The trajectory.

    Returns
    -------
    Dataset
        The dimensions are frame, atom, spatial (d) and face (2d); a run with correlations also has lag. The
        coordinates are time (frame), and radius, mass and type (atom). Plots over frames have the time as
        their axis. Lengths and times are in the scene's units. Counters are cumulative since time 0. Spins
        have the shape (frame, atom) for discs, and (frame, atom, spatial) for spheres.

    Raises
    ------
    SceneError
        If the file is unreadable, truncated, damaged in its header, or not written by gaspart. SceneError is
        also raised when a damaged frame is read for the first time.

    Examples
    --------
    >>> import gaspart as gp
    >>> scene = gp.Scene(gp.Container((9.0, 9.0)), [gp.Species(20, 0.2, temperature=1.0)])
    >>> path = gp.run(scene, seed=1, duration=2.0, sample_interval=0.1, path="gas.nc")
    >>> with gp.open_trajectory(path) as trajectory:
    ...     trajectory["coordinates"].sizes["atom"], trajectory.attrs["count"]
    (20, 20)
    """
    import xarray as xr

    from gaspart.trajectory.checked_store import CheckedStore, Trajectory

    path = run_path(path)
    file, checked = open_checked(path)
    try:
        recipe = stored_recipe(file, path)
        store = CheckedStore(file, path, checked, recipe.sample_interval)
    except SceneError:
        file.close()
        checked.close()
        raise
    scene = recipe.scene
    data = opened = xr.open_dataset(store, decode_times=False, drop_variables=_UNUSED)
    attributes = {**data.attrs, **_following(recipe)}
    if "spins" in data and scene.dimension == 2:
        data["spins"] = data["spins"].isel(spatial=2)
    # files before version 0.3 have no masses
    named = [name for name in ("time", "radius", "mass", "type") if name in data]
    data = data.isel(spatial=slice(scene.dimension)).set_coords(named)
    faces = amber.face_names(scene.dimension, len(scene.walls))
    if "piston" in data:
        data = _with_piston(data)
    coordinates: dict = {"spatial": list("xyz"[: scene.dimension]), "face": faces}
    if recipe.pairs:
        coordinates["pair"] = ("pair", pair_names(scene), {"long_name": "numbers of two species, from 0"})
    if recipe.correlations:
        lags = recipe.correlations.interval * np.arange(data.sizes["lag"])
        coordinates["lag"] = ("lag", lags, {"units": "time"})
    coordinates["frame"] = ("frame", data["time"].values, {"long_name": "time", "units": "time"})
    data = data.assign_coords(coordinates)  # in one call, because each call copies everything
    for key, variable in data.variables.items():
        name = str(key)
        unit = variable.attrs.get("units", "1")
        if variable.dtype.kind in "fi":  # values other than lengths, times and energies are counts or ratios
            variable.attrs["units"] = _UNITS.get(name, _REDUCED.get(unit, unit))
    kept = {key: value for key, value in attributes.items() if key not in amber.BOOKKEEPING}
    data = Trajectory(data.data_vars, data.coords, kept)

    def close() -> None:
        opened.close()
        checked.close()

    data.set_close(close)
    return data


def _following(recipe: Recipe) -> dict[str, float]:
    """Return the attributes that follow from the scene and the initial state."""
    scene = recipe.scene
    start = {GIVEN_START: 1} if recipe.initial is not None else {}
    names = ("dimension", *(() if scene.is_open else ("count", "packing_fraction", "number_density")))
    return {name: getattr(scene, name) for name in names} | start


def _with_piston(data: xr.Dataset) -> xr.Dataset:
    """Return a dataset with position and velocity of a piston as two variables with units."""
    position, velocity = (data["piston"].isel(motion=n, drop=True) for n in (0, 1))
    position.attrs, velocity.attrs = (
        {"units": unit, "long_name": f"{name} of the piston along its axis"}
        for unit, name in (("length", "place"), ("length/time", "velocity"))
    )
    return data.drop_vars("piston").assign(piston_position=position, piston_velocity=velocity)
