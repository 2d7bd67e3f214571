r"""Chemical potential by insertion of a test particle.

The chance that a particle at a random place in a fluid of N overlaps none is
:math:`P_N = Q_{N+1}/Q_N`, Q the configuration integral over :math:`V^N` (source C, Eq. 46), so that
:math:`\mu_\mathrm{excess}/k_B T = -\ln P_N` (Widom, J. Chem. Phys. 39, 2808 (1963)).

In a dense fluid hardly any place is free, and of random places nearly all fail. Most of the container is
known to be covered: a cell all of which is nearer than a diameter to one particle, in a mixture than the sum
of their radii. The covered cells of a grid are left out, the others are divided while they are few, and
places are drawn in what remains. With the share of the container that it has as their weight, this is the
same average, exactly.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product
from typing import Any, TypeAlias

import numpy as np

from gaspart.analysis.expected.equilibrium import describe
from gaspart.analysis.observable import LEAST_INTERVALS, Observable, observable, scalar, with_freedom
from gaspart.analysis.observables import require_defined
from gaspart.analysis.pairs import STRETCHES
from gaspart.analysis.run import Run, Source, open_run
from gaspart.analysis.statistics import correlated_mean
from gaspart.errors import SceneError
from gaspart.keys.values import count_of

TRIALS = 512
"""Places that are tried in each frame, by default."""
MOST_FRAMES = 2048
"""Frames, evenly spaced, in which they are tried."""
_CELLS = 65536
"""Maximum number of cells of the first grid."""
_PER_DISTANCE = 8
"""Cells of that grid in the distance within which a particle covers, at most."""
_MOST_CELLS = 2048  # after a division
_MARGIN = 1.5
"""Minimum number of standard deviations of ln P, by frame, between the frames that contribute most to the
mean of P and the best frame, for an error."""
_TWO_SIGMA = 0.9772
"""Probability that a normal variable is at most two standard deviations above its mean."""
_WORTH = 0.6
"""Fraction of cells left by a division above which no further division follows."""


@dataclass(frozen=True)
class Insertions:
    """Trials of positions in T frames.

    Attributes
    ----------
    share : ndarray, shape (T,), [1]
        Fraction of the container in which positions were drawn.
    successes : ndarray of int, shape (T,)
        Number of free positions.
    trials : int
        Number of positions in each frame whose fraction is not 0.
    """

    share: np.ndarray
    successes: np.ndarray
    trials: int

    @property
    def probability(self) -> np.ndarray:
        """(T,) chance that a random place is free, by frame."""
        return self.share * self.successes / self.trials

    @property
    def resolution(self) -> float:
        """Probability of a single success.

        It is one over the number of random positions, drawn in the whole container, which these trials stand
        for.
        """
        return float(self.share.mean() / (self.trials * len(self.share)))


Hosts: TypeAlias = Sequence[tuple[np.ndarray | slice, float]]
"""Groups of the particles in the fluid: their numbers, and how near a place may be to none of them."""


def insertions(
    frames: np.ndarray,
    lengths: Sequence[float] | np.ndarray,
    hosts: Hosts,
    trials: int,
    seed: int | Sequence[int] = 0,
) -> Insertions:
    """Try random positions in each frame of a periodic container.

    Parameters
    ----------
    frames : ndarray, shape (T, N, d), [length]
        Positions.
    lengths : sequence of float, shape (d,), [length]
        Side lengths of the container.
    hosts : Hosts
        The particles inside and the particle to insert.
    trials : int
        Number of positions in each frame.
    seed : int or sequence of int, default 0
        Seed of the positions.

    Returns
    -------
    Insertions
        The result of the trials.
    """
    generator = np.random.default_rng(seed)
    size = np.asarray(lengths, dtype=float)
    share, successes = np.zeros(len(frames)), np.zeros(len(frames), dtype=int)
    for n, positions in enumerate(frames):
        groups = [(positions[members] % size, distance) for members, distance in hosts]
        share[n], successes[n] = _try(groups, size, trials, generator)
    return Insertions(share, successes, trials)


def _try(
    groups: list[tuple[np.ndarray, float]], lengths: np.ndarray, number: int, generator: np.random.Generator
) -> tuple[float, int]:
    """Count free trials in the region that cells do not show to be covered.

    Returned are the fraction of the container in this region, and the count. `groups` are positions with the
    distance below which a trial overlaps.
    """
    from scipy.spatial import cKDTree

    trees = [(cKDTree(positions, boxsize=lengths), distance) for positions, distance in groups]
    cells, sides = _remaining(groups, trees, lengths)
    if not len(cells):
        return 0.0, 0
    chosen = cells[generator.integers(0, len(cells), size=number)]
    trials = chosen + sides * (generator.random(chosen.shape) - 0.5)
    free = _apart(trees, trials % lengths, 0.0)
    return len(cells) * float(np.prod(sides / lengths)), int(free.sum())


def _apart(trees: list[tuple[Any, float]], positions: np.ndarray, less: float) -> np.ndarray:
    """Find positions (M, d) that are farther from every particle than its distance less a length."""
    is_free = np.ones(len(positions), dtype=bool)
    for tree, distance in trees:
        if distance > less:
            remaining = np.flatnonzero(is_free)
            nearest, _ = tree.query(positions[remaining], distance_upper_bound=distance - less)
            is_free[remaining] = np.isinf(nearest)
    return is_free


def _remaining(
    groups: list[tuple[np.ndarray, float]], trees: list[tuple[Any, float]], lengths: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Return centres (M, d) and sides (d,) of the cells that no single particle covers."""
    dimension = len(lengths)
    narrowest = max(distance for _, distance in groups) / _PER_DISTANCE
    width = max(narrowest, (np.prod(lengths) / _CELLS) ** (1.0 / dimension))
    number = np.maximum(1, np.round(lengths / width)).astype(int)
    sides = lengths / number
    open_ones = np.unravel_index(np.flatnonzero(~_find_covered_cells(groups, sides, number)), number)
    cells = (np.stack(open_ones, axis=1) + 0.5) * sides
    corners = np.array(list(product((-0.25, 0.25), repeat=dimension)))
    while 0 < len(cells) * len(corners) <= _MOST_CELLS:
        cells = (cells[:, None] + corners * sides).reshape(-1, dimension)
        sides, before = 0.5 * sides, len(cells)
        cells = cells[_apart(trees, cells, 0.5 * float(np.linalg.norm(sides)))]  # covered to its corners
        if len(cells) > _WORTH * before:
            break
    return cells, sides


