r"""Chemical potential by insertion of a test particle.

P_N is the probability that a particle at a random position in a fluid of N particles overlaps with none of
them. It is :math:`P_N = Q_{N+1}/Q_N`, with the configuration integral Q over :math:`V^N` (source C, Eq. 46),
so that :math:`\mu_\mathrm{excess}/k_B T = -\ln P_N` (Widom, J. Chem. Phys. 39, 2808 (1963)).

In a dense fluid, nearly all random positions overlap with a particle. Therefore regions in which no position
can be free are excluded first. A cell of a grid is covered if all its points are closer to one particle than
the contact distance. Covered cells are excluded. The other cells are subdivided as long as their number is
small, and positions are drawn at random in the remaining cells. Each trial is weighted by the fraction of the
container that remains. So the mean is the same as for positions in the whole container.
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
"""Default number of positions that are tried in each frame."""
MOST_FRAMES = 2048
"""Maximum number of frames in which positions are tried; the frames are evenly spaced."""
_CELLS = 65536
"""Maximum number of cells of the first, coarsest grid."""
_PER_DISTANCE = 8
"""Maximum number of cells of the first grid per contact distance."""
_MOST_CELLS = 2048  # after a subdivision
_MARGIN = 1.5
"""Margin required for an error estimate, in standard deviations of ln P between frames. By this margin, ln P
of the best frame must exceed ln P of the frames that contribute most to the mean of P.
"""
_TWO_SIGMA = 0.9772
"""Probability that a normal variable is at most two standard deviations above its mean."""
_WORTH = 0.6
"""If more than this fraction of the subdivided cells remain uncovered, cells are not subdivided further."""


@dataclass(frozen=True)
class Insertions:
    """Results of trial insertions in T frames."""

    share: np.ndarray
    successes: np.ndarray
    trials: int

    @property
    def probability(self) -> np.ndarray:
        """Probability (T,) that a random position is free, for each frame."""
        return self.share * self.successes / self.trials

    @property
    def resolution(self) -> float:
        """Probability of a single free position: 1 over the equivalent trials in the whole container."""
        return float(self.share.mean() / (self.trials * len(self.share)))


Hosts: TypeAlias = Sequence[tuple[np.ndarray | slice, float]]
"""Groups of particles in the fluid: the numbers of the particles, and their contact distance with the
inserted particle.
"""


def insertions(
    frames: np.ndarray,
    lengths: Sequence[float] | np.ndarray,
    hosts: Hosts,
    trials: int,
    seed: int | Sequence[int] = 0,
) -> Insertions:
    """Try random positions in each frame of a periodic container."""
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
    """Count the free positions among trials outside of single particles; return also their share of the
    volume.
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
    """Mark the positions (M, d) farther from all particles than the contact distance minus `less`."""
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
    """Return centres (M, d) and side lengths (d,) of the cells that no single particle covers."""
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
        cells = cells[_apart(trees, cells, 0.5 * float(np.linalg.norm(sides)))]  # covered up to its corners
        if len(cells) > _WORTH * before:
            break
    return cells, sides


