"""Density waves of a periodic container: the wave vectors that it admits, and their amplitudes."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

_FEW = 24
"""Waves along the longest side, up to which all wave vectors of a shell are candidates; up to twice as many
every second one along each axis, and so on."""
_DEAR = 8
"""Elements of a product of matrices for each that is used, up to which it is cheaper than single sums."""


def admitted(lengths: Sequence[float] | np.ndarray, highest: float) -> tuple[np.ndarray, np.ndarray]:
    """Wave vectors k = 2 pi n / L with 0 < |k| <= highest, one of each pair k, -k, which have one S.

    lengths (d,). Returns the integers n (M, d) and |k| (M,), by ascending |k|.
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
    """Up to `most` of the `admitted` wave vectors of each of `bins` equal intervals of |k|, evenly chosen,
    where these are many from those of every second (fourth, ...) wave along each axis.

    Returns n (M, d), the number of the shell of each (M,), and the mean |k| of each of the S shells that are
    not empty (S,).
    """
    parts, low, step = [], 0.0, 1
    while low < highest:
        high = min(highest, step * _FEW * 2.0 * np.pi / max(lengths))
        waves, size = admitted(np.asarray(lengths) / step, high)
        parts.append((step * waves[size > low], size[size > low]))
        low, step = high, 2 * step
    waves, size = (np.concatenate(one) for one in zip(*parts, strict=True))
    bin_of = np.minimum((size * (bins / highest)).astype(int), bins - 1)
    kept = []
    for members in np.split(np.arange(len(size)), np.flatnonzero(np.diff(bin_of)) + 1):
        number = min(most, len(members))
        kept.append(members[(np.arange(number) * len(members)) // number])
    shell = np.repeat(np.arange(len(kept)), [len(members) for members in kept])
    chosen = np.concatenate(kept)
    return waves[chosen], shell, in_shells(size[chosen], shell)


def in_shells(values: np.ndarray, shell: np.ndarray) -> np.ndarray:
    """(S,) means of the values (M,) of each shell."""
    return np.bincount(shell, values) / np.bincount(shell)


def factors(positions: np.ndarray, lengths: Sequence[float] | np.ndarray, waves: np.ndarray) -> np.ndarray:
    """(M,) |sum exp(i k.r)|^2 / N of positions (N, d); see `amplitudes`."""
    return np.abs(amplitudes(positions, lengths, waves)) ** 2 / len(positions)


def amplitudes(positions: np.ndarray, lengths: Sequence[float] | np.ndarray, waves: np.ndarray) -> np.ndarray:
    """(M,) sum exp(i k.r), complex, at the wave vectors k = 2 pi n / L, n being `waves` (M, d).

    positions (N, d). The exponential is a product of one factor an axis, from tables over the integers. Those
    of the axes after the first are multiplied once for all vectors that share them; the sum over particles is
    a product of matrices where the vectors are a good part of its elements, and otherwise made for each.
    """
    first, *others = (
        _phases(positions[:, axis], float(length), int(np.abs(waves[:, axis]).max()))
        for axis, length in enumerate(lengths)
    )
    number, strides = waves[:, 0], np.cumprod([1, *(len(table) for table in others[:0:-1])])[::-1]
    rows = np.array([len(table) for table in others])
    keys, place = np.unique((waves[:, 1:] % rows) @ strides, return_inverse=True)
    inner = others[0][keys // strides[0]]
    for table, stride in zip(others[1:], strides[1:], strict=True):
        inner *= table[keys // stride % len(table)]
    first = first[: int(number.max()) + 1] if number.min() >= 0 else first
    if len(first) * len(keys) < _DEAR * len(waves):
        return np.asarray((inner @ first.T)[place, number])
    total = np.empty(len(waves), dtype=complex)
    for each in np.unique(number):
        here = np.flatnonzero(number == each)
        total[here] = inner[place[here]] @ first[each]
    return total


def _phases(places: np.ndarray, length: float, most: int) -> np.ndarray:
    """(2 most + 1, N) exp(2 pi i n x / L) of the integers n, the negative ones after the others."""
    ahead = np.exp(2j * np.pi / length * np.outer(np.arange(most + 1), places))
    return np.concatenate([ahead, ahead[:0:-1].conj()])
