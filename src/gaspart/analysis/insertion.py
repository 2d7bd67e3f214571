r"""Chemical potential by insertion of a test particle.

The chance that a particle at a random place in a fluid of N overlaps none is
:math:`P_N = Q_{N+1}/Q_N`, Q the configuration integral over :math:`V^N` (source C, Eq. 46), so that
:math:`\mu_\mathrm{excess}/k_B T = -\ln P_N` (Widom, J. Chem. Phys. 39, 2808 (1963)).

In a dense fluid hardly any place is free, and of random places nearly all fail. Most of the container is
known to be covered: a cell all of which is nearer than a diameter to one particle. Cells are divided while
they are few, those that are covered are left out, and places are drawn in what remains. With the share of
the container that it has as their weight, this is the same average, exactly.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product

import numpy as np

from gaspart.analysis.expected.described import described
from gaspart.analysis.observable import Observable, scalar
from gaspart.analysis.observables import require_defined
from gaspart.analysis.pairs import STRETCHES
from gaspart.analysis.run import Source, open_run
from gaspart.errors import SceneError
from gaspart.keys.values import count_of
from gaspart.scene.gas import plain_gas

PLACES = 512
"""Places that are tried in each frame, by default."""
MOST_FRAMES = 2048
"""Frames, evenly spaced, in which they are tried."""
_CELLS = 4096  # at first
_MOST_CELLS = 25000  # after a division
_WORTH = 0.6
"""Of the cells that a division leaves: it is the last one if it leaves more."""
_DIVISIONS = 7  # at most: cells are then a hundredth of the first ones' side


@dataclass(frozen=True)
class Insertions:
    """Places tried in T frames. share (T,): the part of the container in which they were drawn; successes
    (T,): those that were free; places: how many were tried in each frame whose share is not 0."""

    share: np.ndarray
    successes: np.ndarray
    places: int

    @property
    def probability(self) -> np.ndarray:
        """(T,) chance that a random place is free, by frame."""
        return self.share * self.successes / self.places

    @property
    def resolution(self) -> float:
        """The probability that one success would have been: one over the number of random places, drawn in
        the whole container, which these stand for."""
        return float(self.share.mean() / (self.places * len(self.share)))


def insertions(
    frames: np.ndarray,
    lengths: Sequence[float] | np.ndarray,
    diameter: float,
    places: int,
    seed: int | Sequence[int] = 0,
) -> Insertions:
    """Try `places` random places in each of the frames (T, N, d) of a periodic container of lengths (d,)."""
    generator = np.random.default_rng(seed)
    size = np.asarray(lengths, dtype=float)
    share, successes = np.zeros(len(frames)), np.zeros(len(frames), dtype=int)
    for n, positions in enumerate(frames):
        share[n], successes[n] = _try(positions % size, size, diameter, places, generator)
    return Insertions(share, successes, places)


def _try(
    positions: np.ndarray, lengths: np.ndarray, diameter: float, places: int, generator: np.random.Generator
) -> tuple[float, int]:
    """The part of the container that cells do not show to be covered, and how many places there are free."""
    from scipy.spatial import cKDTree

    tree = cKDTree(positions, boxsize=lengths)
    cells, sides = _remaining(tree, lengths, diameter)
    if not len(cells):
        return 0.0, 0
    chosen = cells[generator.integers(0, len(cells), size=places)]
    trials = chosen + sides * (generator.random(chosen.shape) - 0.5)
    nearest, _ = tree.query(trials % lengths, distance_upper_bound=diameter)
    return len(cells) * float(np.prod(sides / lengths)), int(np.isinf(nearest).sum())


def _remaining(tree: object, lengths: np.ndarray, diameter: float) -> tuple[np.ndarray, np.ndarray]:
    """Centres (M, d) and sides (d,) of the cells that no one particle covers."""
    dimension = len(lengths)
    width = (np.prod(lengths) / _CELLS) ** (1.0 / dimension)
    number = np.maximum(1, np.round(lengths / width).astype(int))
    sides = lengths / number
    axes = (side * (np.arange(n) + 0.5) for side, n in zip(sides, number, strict=True))
    cells = np.stack([axis.ravel() for axis in np.meshgrid(*axes, indexing="ij")], axis=1)
    corners = np.array(list(product((-0.25, 0.25), repeat=dimension)))
    for division in range(_DIVISIONS + 1):
        before = len(cells)
        reach = diameter - 0.5 * float(
            np.linalg.norm(sides)
        )  # nearer to its centre, all of a cell is covered
        if reach > 0.0:
            nearest, _ = tree.query(cells, distance_upper_bound=reach)  # type: ignore[attr-defined]
            cells = cells[np.isinf(nearest)]
        gained = division == 0 or len(cells) < _WORTH * before
        if division == _DIVISIONS or not gained or len(cells) * len(corners) > _MOST_CELLS:
            break
        cells = (cells[:, None] + corners * sides).reshape(-1, dimension) % lengths
        sides = 0.5 * sides
    return cells, sides


def chemical_potential(source: Source, places: int = PLACES, start: float | None = None) -> Observable:
    """Chemical potential of a periodic fluid beyond that of an ideal gas, over k_B T, by insertion.

    source: a trajectory, by its path or open, or a simulation; places: random places that are tried in each
    of up to 2048 frames, drawn where a particle may fit; start: the time from which frames count. Also the
    `probability` that a random place is free, with its error; `successes`, the number of places that were,
    and `frames_with_success`, the number of frames that have any; `resolution`, the probability that one
    success would have been. The error is that of the mean over frames, to first order: it is not to be
    trusted if few frames have a success. Theory: by the equation of state, for this number of particles.
    Raises SceneError for anything but equal smooth particles in a periodic container, for too few frames, and
    if no place was free.
    """
    places = count_of("places", places, least=1)
    with open_run(source, start) as run:
        require_defined("chemical_potential", run.scene)
        gas = plain_gas(run.scene)
        if run.is_subset:
            raise SceneError("follow", run.data.sizes["atom"], f"needs all {run.count} particles in the file")
        if len(run.time) <= STRETCHES:
            raise SceneError("frames", len(run.time), f"an error needs {STRETCHES + 1} or more")
        stride = -(-len(run.time) // MOST_FRAMES)
        found = insertions(run.positions[::stride], run.scene.container.lengths, gas.diameter, places)
        chance = float(found.probability.mean())
        if chance == 0.0:
            rule = f"of {places} places in each of {len(found.share)} frames none was free: a fluid too dense"
            raise SceneError("packing_fraction", gas.packing_fraction, rule)
        time = run.time[::stride]
        edges = np.append(time, 2.0 * time[-1] - time[-2])
        series = -np.log(chance) - (found.probability / chance - 1.0)  # to first order
        result = scalar("chemical_potential", series, edges, **described("chemical_potential", run))
        return result.assign(_counts(found, chance, float(result.error)))


def _counts(found: Insertions, chance: float, relative: float) -> dict[str, tuple]:
    """The variables that state how well insertion worked."""
    numbers = {
        "probability": (chance, "chance that a random place is free"),
        "probability_error": (chance * relative, "standard uncertainty"),
        "successes": (found.successes.sum(), "places that were free"),
        "frames_with_success": (np.count_nonzero(found.successes), "frames with a free place"),
        "resolution": (found.resolution, "probability that one success would have been"),
    }
    return {name: ((), value, {"units": "1", "long_name": text}) for name, (value, text) in numbers.items()}
