"""Sizes and positions of particles: volume, closest packing, radii of a polydisperse species, neighbours."""

from __future__ import annotations

import math
from collections.abc import Iterable
from functools import lru_cache
from itertools import product
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import numpy as np

    from gaspart.scene.container import Container

# Volume of a particle and closest packing: one definition for discs and spheres.


CLOSE_PACKING = {2: math.pi / math.sqrt(12.0), 3: math.pi / math.sqrt(18.0)}
"""Packing fraction of the densest arrangement: triangular lattice (2D), face-centred cubic (3D); exact."""
_UNIT_BALL = {2: math.pi, 3: 4.0 / 3.0 * math.pi}


def ball_volume(dimension: int, radius: float = 1.0) -> float:
    """Return the area of a disc or the volume of a sphere. The area is pi r^2, and the volume is 4 pi r^3 /
    3.
    """
    return _UNIT_BALL[dimension] * radius**dimension


_UNITS = 8.0 * 2.0**-52  # tolerance, in units in the last place


def rounding(position: Iterable[float], *lengths: float) -> float:
    """Return the tolerance of prescribed positions. Particles and walls that touch in decimal numbers may
    overlap in binary numbers, because 0.6 - 0.5 < 0.1 after rounding. The tolerance is a few units in the
    last place of the largest coordinate.
    """
    return _UNITS * max(*map(abs, position), *lengths)


class Nearby:
    """Cells of width `reach` or more, to find positions near a point quickly. Positions are near if their
    distance is at most `reach`.
    """

    def __init__(self, container: Container, reach: float) -> None:
        self._container = container
        self._sides = [max(1, int(length / reach)) if reach else 1 for length in container.lengths]
        self._members: dict[tuple[int, ...], list[int]] = {}

    def _cell(self, position: tuple[float, ...]) -> tuple[int, ...]:
        axes = zip(position, self._container.lengths, self._sides, strict=True)
        return tuple(min(int(x / length * side), side - 1) for x, length, side in axes)

    def add(self, n: int, position: tuple[float, ...]) -> None:
        """Add index `n` at a position (d,) inside the container."""
        self._members.setdefault(self._cell(position), []).append(n)

    def neighbours(self, position: tuple[float, ...]) -> list[int]:
        """Return the indices of all positions within `reach`, and of some others, in ascending order."""
        axes = []
        for at, side, periodic in zip(
            self._cell(position), self._sides, self._container.periodic, strict=True
        ):
            steps = (at - 1, at, at + 1)
            axes.append({step % side for step in steps} if periodic else {n for n in steps if 0 <= n < side})
        return sorted(n for cell in product(*axes) for n in self._members.get(cell, ()))


DISTRIBUTIONS = ("lognormal", "uniform")
MOST_UNIFORM = 1.0 / math.sqrt(3.0)
"""Largest polydispersity of a uniform distribution; its smallest radius is then 0."""

_LN2 = 0.6931471805599453
_TERMS = 16  # terms of the series of exp, for |x| < 0.35
# Numerators and denominators of Wichura's algorithm AS 241 (Appl. Stat. 37, 477 (1988)), the highest power
# first: for the middle, for the tails, and for the extreme tails.
# fmt: off
_MIDDLE = (
    (2509.0809287301226727, 33430.575583588128105, 67265.770927008700853, 45921.953931549871457,
     13731.693765509461125, 1971.5909503065514427, 133.14166789178437745, 3.387132872796366608),
    (5226.495278852854561, 28729.085735721942674, 39307.89580009271061, 21213.794301586595867,
     5394.1960214247511077, 687.1870074920579083, 42.313330701600911252, 1.0),
)
_TAIL = (
    (7.7454501427834140764e-4, 0.0227238449892691845833, 0.24178072517745061177, 1.27045825245236838258,
     3.64784832476320460504, 5.7694972214606914055, 4.6303378461565452959, 1.42343711074968357734),
    (1.05075007164441684324e-9, 5.475938084995344946e-4, 0.0151986665636164571966, 0.14810397642748007459,
     0.68976733498510000455, 1.6763848301838038494, 2.05319162663775882187, 1.0),
)
_FAR = (
    (2.01033439929228813265e-7, 2.71155556874348757815e-5, 0.0012426609473880784386, 0.026532189526576123093,
     0.29656057182850489123, 1.7848265399172913358, 5.4637849111641143699, 6.6579046435011037772),
    (2.04426310338993978564e-15, 1.4215117583164458887e-7, 1.8463183175100546818e-5, 7.868691311456132591e-4,
     0.0148753612908506148525, 0.13692988092273580531, 0.59983220655588793769, 1.0),
)
# fmt: on


def _exp(x: np.ndarray) -> np.ndarray:
    """Compute e^x by its series."""
    import numpy as np

    power = np.rint(x / _LN2)
    rest = x - power * _LN2
    total = np.ones_like(rest)
    for n in range(_TERMS, 0, -1):
        total = 1.0 + total * rest / n
    return np.ldexp(total, power.astype(int))


def _log(x: np.ndarray) -> np.ndarray:
    """Compute ln x by Halley's iteration, which triples the number of correct digits."""
    import numpy as np

    mantissa, exponent = np.frexp(x)
    logarithm = exponent * _LN2 + 2.0 * (mantissa - 1.0) / (mantissa + 1.0)
    for _ in range(3):
        power = _exp(logarithm)
        logarithm = logarithm + 2.0 * (x - power) / (x + power)
    return logarithm


def normal_quantile(p: np.ndarray) -> np.ndarray:
    """Return the quantile of the standard normal distribution, by Wichura's AS 241. `p`: probability in (0,
    1).
    """
    import numpy as np

    def ratio(parts: tuple[tuple[float, ...], tuple[float, ...]], x: np.ndarray) -> np.ndarray:
        return np.polyval(parts[0], x) / np.polyval(parts[1], x)

    q = p - 0.5
    inside = np.abs(q) <= 0.425
    tail = np.sqrt(-_log(np.where(inside, 0.5, np.minimum(p, 1.0 - p))))
    outside = np.where(tail <= 5.0, ratio(_TAIL, tail - 1.6), ratio(_FAR, tail - 5.0))
    return np.where(inside, q * ratio(_MIDDLE, 0.180625 - q * q), np.copysign(outside, q))


@lru_cache(maxsize=16)
def relative_radii(count: int, polydispersity: float, distribution: str) -> np.ndarray:
    """Return the radii (count,) divided by their mean, in descending order. The radii are the quantiles at (k
    + 1/2) / count, k = 0, 1 ..., of a distribution whose standard deviation is the polydispersity. They are
    scaled so that their mean is 1.
    """
    import numpy as np

    p = (np.arange(count - 1, -1, -1) + 0.5) / max(count, 1)
    if distribution == "uniform":
        radii = 1.0 + math.sqrt(3.0) * polydispersity * (2.0 * p - 1.0)
    else:
        square = polydispersity * polydispersity
        more = 1.0 + square
        # ln(1 + s^2), accurate also if rounding removes s^2 from 1 + s^2
        variance = float(_log(np.array(more))) * square / (more - 1.0) if more > 1.0 else square
        radii = _exp(math.sqrt(variance) * normal_quantile(p))
    radii = radii * (count / math.fsum(radii)) if count else radii
    radii.setflags(write=False)
    return radii
