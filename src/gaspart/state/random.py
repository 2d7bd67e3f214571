"""Random streams, directions and normal random numbers, with the same bits on all machines.

Uniform numbers are from numpy's PCG64. All other random numbers are computed from these, only by +, -, x, /
and the square root. IEEE 754 defines these operations to the last bit. Logarithms of libraries differ between
machines.
"""

from __future__ import annotations

import numpy as np

from gaspart.errors import SceneError
from gaspart.kernels.physics.logarithm import LN2, LOG_SERIES


def stream(seed: int | tuple[int, ...], *purpose: int) -> np.random.Generator:
    """Return an independent generator of random numbers for one purpose."""
    return np.random.Generator(np.random.PCG64(_sequence(seed, purpose)))


def key_of(seed: int | tuple[int, ...], *purpose: int) -> np.ndarray:
    """Return the key of the random numbers inside kernels (see `draws`)."""
    return _sequence(seed, purpose).generate_state(2, np.uint64)


def _sequence(seed: int | tuple[int, ...], purpose: tuple[int, ...]) -> np.random.SeedSequence:
    """Return the seed sequence for one purpose; raise SceneError for an invalid seed."""
    parts = seed if isinstance(seed, (tuple, list)) else (seed,)
    for part in parts:
        if isinstance(part, bool) or not isinstance(part, (int, np.integer)) or part < 0:
            raise SceneError("seed", seed, "must be a whole number of at least 0, or a list of them")
    return np.random.SeedSequence([int(part) for part in parts], spawn_key=purpose)


def natural_log(x: np.ndarray) -> np.ndarray:
    """Compute ln x by basic arithmetic, accurate to 2 units in the last place."""
    mantissa, exponent = np.frexp(np.asarray(x, dtype=float))
    low = mantissa < 0.7071067811865476
    mantissa = np.where(low, 2.0 * mantissa, mantissa)
    exponent = exponent - low
    s = (mantissa - 1.0) / (mantissa + 1.0)
    square = s * s
    total = np.zeros_like(s)
    for coefficient in reversed(LOG_SERIES):
        total = total * square + coefficient
    return exponent * LN2 + 2.0 * s * total


def _disc(rng: np.random.Generator, count: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return uniform random points (u, v) in the unit disc, and s = u^2 + v^2. The centre of the disc is
    excluded.
    """
    us, vs, have = [np.empty(0)], [np.empty(0)], 0
    while have < count:
        u, v = 2.0 * rng.random((2, 2 * (count - have) + 8)) - 1.0
        s = u * u + v * v
        inside = (s > 0.0) & (s < 1.0)
        us.append(u[inside])
        vs.append(v[inside])
        have += us[-1].size
    u, v = np.concatenate(us)[:count], np.concatenate(vs)[:count]
    return u, v, u * u + v * v


def directions(rng: np.random.Generator, count: int, dimension: int) -> np.ndarray:
    """Draw isotropic unit vectors (Marsaglia, Ann. Math. Stat. 43, 645 (1972))."""
    u, v, s = _disc(rng, count)
    if dimension == 2:
        return np.stack([(u * u - v * v) / s, 2.0 * u * v / s], axis=1)
    root = np.sqrt(1.0 - s)
    return np.stack([2.0 * u * root, 2.0 * v * root, 1.0 - 2.0 * s], axis=1)


def normals(rng: np.random.Generator, count: int, dimension: int) -> np.ndarray:
    """Draw independent standard normal numbers, by Marsaglia's polar method."""
    pairs = (count * dimension + 1) // 2
    u, v, s = _disc(rng, pairs)
    factor = np.sqrt(-2.0 * natural_log(s) / s)
    return np.concatenate([u * factor, v * factor])[: count * dimension].reshape(count, dimension)
