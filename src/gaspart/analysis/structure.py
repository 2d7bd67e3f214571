"""Observables from positions and speeds: distributions, profiles and order.

Uncertainties come from the scatter between consecutive blocks of the run, or between groups of particles.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from gaspart.analysis.expected.equilibrium import describe
from gaspart.analysis.flow import Grid, accessible_fraction, mean_motion
from gaspart.analysis.impulses import default_bins, described_density, mixed_density
from gaspart.analysis.observable import Observable, observable, scalar, with_freedom
from gaspart.analysis.observables import observables_with, require_defined
from gaspart.analysis.pairs import STRETCHES, chosen_frames
from gaspart.analysis.profiles import Cells, Means
from gaspart.analysis.run import Run, Source, open_run, select_particles
from gaspart.analysis.run_data import FLOW
from gaspart.analysis.statistics import histogram_means
from gaspart.errors import SceneError
from gaspart.keys.values import count_of, number, one_of

_CONSTANT = 1e-5  # relative change of an energy that is attributed to rounding
FASTEST = 4.0
"""Upper end of the histogram of speeds, in thermal speeds sqrt(k_B T / m)."""


def speed_distribution(
    source: Source,
    bins: int = 40,
    start: float | None = None,
    fastest: float | None = None,
    about: str = FLOW,
) -> Observable:
    """Measure the probability density of the speeds of moving particles over all frames.

    Velocities of a particle of mass m relative to the flow (see `gaspart.analysis.flow`) are multiplied by
    sqrt(M / (M - m)). M is the total mass of the particles whose mean velocity is subtracted. The error
    follows from the scatter between groups of particles. It is NaN in an empty bin. The theoretical density
    is Maxwell's distribution at the temperature of the run. For one species at a constant kinetic energy it
    is the exact distribution for the finite number of particles. There is no theory if the gas flows and
    therefore has no uniform temperature.

    Parameters
    ----------
    fastest : float, [length/time], optional
        Upper end of the bins. Default: four thermal speeds.
    about : {"flow", "rest"}, default "flow"
        Frame of reference. "flow": relative to the local flow if the gas flows, otherwise relative to the
        centre of mass if its velocity is conserved. "rest": relative to the container.

    Returns
    -------
    Observable
        The density (speed,) in [time/length].

    Raises
    ------
    SceneError
        If there are fewer than 16 moving particles, or particles are at rest.
    """
    bins = count_of("bins", bins, least=2)
    with open_run(source, start, sheared=True, about=about) as run:
        require_defined("speeds", run.scene, about=about)
        masses, temperature = run.masses[run.moving], run.temperature
        if not temperature > 0.0:
            raise SceneError("temperature", temperature, "particles at rest have no distribution")
        end = FASTEST * np.sqrt(temperature / masses.min())
        if fastest is not None:
            end = number("fastest", fastest, "must be positive and finite", above=0.0)
        grid = Grid.line(0.0, end, bins)
        edges = grid.edges[0]
        counts, sizes, energy = _speeds(run, grid)
        values, errors, freedoms = histogram_means(counts / sizes[:, None] / grid.volume, sizes)
        fixed = np.ptp(energy) <= _CONSTANT * energy.mean()
        alike = np.ptp(masses) == 0.0 and not run.flow_axes
        attributes = describe("speeds", run, edges, masses[0] if alike else None, fixed)
        if run.flow_axes:
            attributes["long_name"] += " about the local flow"
        middle = 0.5 * (edges[1:] + edges[:-1])
        along = {"speed": (middle, {"units": "length / time", "long_name": "speed"})}
        result = observable("speed_distribution", along, values, errors, **attributes)
        return with_freedom(result, freedoms)


def _speeds(run: Run, grid: Grid) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Count speeds in bins, reading the frames in parts. Returns the counts (groups, bins), the numbers of
    speeds (groups,), and the sum of squared velocities in each frame (T,).
    """
    about, energy = mean_motion(run), np.zeros(len(run.time))
    # every group contains a fraction of each species; the species are stored one after the other
    group = np.arange(int(run.moving.sum())) % STRETCHES
    counts, sizes = np.zeros((STRETCHES, grid.size), dtype=int), np.zeros(STRETCHES, dtype=int)
    for frames, part in run.parts():
        motion = about(part)
        squares, free = motion.velocities**2, motion.freedom
        is_known = np.broadcast_to((free > 0.0).all(axis=2), squares.shape[:2])  # not alone in its flow cell
        energy[frames] = squares.sum(axis=(1, 2))
        free = np.broadcast_to(np.where(free > 0.0, free, 1.0), (*free.shape[:2], run.dimension))
        total = np.zeros(squares.shape[:2])
        for k in range(run.dimension):  # one axis after another, because numpy sums a short last axis slowly
            total += squares[..., k] / free[..., k]
        speeds = np.sqrt(total)
        cells = np.where(is_known, grid.cells(speeds[..., None]), -1).T
        counts += grid.sums(cells, None, group)
        sizes += np.bincount(group, is_known.sum(axis=0), STRETCHES).astype(int)
    return counts, sizes, energy