def _find_covered_cells(
    groups: list[tuple[np.ndarray, float]], sides: np.ndarray, number: np.ndarray
) -> np.ndarray:
    """Find the cells (cells,) of a grid that lie within the distance of one particle.

    The grid has the shape (*number); a cell must lie within the distance completely. The cells that differ in
    the last axis only are a strip. A particle covers those between two ends of each strip that is near: at
    the ends 1 is added and subtracted, and the sum along the strip is the number of particles that cover a
    cell. What passes the last cell goes on at the first.
    """
    last, strips = int(number[-1]), int(np.prod(number[:-1]))
    ends = np.zeros(strips * last, dtype=int)
    for positions, distance in groups:
        remaining, strip = np.full(len(positions), distance**2), np.zeros(len(positions), dtype=int)
        for coordinate, side, count in zip(positions.T, sides[:-1], number, strict=False):
            reach = int(distance / side)
            near = np.floor(coordinate / side).astype(int)[:, None] + np.arange(-reach, reach + 1)
            furthest = np.abs(coordinate[:, None] - side * (near + 0.5)) + 0.5 * side
            around = (len(coordinate), *[1] * (remaining.ndim - 1), -1)
            remaining = remaining[..., None] - (furthest**2).reshape(around)
            strip = strip[..., None] * count + (near % count).reshape(around)
        chosen = np.nonzero(remaining > 0.0)
        half, centre = np.sqrt(remaining[chosen]), positions[chosen[0], -1]
        first = np.ceil((centre - half) / sides[-1]).astype(int)
        end = np.maximum(first, np.floor((centre + half) / sides[-1]).astype(int))
        start = last * strip[chosen]
        ends += np.bincount(start + first % last, minlength=len(ends))
        ends -= np.bincount(start + end % last, minlength=len(ends))
        passed = end // last - first // last
        ends[::last] += np.bincount(np.repeat(start // last, passed), minlength=strips)
    return ends.reshape(strips, last).cumsum(axis=1).ravel() > 0


def chemical_potential(source: Source, trials: int = TRIALS, start: float | None = None) -> Observable:
    """Measure the excess chemical potential of a periodic fluid, divided by k_B T, by insertion.

    Parameters
    ----------
    source : str, Path, Dataset or Simulation
        A trajectory, by its path or open, or a simulation.
    trials : int, default 512
        Number of random positions that are tried in each of up to 2048 frames, where a particle may fit.
    start : float, [time], optional
        Frames before this time are discarded. Default: a quarter of the run.

    Returns
    -------
    Observable
        Chemical potential relative to an ideal gas, dimensionless: a scalar, of a mixture (species,).
        Variables: `probability`, that a random position is free, with its error; `successes`, the number of
        free positions; `frames_with_success`, the number of frames that have any; `resolution`, the
        probability that corresponds to a single success.

    Raises
    ------
    SceneError
        For anything but smooth elastic particles in a periodic container, mixtures with single particles or a
        polydisperse species, too few frames, and if no position was free.

    Notes
    -----
    The error applies to the mean over frames, to first order. In a dense fluid ln P of a frame has a large
    standard deviation s: the frames around s deviations above the median contribute most to P. Among n
    independent frames the best one is about sqrt(2 ln n) deviations above the median. If this is not s + 1.5
    at least, the frames that contribute most are missing: the result is too large, its error is NaN, and a
    note states it. Theory: by the equation of state, for these numbers of particles.

    Examples
    --------
    >>> import gaspart as gp
    >>> box = gp.Container((10.0, 10.0), boundary="periodic")
    >>> scene = gp.Scene(box, [gp.Species(32, 0.5, temperature=1.0)])
    >>> simulation = gp.Simulation(scene, seed=1)
    >>> simulation.advance(40.0)
    >>> gp.analysis.chemical_potential(simulation, trials=50).estimate.attrs["units"]
    '1'
    """
    trials = count_of("trials", trials, least=1)
    with open_run(source, start) as run:
        require_defined("chemical_potential", run.scene)
        run.require_all()
        if len(run.time) <= STRETCHES:
            raise SceneError("frames", len(run.time), f"an error needs {STRETCHES + 1} or more")
        start_positions = run.vectors("coordinates")[0].values
        if all((block == start_positions).all() for block in run.blocks("coordinates", slice(None))):
            raise SceneError("duration", run.time[-1], "nothing moves: all frames are one configuration")
        frames = slice(None, None, -(-len(run.time) // MOST_FRAMES))
        time = run.time[frames]
        edges = np.append(time, 2.0 * time[-1] - time[-2])
        about = describe("chemical_potential", run)
        tried = [_insert(run, frames, hosts, trials) for hosts in _hosts(run)]
        if run.scene.alike:
            series, counts = tried[0]
            result = scalar("chemical_potential", series, edges, **about)
            if np.isnan(counts["probability_error"]):
                result["chemical_potential_error"][()] = np.nan
            return _with_note(result.assign(_variables((), counts)))
        return _of_species(run, tried, about)


def _hosts(run: Run) -> list[Hosts]:
    """Return the distances below which an inserted particle overlaps, for each species.

    Equal particles have one such list.
    """
    radii = [kind.radius for kind in run.scene.kinds if kind.count]
    if run.scene.alike:
        return [[(slice(None), 2.0 * radii[0])]]
    numbers = [np.flatnonzero(run.species == kind) for kind in np.unique(run.species)]
    return [[(each, own + radius) for each, radius in zip(numbers, radii, strict=True)] for own in radii]


def _insert(run: Run, frames: slice, hosts: Hosts, trials: int) -> tuple[np.ndarray, dict[str, float]]:
    """Compute the series (T,) of the chemical potential, and the counts of insertions."""
    result = insertions(
        run.vectors("coordinates")[frames].values.astype(float), run.scene.container.lengths, hosts, trials
    )
    chance = float(result.probability.mean())
    if chance == 0.0:
        rule = f"of {trials} places in each of {len(result.share)} frames none was free: a fluid too dense"
        raise SceneError("packing_fraction", run.scene.packing_fraction, rule)
    series = -np.log(chance) - (result.probability / chance - 1.0)  # to first order
    error = correlated_mean(series, LEAST_INTERVALS).estimate.error
    if not _is_sampled(result.probability, error):
        error = np.nan
    counts = {
        "probability": chance,
        "probability_error": chance * error,
        "successes": result.successes.sum(),
        "frames_with_success": np.count_nonzero(result.successes),
        "resolution": result.resolution,
    }
    return series, counts


def _is_sampled(probability: np.ndarray, error: float) -> bool:
    """Return True if the frames that contribute most to the mean probability (T,) are known.

    error : standard error of the mean over the mean, with the correlation of the frames.
    """
    free = probability[probability > 0.0]
    if error == 0.0:
        return True
    median, high = np.quantile(free, (0.5, _TWO_SIGMA))
    deviation = 0.5 * math.log(high / median)
    independent = float(probability.var()) / (error * float(probability.mean())) ** 2
    best = math.sqrt(2.0 * math.log(max(1.0, min(independent, len(free)))))
    return deviation + _MARGIN <= best


def _with_note(result: Observable) -> Observable:
    """Add a note to a result whose error is not known."""
    if np.isnan(result.error).any():
        frames = int(np.min(result["frames_with_success"].values))
        result.attrs["note"] = (
            f"probably too large, by an unknown error: a place was free in {frames} frames, and rarer frames "
            "contribute most to the mean: a longer run has some"
        )
    return result


def _of_species(run: Run, tried: list[tuple[np.ndarray, dict[str, float]]], about: dict) -> Observable:
    """Return the result of a mixture."""
    means = [correlated_mean(series, LEAST_INTERVALS).estimate for series, _ in tried]
    values, errors, freedoms = np.array([[mean.value, mean.error, mean.freedom] for mean in means]).T
    errors[[np.isnan(each["probability_error"]) for _, each in tried]] = np.nan
    along = {"species": (np.unique(run.species), {"long_name": "number of the species"})}
    result = observable("chemical_potential", along, values, errors, **about)
    result = with_freedom(result, freedoms)
    counts = {name: np.array([each[name] for _, each in tried]) for name in tried[0][1]}
    return _with_note(result.assign(_variables(("species",), counts)))


_MEANINGS = {
    "probability": "chance that a random place is free",
    "probability_error": "standard uncertainty",
    "successes": "places that were free",
    "frames_with_success": "frames with a free place",
    "resolution": "probability that one success would have been",
}


def _variables(dims: tuple[str, ...], counts: dict[str, Any]) -> dict[str, tuple]:
    """Return the variables that state how well insertion worked."""
    return {name: (dims, counts[name], {"units": "1", "long_name": _MEANINGS[name]}) for name in counts}
