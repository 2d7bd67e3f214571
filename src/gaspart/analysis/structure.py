"""Observables from positions and speeds: distributions, profiles and order.

Uncertainties are the scatter of consecutive stretches of the run, or of groups of particles.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from gaspart import theory
from gaspart.analysis.bins import Grid
from gaspart.analysis.observable import Observable, observable, scalar
from gaspart.analysis.pairs import STRETCHES, chosen_frames
from gaspart.analysis.profiles import Cells, Means, with_freedom
from gaspart.analysis.room import left_by_obstacles
from gaspart.analysis.run import Run, Source, measured, require_periodic
from gaspart.analysis.statistics import means_of
from gaspart.errors import SceneError
from gaspart.scene.validation import choice, count_of

_NEIGHBOURHOOD = {2: 7, 3: 13}  # a particle and those around it in a crystal
_CONSTANT = 1e-5  # relative change of an energy that is attributed to rounding
FASTEST = 4.0
"""The histogram of speeds ends at this many thermal speeds sqrt(k_B T / m)."""


def speed_distribution(source: Source, bins: int = 40, start: float | None = None) -> Observable:
    """Density of the speeds of moving particles, (speed,), in time / length, of all frames together.

    source: a trajectory, by its path or open, or a simulation; bins: up to four thermal speeds; start: the
    time from which frames count (by default a quarter of the run). Velocities are those about the local flow
    where the gas flows, otherwise about the centre of mass where that is conserved (see
    `gaspart.analysis.flow`), times sqrt(M / (M - m)), M the mass of those whose mean is taken off. The error
    is the scatter of groups of particles. Theory: Maxwell's, of the run's own temperature; of one species at
    a constant kinetic energy the exact one for their number; none where the gas flows, whose temperature is
    not one. Raises SceneError for fewer than 16 moving particles, and for particles at rest.
    """
    bins = count_of("bins", bins, least=2)
    with measured(source, start) as run:
        if run.moving.sum() < STRETCHES:
            raise SceneError("count", int(run.moving.sum()), f"an error needs {STRETCHES} moving particles")
        masses, temperature = run.masses[run.moving], run.temperature
        if not temperature > 0.0:
            raise SceneError("temperature", temperature, "particles at rest have no distribution")
        squares, free = run.motion.velocities**2, run.motion.freedom
        known = np.broadcast_to((free > 0.0).all(axis=2), squares.shape[:2])  # not alone in its cell
        grid = Grid.line(0.0, FASTEST * np.sqrt(temperature / masses.min()), bins)
        edges = grid.edges[0]
        speeds = np.sqrt((squares / np.where(free > 0.0, free, 1.0)).sum(axis=2))
        cells = np.where(known, grid.cells(speeds[..., None]), -1)
        # every group has a share of each species, which come one after the other
        groups = [slice(first, None, STRETCHES) for first in range(STRETCHES)]
        found = [grid.sums(cells[:, group]) / known[:, group].sum() / grid.volume for group in groups]
        values, errors = means_of(found)
        flows = bool(run.flow_axes)
        expected = {} if flows else _maxwell(run, edges, squares.sum(axis=(1, 2)))
        middle = 0.5 * (edges[1:] + edges[:-1])
        along = {"speed": (middle, {"units": "length / time", "long_name": "speed"})}
        text = f"density of speeds{' about the local flow' if flows else ''}"
        about: dict[str, Any] = {"units": "time / length", "long_name": text, **expected}
        return observable("speed_distribution", along, values, errors, **about)


def _maxwell(run: Run, edges: np.ndarray, energy: np.ndarray) -> dict[str, Any]:
    """Theory's distribution of speeds of one mass in a gas at rest; energy (T,): the sum of squares."""
    masses = run.masses[run.moving]
    if np.ptp(masses) > 0.0:
        return {}
    fixed = np.ptp(energy) <= _CONSTANT * energy.mean()
    freedoms = int(run.freedom) if fixed else None
    law = theory.maxwell_cdf(edges, run.dimension, run.temperature, masses[0], freedoms)
    name = f"Maxwell's distribution{', of this number at fixed energy' if fixed else ''}"
    return {"theory": (np.diff(law) / np.diff(edges), 0.0), "source": name}


def profile(
    source: Source,
    of: str = "density",
    axis: str | None = None,
    bins: int = 40,
    start: float | None = None,
) -> Observable:
    """Profile of a property along an axis, (position,), mean over all frames.

    of: "density", moving particles per volume within the container of the moment (faces may move), without
    that from which fixed particles keep their centres (NaN where nothing is left); or "temperature" of the
    moving particles (NaN where there are none): about the local flow between faces that slide, under a force
    along a periodic axis, in a wind and before faces that move, otherwise about the velocity of the centre of
    mass where that is conserved (see `gaspart.analysis.flow`). axis: "x", "y" or "z", by default the last
    one. Errors are those of correlated series, of each bin for itself; the variable with the suffix _freedom
    has their degrees of freedom. They are NaN where these are fewer than two, of a run that is too short for
    the correlation there, and 0 where nothing moves. Theory: the density of equal particles under gravity
    along this axis, by hydrostatics with the fluid's equation of state; a uniform temperature in equilibrium.
    Raises SceneError for an unknown property or axis, and for too few frames.
    """
    choice("of", of, ("density", "temperature"))
    bins = count_of("bins", bins, least=2)
    with measured(source, start) as run:
        names = "xyz"[: run.dimension]
        k = names.index(choice("axis", names[-1] if axis is None else axis, tuple(names)))
        edges = np.linspace(0.0, run.scene.container.lengths[k], bins + 1)
        if of == "density":
            found = _density(run, k, bins)
        else:
            found = Cells(run, np.flatnonzero(run.moving), (k,), (bins,)).temperature(local=False)
        middle = 0.5 * (edges[1:] + edges[:-1])
        expected = _theory_of_density(run, k, edges) if of == "density" else _theory_of_temperature(run)
        along = {"position": (middle, {"units": "length", "long_name": names[k]})}
        units = f"1 / length^{run.dimension}" if of == "density" else "energy"
        long_name = "number density" if of == "density" else "temperature"
        result = observable(
            of, along, found.values, found.errors, units=units, long_name=long_name, **expected
        )
        return with_freedom(result, found)


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


def _density(run: Run, axis: int, bins: int) -> Means:
    """Of the moving particles, NaN where fixed ones leave no room. Raises SceneError for a file that holds
    the first particles of several kinds only."""
    stored = run.data.sizes["atom"]
    if stored < run.count and len(run.scene.kinds) > 1:
        raise SceneError("follow", stored, f"needs all {run.count} particles, of several kinds, in the file")
    members = np.flatnonzero(np.isfinite(run.masses[:stored]))
    cells = Cells(run, members, (axis,), (bins,))
    if np.isfinite(run.masses).all():
        found = cells.density()
        return found.times(run.count / stored)
    edges, radii = cells.grid.edges[0], run.radii[members]  # fixed particles leave less room to larger ones
    left = {radius: left_by_obstacles(run, radius, axis, edges) for radius in np.unique(radii)}
    shares = np.array([left[radius] for radius in radii])  # (n, bins)
    here = cells.cells
    part = np.take_along_axis(shares.T, here, axis=0)
    weights = np.divide(1.0, part, out=np.zeros(here.shape), where=part > 0.0)
    found = cells.density(weights)
    closed = ~shares.any(axis=0)
    return Means(*(np.where(closed, np.nan, one) for one in vars(found).values()))


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