def profile(
    source: Source,
    of: str = "density",
    axis: str | None = None,
    bins: int | None = None,
    start: float | None = None,
    species: int | None = None,
    about: str = FLOW,
) -> Observable:
    """Measure the profile of a property along an axis, averaged over all frames.

    The error of each bin includes the time correlation in this bin. An error is NaN if it has fewer than two
    degrees of freedom, because the run is then too short compared with the correlation time in this bin. It
    is also NaN if the value of the bin does not change. It is 0 if nothing moves, or if all bins have the
    same value.

    If the run has stored impulses along the axis, and each bin consists of an integer number of stored bins,
    the density is also computed from impulses. The result is more accurate than from counts alone
    (`gaspart.analysis.impulses`). The attribute `estimator` names the method.

    For equal particles under gravity along this axis, the theoretical density is hydrostatic, with the
    equation of state of the fluid. The theoretical temperature in equilibrium is uniform.

    Parameters
    ----------
    of : {"density", "temperature"}, default "density"
        "density": number of moving particles divided by the volume of the bin. Only volume inside the
        container counts (faces may move), and only volume that fixed particles leave accessible to centres
        (NaN without accessible volume). "temperature": temperature of the moving particles (NaN if the bin
        contains no particles).
    axis : {"x", "y", "z"}, optional
        The axis. Default: the last one.
    bins : int, optional
        Number of bins. Default: 40. If the run has stored impulses along the axis, the default for a density
        is their number of bins.
    about : {"flow", "rest"}, default "flow"
        Frame of reference of a temperature. "flow": relative to the local flow if there are sliding or moving
        faces, a force along a periodic axis, or a uniform wind. Otherwise relative to the centre of mass, if
        its velocity is conserved (see `gaspart.analysis.flow`). "rest": relative to the container.

    Returns
    -------
    Observable
        The profile (position,). The variable with the suffix _freedom contains the degrees of freedom of the
        errors.

    Raises
    ------
    SceneError
        If the property or the axis is unknown, if the species does not move, or if there are too few frames.

    Examples
    --------
    >>> import gaspart as gp
    >>> scene = gp.Scene(gp.Container((9.0, 9.0)), [gp.Species(20, 0.2, temperature=1.0)])
    >>> simulation = gp.Simulation(scene, seed=1)
    >>> simulation.advance(40.0)
    >>> gp.analysis.profile(simulation, of="density", axis="x", bins=4).sizes["position"]
    4
    """
    one_of("of", of, observables_with(function="profile"))
    with open_run(source, start, sheared=True, varying=True, about=about) as run:
        require_defined(of, run.scene, axis=axis, species=species)
        names = "xyz"[: run.dimension]
        k = names.index(names[-1] if axis is None else axis)
        bins = default_bins(run, k, of) if bins is None else count_of("bins", bins, least=2)
        edges = np.linspace(0.0, run.scene.container.lengths[k], bins + 1)
        by_impulses = None
        if of == "density":
            by_impulses = mixed_density(run, k, bins, species)
            means = by_impulses or _density(run, k, bins, species)
        else:
            members = np.flatnonzero(run.moving)[select_particles(run, species, None)]
            means = Cells(run, members, (k,), (bins,)).temperature(local=False)
        middle = 0.5 * (edges[1:] + edges[:-1])
        attributes = describe(of, run, *((k, edges, species) if of == "density" else ()))
        along = {"position": (middle, {"units": "length", "long_name": names[k]})}
        result = observable(of, along, means.values, means.errors, **attributes)
        if of == "density":
            result.attrs |= described_density(run, k, bins, by_impulses is not None)
        return with_freedom(result, means.freedoms)