def _find_covered_cells(
    groups: list[tuple[np.ndarray, float]], sides: np.ndarray, number: np.ndarray
) -> np.ndarray:
    """Find the grid cells (cells,) that lie completely within the contact distance of one particle. The grid
    has the shape (*number). Cells that differ only in their index along the last axis form a strip. In each
    nearby strip, a particle covers an interval of cells. The number 1 is added at the first cell of the
    interval and subtracted after its last cell. The cumulative sum along the strip is then the number of
    particles that cover each cell. Intervals continue periodically from the last to the first cell.
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

    The error refers to the mean over frames, to first order. In a dense fluid ln P has a large standard
    deviation s between frames. Frames about s standard deviations above the median contribute most to the
    mean of P. Among n independent frames, the best frame is about sqrt(2 ln n) standard deviations above the
    median. If sqrt(2 ln n) is less than s + 1.5, the frames that contribute most are missing. Then the result
    is too large, its error is NaN, and a note says so. The theoretical value follows from the equation of
    state, for the same number of particles.

    Parameters
    ----------
    trials : int, default 512
        Number of random positions that are tried in each of up to 2048 frames. The positions lie in the
        region where a particle may fit.

    Returns
    -------
    Observable
        Chemical potential relative to an ideal gas, divided by k_B T: a scalar, or (species,) for a mixture.
        Variables: `probability`, the probability that a random position is free, with its error; `successes`,
        the number of free positions; `frames_with_success`, the number of frames with at least one free
        position; `resolution`, the probability that corresponds to a single free position.

    Raises
    ------
    SceneError
        If the scene is not a periodic container of smooth elastic particles, or is a mixture with single
        particles or a polydisperse species; if there are too few frames; or if no position was free.
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
        if not any(counts["successes"] for _, counts in tried):
            rule = f"of {trials} places in each of {len(time)} frames none was free: a fluid too dense"
            raise SceneError("packing_fraction", run.scene.packing_fraction, rule)
        if run.scene.alike:
            series, counts = tried[0]
            result = scalar("chemical_potential", series, edges, **about)
            if np.isnan(counts["probability_error"]):
                result["chemical_potential_error"][()] = np.nan
            return _with_note(result.assign(_variables((), counts)))
        return _of_species(run, tried, about)


def _hosts(run: Run) -> list[Hosts]:
    """Return the contact distances of an inserted particle of each species, or of the only one."""
    radii = [kind.radius for kind in run.scene.kinds if kind.count]
    if run.scene.alike:
        return [[(slice(None), 2.0 * radii[0])]]
    numbers = [np.flatnonzero(run.species == kind) for kind in np.unique(run.species)]
    return [[(each, own + radius) for each, radius in zip(numbers, radii, strict=True)] for own in radii]


def _insert(run: Run, frames: slice, hosts: Hosts, trials: int) -> tuple[np.ndarray, dict[str, float]]:
    """Compute the series (T,) of the chemical potential, and the counts of trial insertions."""
    result = insertions(
        run.vectors("coordinates")[frames].values.astype(float), run.scene.container.lengths, hosts, trials
    )
    chance = float(result.probability.mean())
    if chance == 0.0:
        counts = dict.fromkeys(_MEANINGS, np.nan) | {"probability": 0.0, "resolution": result.resolution}
        return np.full(len(result.share), np.nan), counts | {"successes": 0, "frames_with_success": 0}
    series = -np.log(chance) - (result.probability / chance - 1.0)  # first-order expansion
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
    """Return True if the frames that contribute most to the mean probability (T,) were sampled. `error`:
    relative standard error of the mean, including the correlation between frames.
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
    """Add a note to a result whose error is unknown."""
    unknown = np.isnan(result.estimate.values)
    if unknown.any():
        result.attrs["note"] = f"no place was free for species {', '.join(map(str, np.flatnonzero(unknown)))}"
    elif np.isnan(result.error).any():
        frames = int(np.min(result["frames_with_success"].values))
        result.attrs["note"] = (
            f"probably too large, by an unknown error: a place was free in {frames} frames, and rarer frames "
            "contribute most to the mean: a longer run has some"
        )
    return result


def _of_species(run: Run, tried: list[tuple[np.ndarray, dict[str, float]]], about: dict) -> Observable:
    """Return the result for a mixture."""
    values, errors, freedoms = np.array([_mean(series) for series, _ in tried]).T
    errors[[np.isnan(each["probability_error"]) for _, each in tried]] = np.nan
    along = {"species": (np.unique(run.species), {"long_name": "number of the species"})}
    result = observable("chemical_potential", along, values, errors, **about)
    result = with_freedom(result, freedoms)
    counts = {name: np.array([each[name] for _, each in tried]) for name in tried[0][1]}
    return _with_note(result.assign(_variables(("species",), counts)))


def _mean(series: np.ndarray) -> tuple[float, float, float]:
    """Return mean, error and degrees of freedom of a series; NaN if it is unknown."""
    if np.isnan(series).any():
        return np.nan, np.nan, np.nan
    mean = correlated_mean(series, LEAST_INTERVALS).estimate
    return mean.value, mean.error, mean.freedom


_MEANINGS = {
    "probability": "chance that a random place is free",
    "probability_error": "standard uncertainty",
    "successes": "places that were free",
    "frames_with_success": "frames with a free place",
    "resolution": "probability that one success would have been",
}


def _variables(dims: tuple[str, ...], counts: dict[str, Any]) -> dict[str, tuple]:
    """Return the variables that describe how many insertions succeeded."""
    return {name: (dims, counts[name], {"units": "1", "long_name": _MEANINGS[name]}) for name in counts}
