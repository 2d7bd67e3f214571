"""Observables from positions and speeds: distributions, profiles and order.

Uncertainties are the scatter of consecutive stretches of the run, or of groups of particles.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np

from gaspart import theory
from gaspart.analysis.observable import Observable, observable, scalar
from gaspart.analysis.pairs import STRETCHES, chosen_frames
from gaspart.analysis.run import Run, Source, measured, require_periodic
from gaspart.analysis.statistics import means_of
from gaspart.errors import SceneError
from gaspart.scene.validation import choice, count_of

_POINTS = 2**14
_RATIOS = {2: 1.32471795724474602596, 3: 1.22074408460575947536}
"""Whose powers give evenly spread points: x^(d + 1) = x + 1 (Roberts 2018)."""
_NEIGHBOURHOOD = {2: 7, 3: 13}  # a particle and those around it in a crystal
_CONSTANT = 1e-5  # relative change of an energy that is attributed to rounding
FASTEST = 4.0
"""The histogram of speeds ends at this many thermal speeds sqrt(k_B T / m)."""


def speed_distribution(source: Source, bins: int = 40, start: float | None = None) -> Observable:
    """Density of the speeds of moving particles, (speed,), in time / length, of all frames together.

    source: a trajectory, by its path or open, or a simulation; bins: up to four thermal speeds; start: the
    time from which frames count (by default a quarter of the run). Velocities are those about the centre of
    mass where that is conserved, times sqrt(N / (N - 1)). The error is the scatter of groups of particles.
    Theory: Maxwell's, of the run's own temperature; of one species at a constant kinetic energy the exact one
    for their number. Raises SceneError for fewer than 16 moving particles, and for particles at rest.
    """
    bins = count_of("bins", bins, least=2)
    with measured(source, start) as run:
        if run.moving.sum() < STRETCHES:
            raise SceneError("count", int(run.moving.sum()), f"an error needs {STRETCHES} moving particles")
        masses, temperature = run.masses[run.moving], run.temperature
        if not temperature > 0.0:
            raise SceneError("temperature", temperature, "particles at rest have no distribution")
        free = np.where(run.conserved, len(masses) / (len(masses) - 1), 1.0)
        squares = run.peculiar**2
        speeds = np.sqrt((free * squares).sum(axis=2))
        edges = np.linspace(0.0, FASTEST * np.sqrt(temperature / masses.min()), bins + 1)
        # every group has a share of each species, which come one after the other
        groups = [speeds[:, first::STRETCHES] for first in range(STRETCHES)]
        found = np.array([np.histogram(part, edges)[0] / part.size / np.diff(edges) for part in groups])
        values, errors = means_of(found)
        expected: dict[str, Any] = {}
        if np.ptp(masses) == 0.0:
            energy = squares.sum(axis=(1, 2))
            fixed = np.ptp(energy) <= _CONSTANT * energy.mean()
            freedoms = run.freedom if fixed else None
            law = theory.maxwell_cdf(edges, run.dimension, temperature, masses[0], freedoms)
            name = f"Maxwell's distribution{', of this number at fixed energy' if fixed else ''}"
            expected = {"theory": (np.diff(law) / np.diff(edges), 0.0), "source": name}
        middle = 0.5 * (edges[1:] + edges[:-1])
        along = {"speed": (middle, {"units": "length / time", "long_name": "speed"})}
        about: dict[str, Any] = {"units": "time / length", "long_name": "density of speeds", **expected}
        return observable("speed_distribution", along, values, errors, **about)


def profile(
    source: Source,
    of: str = "density",
    axis: str | None = None,
    bins: int = 40,
    start: float | None = None,
) -> Observable:
    """Profile of a property along an axis, (position,), mean over all frames.

    of: "density", moving particles per volume, without that from which fixed particles keep their centres
    (NaN where nothing is left), or "temperature" of the moving particles (NaN where there are none); axis:
    "x", "y" or "z", by default the last one. Errors are 0 where nothing moves. Theory: the density of equal
    particles under gravity along this axis, by hydrostatics with the fluid's equation of state; a uniform
    temperature in equilibrium. Raises SceneError for an unknown property or axis, and for too few frames.
    """
    choice("of", of, ("density", "temperature"))
    bins = count_of("bins", bins, least=2)
    with measured(source, start) as run:
        names = "xyz"[: run.dimension]
        k = names.index(choice("axis", names[-1] if axis is None else axis, tuple(names)))
        edges = np.linspace(0.0, run.scene.container.lengths[k], bins + 1)
        parts = np.array_split(np.arange(len(run.time)), min(STRETCHES, len(run.time)))
        if len(parts) < STRETCHES:
            raise SceneError("frames", len(run.time), f"an error needs {STRETCHES} or more")
        measure = _density(run, k, edges) if of == "density" else partial(_temperature, run, k, edges)
        samples = np.array([measure(part) for part in parts])
        values, errors = means_of(samples - samples[0])  # no error of rounding where nothing moves
        values += samples[0]
        middle = 0.5 * (edges[1:] + edges[:-1])
        expected = _theory_of_density(run, k, edges) if of == "density" else _theory_of_temperature(run)
        along = {"position": (middle, {"units": "length", "long_name": names[k]})}
        units = f"1 / length^{run.dimension}" if of == "density" else "energy"
        long_name = "number density" if of == "density" else "temperature"
        return observable(of, along, values, errors, units=units, long_name=long_name, **expected)


def order_parameter(source: Source, start: float | None = None) -> Observable:
    """Global bond order of a periodic scene, dimensionless: |<psi_6>| of discs, Q_6 of spheres.

    1 in a triangular lattice of discs, 0.5745 in a face-centred cubic one, small in a fluid (about
    1 / sqrt(12 N) for spheres). Raises SceneError for walls and for too few frames.
    """
    from gaspart.analysis.order import global_steinhardt, hexatic

    with measured(source, start) as run:
        require_periodic(run)
        if run.data.sizes["atom"] < run.count:
            rule = f"neighbours are among all {run.count} particles, which the file has not"
            raise SceneError("follow", run.data.sizes["atom"], rule)
        if run.count < _NEIGHBOURHOOD[run.dimension]:
            raise SceneError("count", run.count, f"needs {_NEIGHBOURHOOD[run.dimension]} particles or more")
        lengths = run.scene.container.lengths
        frames, time = chosen_frames(run, run.positions), chosen_frames(run, run.time)
        if run.dimension == 2:
            series, name = [abs(hexatic(frame, lengths).mean()) for frame in frames], "|psi_6|"
        else:
            series, name = [global_steinhardt(frame, lengths) for frame in frames], "Q_6"
        edges = np.append(time, 2.0 * time[-1] - time[-2])
        about: dict[str, Any] = {"units": "1", "long_name": f"bond order {name}"}
        return scalar("order_parameter", np.array(series, dtype=float), edges, **about)


def _density(run: Run, axis: int, edges: np.ndarray) -> Callable[[np.ndarray], np.ndarray]:
    """The function that gives the profile of a part of the frames. Raises SceneError for a file that holds
    the first particles of several kinds only."""
    stored = run.data.sizes["atom"]
    if stored < run.count and len(run.scene.kinds) > 1:
        raise SceneError("follow", stored, f"needs all {run.count} particles, of several kinds, in the file")
    free, radii = np.isfinite(run.masses[:stored]), run.radii[:stored]
    kinds = [free]
    if not np.isfinite(run.masses).all():  # fixed particles leave less room to larger ones
        kinds = [free & (radii == radius) for radius in np.unique(radii[free])]
    rooms = [_room(run, radii[members][0], axis, edges) for members in kinds]
    empty = np.where(np.any(rooms, axis=0), 0.0, np.nan) if kinds else np.zeros(len(edges) - 1)

    def density(part: np.ndarray) -> np.ndarray:
        places, found = run.positions[part][:, :, axis], empty.copy()
        for members, room in zip(kinds, rooms, strict=True):
            count = np.histogram(places[:, members], edges)[0] * (run.count / stored)
            found += np.divide(count, len(part) * room, out=np.zeros_like(room), where=room > 0.0)
        return found

    return density


def _room(run: Run, radius: float, axis: int, edges: np.ndarray) -> np.ndarray:
    """(bins,) volume of each bin, without that from which fixed particles keep centres of particles of this
    radius: the share of `_POINTS` points, spread evenly over the bin."""
    container, fixed = run.scene.container, ~np.isfinite(run.masses)
    lengths, widths = np.array(container.lengths), np.diff(edges)
    volumes = container.volume / lengths[axis] * widths
    if not fixed.any():
        return volumes
    from scipy.spatial import cKDTree

    ratio = _RATIOS[run.dimension] ** -np.arange(1.0, run.dimension + 1)
    points = np.outer(np.arange(_POINTS), ratio) % 1.0 * lengths
    across = points[:, axis] / lengths[axis]
    centres = np.where(run.periodic, run.positions[0] % lengths, run.positions[0])
    period = np.where(run.periodic, lengths, 0.0)
    sizes = np.unique(run.radii[fixed])
    trees = [cKDTree(centres[fixed & (run.radii == size)], boxsize=period) for size in sizes]
    for n, width in enumerate(widths):
        points[:, axis] = edges[n] + width * across
        left = np.ones(_POINTS, dtype=bool)
        for size, tree in zip(sizes, trees, strict=True):
            left &= ~np.isfinite(tree.query(points, distance_upper_bound=size + radius)[0])
        volumes[n] *= left.mean()
    return volumes


def _temperature(run: Run, axis: int, edges: np.ndarray, part: np.ndarray) -> np.ndarray:
    """Twice the kinetic energy of flight per degree of freedom; NaN in empty bins."""
    places = run.positions[part][:, run.moving, axis].ravel()
    moving = run.peculiar[part]
    energy = 0.5 * (moving**2).sum(axis=2) * run.masses[run.moving]
    share = run.dimension * int(run.moving.sum()) / run.freedom
    count = np.histogram(places, edges)[0]
    total = np.histogram(places, edges, weights=energy.ravel())[0]
    with np.errstate(invalid="ignore", divide="ignore"):
        return 2.0 * share * total / (run.dimension * count)


def _theory_of_temperature(run: Run) -> dict[str, Any]:
    if run.scene.faces or run.dissipates or run.scene.thermostat:
        return {}
    return {"theory": (run.temperature, 0.0), "source": "equilibrium"}


def _theory_of_density(run: Run, axis: int, edges: np.ndarray) -> dict[str, Any]:
    scene, kinds = run.scene, run.scene.kinds
    field = 0.0 if scene.gravity is None else scene.gravity[axis]
    across = scene.gravity is not None and any(g for n, g in enumerate(scene.gravity) if n != axis)
    equal = scene.alike and not any(kind.fixed for kind in kinds)
    if not equal or scene.walls or scene.faces or across or not (field or run.periodic[axis]):
        return {}
    if field and (run.dissipates or run.followed or not run.temperature > 0.0):
        return {}  # in no equilibrium, or of unknown temperature
    if not field:
        return {"theory": (scene.number_density, 0.0), "source": "uniform"}
    lower, upper = scene.reach(kinds[0].radius)
    z = np.linspace(lower[axis], upper[axis], 2001)
    down = z if field < 0.0 else z[::-1]
    area = scene.container.volume / scene.container.lengths[axis]
    weight = kinds[0].mass * abs(field) / run.temperature
    try:
        found = theory.hydrostatic_profiles(
            z, [run.count / area], [weight], run.dimension, 2.0 * kinds[0].radius
        )[0]
    except ValueError:  # denser than theory goes
        return {}
    total = np.concatenate([[0.0], np.cumsum(0.5 * (found[1:] + found[:-1]) * np.diff(z))])
    if down is not z:
        total = total[-1] - total[::-1]
    share = np.diff(np.interp(edges, z, total))
    return {"theory": (share / np.diff(edges), np.nan), "source": "hydrostatics, local equation of state"}