def density(source: Source, start: float | None = None, **selection: Any) -> Observable:
    """Measure the density along an axis by `profile` with "density".

    Parameters
    ----------
    **selection
        Other arguments of `profile`.

    Returns
    -------
    Observable
        The profile (position,) in [1/length^d].
    """
    return profile(source, "density", start=start, **selection)


def temperature(source: Source, start: float | None = None, **selection: Any) -> Observable:
    """Measure the temperature along an axis by `profile` with "temperature".

    Parameters
    ----------
    **selection
        Other arguments of `profile`.

    Returns
    -------
    Observable
        The profile (position,) in [energy].
    """
    return profile(source, "temperature", start=start, **selection)


def order_parameter(source: Source, start: float | None = None) -> Observable:
    """Measure the global bond order of a periodic scene: |<psi_6>| of discs, Q_6 of spheres.

    The parameter is 1 in a triangular lattice of discs, 0.5745 in a face-centred cubic lattice, and small in
    a fluid (about 1 / sqrt(12 N) for spheres).

    Returns
    -------
    Observable
        The bond order, dimensionless.

    Raises
    ------
    SceneError
        If the scene has walls, or there are too few frames.
    """
    from gaspart.analysis.bond_order import global_steinhardt, hexatic

    with open_run(source, start) as run:
        require_defined("order", run.scene)
        run.require_all()
        lengths = run.scene.container.lengths
        time, numbers = chosen_frames(run, run.time), chosen_frames(run, np.arange(len(run.time)))
        frames = (run.frame("coordinates", number) for number in numbers)
        if run.dimension == 2:
            series, name = [abs(hexatic(frame, lengths).mean()) for frame in frames], "|psi_6|"
        else:
            series, name = [global_steinhardt(frame, lengths) for frame in frames], "Q_6"
        edges = np.append(time, 2.0 * time[-1] - time[-2])
        about = describe("order", run)
        about["long_name"] += f" {name}"
        return scalar("order_parameter", np.array(series, dtype=float), edges, **about)


def _density(run: Run, axis: int, bins: int, species: int | None) -> Means:
    """Compute the density of the moving particles, or of one species. The density is NaN in bins from which
    fixed particles exclude all centres. Raises SceneError if particles are of several kinds and the file does
    not contain all of them.
    """
    if len(run.scene.kinds) > 1:
        run.require_all()
    chosen = np.isfinite(run.masses) & (run.species == (run.species if species is None else species))
    stored = run.data.sizes["atom"]
    members = np.flatnonzero(chosen[:stored])
    cells = Cells(run, members, (axis,), (bins,))
    if np.isfinite(run.masses).all():
        return cells.density().times(run.count / stored)
    edges, radii = cells.grid.edges[0], run.radii[members]  # the accessible volume depends on the radius
    fractions = {radius: accessible_fraction(run, radius, axis, edges) for radius in np.unique(radii)}
    shares = np.array([fractions[radius] for radius in radii])  # (n, bins)

    def per_share(here: np.ndarray) -> np.ndarray:
        part = np.take_along_axis(shares.T, here, axis=0)
        return np.divide(1.0, part, out=np.zeros(here.shape), where=part > 0.0)

    means = cells.density(per_share)
    closed = ~shares.any(axis=0)
    return Means(*(np.where(closed, np.nan, values) for values in vars(means).values()))
