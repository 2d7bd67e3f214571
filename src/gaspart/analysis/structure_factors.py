"""Static structure factors of all particles and of each pair of species.

Uncertainties come from the scatter between consecutive blocks of the run.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from gaspart.analysis.expected.equilibrium import describe
from gaspart.analysis.observable import Observable, observable, with_freedom
from gaspart.analysis.observables import require_defined
from gaspart.analysis.pairs import STRETCHES, stretches_of
from gaspart.analysis.run import Run, Source, open_run
from gaspart.analysis.statistics import means_of
from gaspart.keys.values import count_of, number
from gaspart.trajectory.correlator import pair_names, pairs_of
from gaspart.workers import in_threads

# Density waves of a periodic container: the permitted wave vectors, and their amplitudes.


_FEW = 24
"""If the number of waves along the longest side is at most this number, all wave vectors of a shell are
candidates. Up to twice this number, every second wave along each axis is a candidate, and so on.
"""


def wave_vectors(lengths: Sequence[float] | np.ndarray, highest: float) -> tuple[np.ndarray, np.ndarray]:
    """Return one of each pair of wave vectors k, -k with 0 < |k| <= highest. The wave vectors are k = 2 pi n
    / L. Both vectors of a pair k, -k have the same S. `lengths` has shape (d,). Returns the integers n (M, d)
    and |k| (M,), by ascending |k|.
    """
    unit = 2.0 * np.pi / np.asarray(lengths, dtype=float)
    most = (highest / unit).astype(int)
    grid = np.meshgrid(np.arange(most[0] + 1), *(np.arange(-n, n + 1) for n in most[1:]), indexing="ij")
    waves = np.stack([axis.ravel() for axis in grid], axis=1)
    first = np.argmax(waves != 0, axis=1)
    leading = np.take_along_axis(waves, first[:, None], axis=1)[:, 0]
    size = np.sqrt(((waves * unit) ** 2).sum(axis=1))
    kept = np.flatnonzero((leading > 0) & (size <= highest))
    kept = kept[np.argsort(size[kept], kind="stable")]
    return waves[kept], size[kept]


def shells_of(
    lengths: Sequence[float] | np.ndarray, highest: float, bins: int, most: int
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Select up to `most` wave vectors (see `wave_vectors`) in each interval of |k|. `bins` is the number of
    equal intervals. The selected vectors are evenly distributed among the candidates. If there are too many
    wave vectors, only every second (fourth, ...) wave along each axis is a candidate. Returns n (M, d), the
    shell number of each vector (M,), and the mean |k| (S,) of the S nonempty shells.
    """
    parts, low, step = [], 0.0, 1
    while low < highest:
        high = min(highest, step * _FEW * 2.0 * np.pi / max(lengths))
        waves, size = wave_vectors(np.asarray(lengths) / step, high)
        parts.append((step * waves[size > low], size[size > low]))
        low, step = high, 2 * step
    waves, size = (np.concatenate(values) for values in zip(*parts, strict=True))
    bin_of = np.minimum((size * (bins / highest)).astype(int), bins - 1)
    kept = []
    for members in np.split(np.arange(len(size)), np.flatnonzero(np.diff(bin_of)) + 1):
        number = min(most, len(members))
        kept.append(members[(np.arange(number) * len(members)) // number])
    shell = np.repeat(np.arange(len(kept)), [len(members) for members in kept])
    chosen = np.concatenate(kept)
    return waves[chosen], shell, in_shells(size[chosen], shell)


def in_shells(values: np.ndarray, shell: np.ndarray) -> np.ndarray:
    """Average values (M,) of wave vectors in each shell, shape (S,)."""
    return np.bincount(shell, values) / np.bincount(shell)


def factors(
    frames: np.ndarray, lengths: Sequence[float] | np.ndarray, waves: np.ndarray, threads: int = 1
) -> np.ndarray:
    """Compute |sum exp(i k.r)|^2 / N in each frame, shape (T, M); see `amplitudes`."""
    return np.abs(amplitudes(frames, lengths, waves, threads)) ** 2 / frames.shape[1]


def amplitudes(
    frames: np.ndarray, lengths: Sequence[float] | np.ndarray, waves: np.ndarray, threads: int = 1
) -> np.ndarray:
    """Compute the sum of exp(i k.r) over the particles in each frame, for several wave vectors. The wave
    vectors are k = 2 pi n / L.
    """
    from gaspart.kernels.analysis.waves import sum_waves  # importing numba takes 0.4 s

    base = 2.0 * np.pi / np.asarray(lengths, dtype=float)
    products, rows = _factor_rows(waves)

    def of_frame(positions: np.ndarray) -> np.ndarray:
        phases = np.asarray(positions, dtype=float).T * base[:, None]
        sums = np.zeros((2, len(waves)))
        sum_waves(np.cos(phases), np.sin(phases), products, rows, sums)
        return sums[0] + 1j * sums[1]

    return np.array(in_threads(of_frame, frames, threads)).reshape(len(frames), len(waves))


def _factor_rows(waves: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the products from which all exponential factors are computed, and the rows of each wave. The
    factors are exp(2 pi i n x / L). For waves (M, d), `sum_waves` expects the products and the rows as arrays
    (R, 2) and (M, d).
    """
    from gaspart.kernels.analysis.waves import CONJUGATE

    dimension = waves.shape[1]
    products: list[tuple[int, int]] = []
    row_of = {(axis, 0): 0 for axis in range(dimension)} | {(axis, 1): 1 + axis for axis in range(dimension)}

    def row(axis: int, n: int) -> int:
        if (axis, n) not in row_of:
            pair = (row(axis, -n), CONJUGATE) if n < 0 else (row(axis, n // 2), row(axis, n - n // 2))
            products.append(pair)
            row_of[axis, n] = dimension + len(products)
        return row_of[axis, n]

    rows = np.empty(waves.shape, dtype=np.int64)
    for axis in range(dimension):
        integers, position = np.unique(waves[:, axis], return_inverse=True)
        rows[:, axis] = np.array([row(axis, int(n)) for n in integers], dtype=np.int64)[position]
    return np.array(products, dtype=np.int64).reshape(-1, 2), rows


_HIGHEST = 20.0
"""Maximum wave number of S(k), in units of 1 / diameter; it includes the first three maxima."""
_WAVES = 24
"""Maximum number of wave vectors per bin of S(k); they are evenly distributed among the wave vectors that the
container permits.
"""
_WORK = 2**35
"""Maximum number of terms in all sums over particles together. If there would be more terms, fewer frames are
used.
"""


def structure_factor(
    source: Source, bins: int = 60, highest: float | None = None, start: float | None = None
) -> Observable:
    """Measure the static structure factor S(k) = <|sum exp(i k.r)|^2> / N of a periodic scene.

    The sums are exact at the wave vectors that the periodic container permits: k = 2 pi (n_x / L_x, ...). The
    vector k = 0, at which S = N, is excluded. The values are averaged in intervals of |k|, over up to 24
    vectors in each interval. An interval without vectors is omitted. In a fluid, S(k) tends to the reduced
    compressibility k_B T d rho / dP at small k, and to 1 at large k. The theoretical curve for equal spheres
    is the approximation of Verlet and Weis.

    Parameters
    ----------
    bins : int, default 60
        Number of equal intervals of |k|.
    highest : float, [1/length], optional
        Upper end of the intervals. Default: 20 divided by the largest diameter.

    Returns
    -------
    Observable
        S (wave_number,), dimensionless, averaged over up to 320 frames. Fewer frames are used if there are
        many particles. The coordinate is the mean |k| in each interval.

    Raises
    ------
    SceneError
        If the scene has walls, if the file contains only some of the particles, if there are too few frames,
        or if `highest` is below the smallest wave number.
    """
    with open_run(source, start) as run:
        require_defined("structure_factor", run.scene)
        lengths = run.scene.container.lengths
        means, along = _average_products(
            run, bins, highest, lambda frames, waves: factors(frames, lengths, waves)
        )
        about = describe("structure_factor", run, along["wave_number"][0])
        result = observable("structure_factor", along, *means_of(means), **about)
        return with_freedom(result, len(means) - 1.0)


def partial_structure_factors(
    source: Source, bins: int = 60, highest: float | None = None, start: float | None = None
) -> Observable:
    """Measure the Ashcroft-Langreth partial structure factors of a periodic mixture.

    The definition is (N. W. Ashcroft and D. C. Langreth, Phys. Rev. 156, 685 (1967))

        S_ab(k) = <rho_a(k) rho_b(-k)> / sqrt(N_a N_b),    rho_a(k) = sum over species a of exp(i k.r).

    At large k, and for an ideal mixture at any k, the factor is 1 if a and b are the same species and 0 if
    they are different species. With the number fractions x, the sum of sqrt(x_a x_b) S_ab over all a and b is
    exactly the `structure_factor`. Wave vectors and errors are the same as in `structure_factor`. The
    theoretical factors are the approximation of Verlet and Weis for spheres of one size, and the
    approximation of Percus and Yevick for spheres of several sizes.

    Parameters
    ----------
    bins : int, default 60
        Number of equal intervals of |k|, as in `structure_factor`.
    highest : float, [1/length], optional
        Upper end of the intervals, as in `structure_factor`.

    Returns
    -------
    Observable
        The factors (pair, wave_number), dimensionless.

    Raises
    ------
    SceneError
        Under the conditions of `structure_factor`. Also if the scene has single particles, because these do
        not belong to a species.
    """
    with open_run(source, start) as run:
        require_defined("partial_structure_factors", run.scene)
        members = [np.flatnonzero(run.species == kind) for kind in range(len(run.scene.species))]
        lengths, pairs = run.scene.container.lengths, pairs_of(run.scene)

        def of_pairs(frames: np.ndarray, waves: np.ndarray) -> np.ndarray:
            each = [
                amplitudes(frames[:, indices], lengths, waves) / max(1.0, len(indices)) ** 0.5
                for indices in members
            ]
            return np.stack([(each[a] * each[b].conj()).real for a, b in pairs], axis=1)

        means, along = _average_products(run, bins, highest, of_pairs)
        names = np.array(pair_names(run.scene)), {"long_name": "numbers of two species, from 0"}
        about = describe("partial_structure_factors", run, along["wave_number"][0])
        along = {"pair": names, **along}
        result = observable("partial_structure_factors", along, *means_of(means), **about)
        return with_freedom(result, len(means) - 1.0)


def _average_products(
    run: Run,
    bins: int,
    highest: float | None,
    products: Callable[[np.ndarray, np.ndarray], np.ndarray],
) -> tuple[np.ndarray, dict[str, Any]]:
    """Average `products` in each of 16 blocks of the run, in intervals of |k|. `products` is a function of
    (frames, waves) that returns an array (T, ..., M). Returns an array (16, ..., wave_number), and the
    coordinate. Raises SceneError under the conditions of `structure_factor`.
    """
    bins = count_of("bins", bins, least=2)
    lengths = run.scene.container.lengths
    run.require_all()
    diameter, least = 2.0 * run.scene.largest_radius, 2.0 * np.pi / max(lengths)
    rule = f"must be above that of the longest wave, {least:.4g}"
    end = _HIGHEST / diameter if highest is None else highest
    end = number("highest", end, rule, above=least)
    waves, shell, k = shells_of(lengths, end, bins, _WAVES)
    stretches = stretches_of(run)
    most = max(1, _WORK // (run.count * len(waves) * STRETCHES))
    means = []
    for part in stretches:
        fewer = -(-len(run.time[part]) // most)
        part = slice(part.start, part.stop, part.step * fewer)
        blocks = run.blocks("coordinates", part)
        total = sum(products(block, waves).sum(axis=0) for block in blocks)
        means.append(np.apply_along_axis(in_shells, -1, total / len(run.time[part]), shell))
    return np.array(means), {"wave_number": (k, {"units": "1 / length", "long_name": "wave number"})}
