"""Observables from positions and speeds: distributions, profiles and order.

Uncertainties are the scatter of consecutive stretches of the run, or of groups of particles.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

import numpy as np

from gaspart.analysis.expected.described import described
from gaspart.analysis.observable import Observable, observable, scalar
from gaspart.analysis.observables import having, require_defined
from gaspart.analysis.pairs import STRETCHES, chosen_frames
from gaspart.analysis.run import Run, Source, measured
from gaspart.analysis.statistics import means_of
from gaspart.errors import SceneError
from gaspart.scene.validation import choice, count_of

_POINTS = 2**14
_RATIOS = {2: 1.32471795724474602596, 3: 1.22074408460575947536}
"""Whose powers give evenly spread points: x^(d + 1) = x + 1 (Roberts 2018)."""
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
        require_defined("speeds", run.scene)
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
        energy = squares.sum(axis=(1, 2))
        fixed = np.ptp(energy) <= _CONSTANT * energy.mean()
        about = described("speeds", run, edges, masses[0] if np.ptp(masses) == 0.0 else None, fixed)
        middle = 0.5 * (edges[1:] + edges[:-1])
        along = {"speed": (middle, {"units": "length / time", "long_name": "speed"})}
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
    choice("of", of, having(function="profile"))
    bins = count_of("bins", bins, least=2)
    with measured(source, start) as run:
        require_defined(of, run.scene, axis=axis)
        names = "xyz"[: run.dimension]
        k = names.index(names[-1] if axis is None else axis)
        edges = np.linspace(0.0, run.scene.container.lengths[k], bins + 1)
        parts = np.array_split(np.arange(len(run.time)), min(STRETCHES, len(run.time)))
        if len(parts) < STRETCHES:
            raise SceneError("frames", len(run.time), f"an error needs {STRETCHES} or more")
        measure = _density(run, k, edges) if of == "density" else partial(_temperature, run, k, edges)
        samples = np.array([measure(part) for part in parts])
        values, errors = means_of(samples - samples[0])  # no error of rounding where nothing moves
        values += samples[0]
        middle = 0.5 * (edges[1:] + edges[:-1])
        about = described(of, run, *((k, edges) if of == "density" else ()))
        along = {"position": (middle, {"units": "length", "long_name": names[k]})}
        return observable(of, along, values, errors, **about)


def order_parameter(source: Source, start: float | None = None) -> Observable:
    """Global bond order of a periodic scene, dimensionless: |<psi_6>| of discs, Q_6 of spheres.

    1 in a triangular lattice of discs, 0.5745 in a face-centred cubic one, small in a fluid (about
    1 / sqrt(12 N) for spheres). Raises SceneError for walls and for too few frames.
    """
    from gaspart.analysis.order import global_steinhardt, hexatic

    with measured(source, start) as run:
        require_defined("order", run.scene)
        if run.data.sizes["atom"] < run.count:
            rule = f"neighbours are among all {run.count} particles, which the file has not"
            raise SceneError("follow", run.data.sizes["atom"], rule)
        lengths = run.scene.container.lengths
        frames, time = chosen_frames(run, run.positions), chosen_frames(run, run.time)
        if run.dimension == 2:
            series, name = [abs(hexatic(frame, lengths).mean()) for frame in frames], "|psi_6|"
        else:
            series, name = [global_steinhardt(frame, lengths) for frame in frames], "Q_6"
        edges = np.append(time, 2.0 * time[-1] - time[-2])
        about = described("order", run)
        about["long_name"] += f" {name}"
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
