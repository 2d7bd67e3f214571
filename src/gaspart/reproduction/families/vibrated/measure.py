"""Steady beds of inelastic discs over a vibrating floor."""

from __future__ import annotations

import math
from typing import Any

import xarray as xr

from gaspart.analysis.estimate import Estimate
from gaspart.analysis.flow import Grid
from gaspart.analysis.run import Run
from gaspart.analysis.statistics import means_of
from gaspart.reproduction.families.shared.runs import runs
from gaspart.reproduction.points.point import Point
from gaspart.reproduction.table import table
from gaspart.scene.faces import Vibrating

_FLOOR = 2  # the number of the face y_low


def vibrated_bed(points: list[Point], settings: dict) -> xr.Dataset:
    """Measure temperature, energy flows and density of vibrated beds of one kind of discs.

    The discs have the mass 1.

    The settings are `bins` of the density profile, and `highest`, the height up to which it reaches, over
    T/g. Returns over `bed`: sine, 1 if the floor's motion is a sine, 0 for a sawtooth; restitution; layers,
    (N - 1) d / width; packing_fraction that an ideal gas of the measured temperature has at the floor; speed,
    of the sawtooth, or the rms speed of the sine; temperature, of both components; given and lost, the
    energies per time that the floor gives and contacts take, over the weight; height, the mean height above
    the floor's lowest place times g over the vertical temperature; and over (bed, bin) density, the fraction
    of discs in a bin over its width, in units of T/g, at `place`. All with errors from replicas.
    """
    units = {"temperature": "energy", **dict.fromkeys(("speed", "given", "lost"), "length / time")}
    beds = table("bed", points, _measure_bed, settings, inner=("bin",), units=units)
    return beds.assign_coords(place=("bin", _grid(settings).middles[0]))


def _grid(settings: dict) -> Grid:
    return Grid.line(0.0, settings["highest"], settings["bins"])


def _measure_bed(point: Point, settings: dict) -> dict[str, Any]:
    scene = point.scene
    floor, species, law = scene.faces["y_low"], scene.species[0], scene.restitution
    assert isinstance(floor, Vibrating) and law is not None and scene.gravity is not None
    width, sine = scene.container.lengths[0], floor.waveform == "sine"
    row: dict[str, Any] = {
        "sine": int(sine),
        "restitution": law.normal,
        "layers": (species.count - 1) * 2.0 * species.radius / width,
        "speed": floor.greatest_speed / math.sqrt(2.0) if sine else floor.greatest_speed,
    }
    replicas = [means(run, settings) for run in runs(point)]
    for name in replicas[0]:
        row[name] = Estimate(*means_of([replica[name] for replica in replicas]), len(replicas) - 1)
    weight = species.count * -scene.gravity[1] / width
    row["packing_fraction"] = math.pi * species.radius**2 * weight / row["temperature"].value
    return row


def means(run: Run, settings: dict) -> dict[str, Any]:
    """Measure the numbers of a run, by the names of `vibrated_bed`."""
    scene = run.scene
    assert scene.gravity is not None
    gravity = -scene.gravity[1]
    heights = run.positions[..., 1] - scene.species[0].radius
    across, along = (run.velocities**2).mean(axis=(0, 1))
    temperature = 0.5 * (across + along)
    weight = scene.count * gravity
    grid = _grid(settings)
    counts = grid.sums(grid.cells((heights * gravity / temperature)[..., None]))
    return {
        "temperature": temperature,
        "given": -run.growth("wall_energy")[_FLOOR] / weight,
        "lost": run.growth("dissipated_energy") / weight,
        "height": heights.mean() * gravity / along,
        "density": counts / (heights.size * grid.volume),
    }
