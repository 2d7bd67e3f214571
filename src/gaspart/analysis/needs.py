"""What an observable needs of a scene and of what a run keeps, known before anything is run.

The function of the observable is given two frames that were never simulated, of a few particles of the scene,
without any contact: what it refuses of them, beside their small number, it refuses of every run.
"""

from __future__ import annotations

from dataclasses import fields, replace
from typing import Any

import numpy as np
import xarray as xr

from gaspart.analysis.measuring import measure
from gaspart.analysis.observables import TOO_SHORT
from gaspart.errors import SceneError
from gaspart.scene.scene import Scene
from gaspart.state.insertion import per_particle
from gaspart.state.optional_tallies import tallied_fields, tallies_of
from gaspart.state.tally import Tally
from gaspart.trajectory.correlator import Correlations, sum_names
from gaspart.trajectory.pairs import pairs_of
from gaspart.yaml_text import dump_yaml

_OF_RUN = (*TOO_SHORT, "sample_interval")
"""Those that a run with other frames may not have."""
_FEW = 32  # particles of each kind: enough for an error


def require_of(
    name: str,
    scene: Scene,
    *,
    correlations: Correlations | None = None,
    displacements: bool = False,
    pairs: bool = False,
    follow: int | None = None,
) -> None:
    """Raise SceneError for an observable that no run of a scene has, however long it is.

    name: as of `gaspart measure`; the others: what the run keeps, as of `gaspart.run`.
    """
    unrun = _unrun(_few(scene), correlations, displacements, pairs)
    if follow is not None and follow < scene.count:
        unrun = unrun.isel(atom=slice(max(1, min(follow, unrun.sizes["atom"] - 1))))
    try:
        measure(name, unrun, start=0.0)
    except SceneError as error:
        if error.key not in _OF_RUN:
            raise


def _few(scene: Scene) -> Scene:
    """The scene with a few of its particles, of each species as many as an error needs."""
    species = [replace(kind, count=min(kind.count, _FEW)) for kind in scene.species]
    return replace(scene, species=species, particles=scene.particles[:_FEW])


def _unrun(scene: Scene, correlations: Correlations | None, displacements: bool, pairs: bool) -> xr.Dataset:
    """Two frames, from time 0 to 1, of particles anywhere, which move and never meet."""
    count, dimension, random = scene.count, scene.dimension, np.random.default_rng(0)
    sizes = {"atom": count, "spatial": dimension, "face": 2 * dimension + len(scene.walls)}
    along: dict[str, tuple[str, ...]] = dict.fromkeys(("kinetic_energy", "piston_position"), ())
    tallies = (*tallies_of(scene), *(correlations.tallies if correlations else ()))
    for tally in tallies:
        sizes |= tally.axes(scene)
    counted = {*tallied_fields(tallies)} - {"time"}
    along |= {field.name: field.metadata.get("along", ()) for field in fields(Tally) if field.name in counted}
    if displacements:
        along["displacements"] = ("atom", "spatial")
    if pairs:
        along["pair_collisions"], sizes["pair"] = ("pair",), len(pairs_of(scene))
    attributes, lags = {"scene": dump_yaml(scene.to_dict())}, {}
    if correlations is not None:
        names, sizes["lag"] = sum_names(correlations, displacements), correlations.lags + 1
        along |= {"correlated_samples": (), **dict.fromkeys(names, ("lag",))}
        attributes["correlations"] = correlations.to_json()
        lags = {"lag": correlations.interval * np.arange(sizes["lag"])}
    data: dict[str, Any] = {
        name: (("frame", *axes), np.zeros((2, *(sizes[axis] for axis in axes))))
        for name, axes in along.items()
    }
    particles = ("frame", "atom", "spatial")
    data["coordinates"] = particles, random.uniform(size=(2, count, dimension)) * scene.container.lengths
    data["velocities"] = particles, random.standard_normal(size=(2, count, dimension))
    squares = (data["velocities"][1] ** 2).sum(axis=2)
    data["kinetic_energy"] = "frame", 0.5 * squares @ per_particle(scene, "mass").astype(float)
    return xr.Dataset({"time": ("frame", [0.0, 1.0]), **data}, lags, attributes)
