"""Speeds of a gas: Maxwell's distribution, its moments, and the relaxation from equal speeds.

k_B = 1; speeds in units of sqrt(temperature / mass).
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import numpy as np

from gaspart.errors import SceneError
from gaspart.theory.geometry import Numbers, Values, check_ranges, checked_dimension

_TABLES = Path(__file__).parent / "data"

KURTOSIS_RELAXATION_RATE = {2: 0.4360, 3: 0.4748}
"""Final decay rate of the kurtosis difference K - K_eq, per collision of a particle (computed; homogeneous
Boltzmann equation).
"""
RELAXATION_UNCERTAINTY = 3e-4
"""Standard uncertainty of the tabulated kurtosis and of the tabulated fraction without collision (computed,
Monte Carlo).
"""


@check_ranges
def mean_speed(
    dimension: int, temperature: float = 1.0, mass: float = 1.0, count: int | None = None
) -> float:
    """Compute the mean speed in equilibrium [length/time].

    sqrt(pi k_B T / 2m) in 2D, sqrt(8 k_B T / (pi m)) in 3D (exact). With `count` the result is multiplied by
    sqrt(n) Gamma(n) / Gamma(n + 1/2), n = d N / 2, because the velocities are uniform on a sphere in d N
    dimensions (exact).

    Parameters
    ----------
    count : int, optional
        Number N of particles at the fixed total energy d N k_B T / 2. Default: infinite.
    """
    ratio = {2: 0.5 * math.pi, 3: 8.0 / math.pi}[checked_dimension(dimension)]
    infinite = math.sqrt(ratio * temperature / mass)
    if count is None:
        return infinite
    return infinite * mean_speed_factor(dimension * count)


def mean_speed_factor(freedoms: float) -> float:
    """Compute the mean speed at fixed energy divided by the value for Maxwell's distribution."""
    half = 0.5 * freedoms
    return math.sqrt(half) * math.exp(math.lgamma(half) - math.lgamma(half + 0.5))


@check_ranges
def maxwell_pdf(speed: Numbers, dimension: int, temperature: float = 1.0, mass: float = 1.0) -> Values:
    """Compute the density of speeds of Maxwell's distribution [time/length].

    Let u = v sqrt(m / k_B T). The density is sqrt(m / k_B T) times u exp(-u^2/2) in 2D, and sqrt(m / k_B T)
    times sqrt(2/pi) u^2 exp(-u^2/2) in 3D (exact).

    Parameters
    ----------
    speed : array_like, [length/time]
        Speeds v; the density of negative speeds is 0.
    """
    checked_dimension(dimension)
    scale = math.sqrt(mass / temperature)
    u = np.maximum(np.asarray(speed, dtype=float) * scale, 0.0)
    factor = u if dimension == 2 else math.sqrt(2.0 / math.pi) * u**2
    return scale * factor * np.exp(-0.5 * u**2)


@check_ranges
def maxwell_cdf(
    speed: Numbers,
    dimension: int,
    temperature: float = 1.0,
    mass: float = 1.0,
    freedoms: float | None = None,
) -> Values:
    """Compute the fraction of particles slower than a given speed in equilibrium.

    The incomplete gamma function P(d/2, m v^2 / 2 k_B T) (exact). With `freedoms` the velocities are uniform
    on a sphere in D dimensions. d of these dimensions belong to one particle, and x = m v^2 / (D k_B T) has a
    beta distribution: I_x(d/2, (D - d)/2) (exact). D is d N. For velocities relative to the centre of mass,
    multiplied by sqrt(N / (N - 1)), D is d (N - 1).

    Parameters
    ----------
    speed : array_like, [length/time]
        Speeds v.
    freedoms : float, optional
        Number D of degrees of freedom, more than d, of equal particles with the fixed total energy D k_B T /
        2. Default: Maxwell's distribution.
    """
    from scipy.special import betainc, gammainc

    energy = 0.5 * mass / temperature * np.maximum(np.asarray(speed, dtype=float), 0.0) ** 2
    half = 0.5 * checked_dimension(dimension)
    if freedoms is None:
        return gammainc(half, energy)
    if not freedoms > dimension:
        raise SceneError("freedoms", freedoms, f"must be more than the {dimension} of one particle")
    return betainc(half, 0.5 * freedoms - half, np.minimum(2.0 * energy / freedoms, 1.0))


@check_ranges
def maxwell_ppf(probability: Numbers, dimension: int, temperature: float = 1.0, mass: float = 1.0) -> Values:
    """Compute the speed below which a given fraction of the particles lies; inverse of `maxwell_cdf`
    [length/time].

    Parameters
    ----------
    probability : array_like, [1]
        Fraction of particles, from 0 to 1.
    """
    from scipy.special import gammaincinv

    checked_dimension(dimension)
    energy = gammaincinv(0.5 * dimension, np.asarray(probability, dtype=float))
    return np.sqrt(2.0 * temperature / mass * energy)


@check_ranges
def kurtosis(dimension: int, count: int | None = None, zero_momentum: bool = False) -> float:
    """Compute the kurtosis <v^4> / <v^2>^2 of the speeds in equilibrium.

    (d+2)/d, which is 2 in 2D and 5/3 in 3D (exact). With `count` the velocities are uniform on a sphere in D
    = d N dimensions, or D = d (N-1) for zero total momentum. Then the kurtosis of a particle is (d+2)/d times
    D/(D+2) (exact).

    Parameters
    ----------
    count : int, optional
        Number N of particles at fixed energy. Default: infinite.
    zero_momentum : bool, default False
        Fix the total momentum at zero. Without `count` this argument has no effect.
    """
    infinite = (checked_dimension(dimension) + 2.0) / dimension
    if count is None:
        return infinite
    freedoms = dimension * (count - 1 if zero_momentum else count)
    return infinite * freedoms / (freedoms + 2.0)


@check_ranges
def kurtosis_scatter(dimension: int, count: int) -> tuple[float, float]:
    """Compute the equilibrium scatter of the instantaneous kurtosis of N particles. The velocities are
    uniform on a sphere in D = d N dimensions (exact). The kurtosis is N sum(q) / (sum e)^2 with e = v^2 and q
    = e^2. So its moment of order m is N^m <sum(q)^m> / <(sum e)^2m> for independent normal velocities, for
    which <e^k> is d (d+2) ... (d+2k-2). If the total momentum is fixed at zero, the scatter changes by the
    relative amount 1/N (neglected).
    """

    def moment(freedoms: int, order: int) -> float:
        """Return the mean of e^k with k = `order`."""
        return math.prod(freedoms + 2.0 * k for k in range(order))

    n = float(count)
    second, fourth, sixth = (moment(checked_dimension(dimension), k) for k in (2, 4, 6))
    sums = (
        n * second,
        n * fourth + n * (n - 1.0) * second**2,
        n * sixth + 3.0 * n * (n - 1.0) * fourth * second + n * (n - 1.0) * (n - 2.0) * second**3,
    )
    first, square, cube = (n**k * s / moment(dimension * count, 2 * k) for k, s in enumerate(sums, 1))
    variance = square - first**2
    return math.sqrt(variance), (cube - 3.0 * first * square + 2.0 * first**3) / variance**1.5


def initial_kurtosis_slope(dimension: int) -> float:
    """Return the initial slope dK/ds of the kurtosis from equal speeds: 64/225 in 2D, 8/35 in 3D (exact)."""
    return {2: 64.0 / 225.0, 3: 8.0 / 35.0}[checked_dimension(dimension)]


@dataclass(frozen=True)
class Relaxation:
    """Relaxation of a gas in which all speeds are equal at the start.

    The independent variable is s, the number of collisions per particle since the start, 2 N_collisions / N.
    As functions of s the curves do not depend on diameter, speed or density (Enskog theory).

    The curves were computed from the homogeneous Boltzmann equation by Monte Carlo. They are accurate to
    `RELAXATION_UNCERTAINTY` up to `longest`. Beyond `longest` the final exponential decay is extrapolated,
    which stays within this error. The number of particles is infinite. A finite gas at fixed energy reaches
    `kurtosis(dimension, count)` instead. See also `relaxation`.

    Parameters
    ----------
    collisions_table : ndarray, shape (n,)
        Values of s.
    equilibrium_table : ndarray, shape (n,)
        Collisions per particle at the same times in a gas in equilibrium.
    log_excess_table : ndarray, shape (n,)
        Logarithm of K_eq - K divided by its initial value, with the kurtosis K.
    log_never_hit_table : ndarray, shape (n,)
        Logarithm of the fraction of particles without a collision.
    mean_speed_table : ndarray, shape (n,)
        Mean speed divided by the root-mean-square speed.

    Examples
    --------
    >>> from gaspart import theory
    >>> curve = theory.relaxation(3)
    >>> curve.kurtosis([0.0, 1.0, 2.0]).round(3)
    array([1.   , 1.202, 1.353])
    """

    dimension: int
    collisions_table: np.ndarray
    equilibrium_table: np.ndarray
    log_excess_table: np.ndarray
    log_never_hit_table: np.ndarray
    mean_speed_table: np.ndarray

    @property
    def longest(self) -> float:
        """Largest tabulated s (dimensionless)."""
        return float(self.collisions_table[-1])

    def _require_not_negative(self, s: Numbers) -> np.ndarray:
        """Return `s` as an array; raise ValueError if a number is negative."""
        s = np.asarray(s, dtype=float)
        if not np.all(s >= 0.0):
            raise ValueError(f"collisions per particle: {s} (must not be negative)")
        return s

    def kurtosis(self, s: Numbers) -> Values:
        """Compute the kurtosis <v^4> / <v^2>^2 after some collisions per particle.

        Parameters
        ----------
        s : array_like, [1]
            Collisions per particle.
        """
        s = self._require_not_negative(s)
        beyond = np.maximum(s - self.longest, 0.0) * KURTOSIS_RELAXATION_RATE[self.dimension]
        log_excess = np.interp(s, self.collisions_table, self.log_excess_table) - beyond
        end = kurtosis(self.dimension)
        return end - (end - 1.0) * np.exp(log_excess)

    def never_hit(self, s: Numbers) -> Values:
        """Compute the fraction of particles that have had no collision.

        Parameters
        ----------
        s : array_like, [1]
            Collisions per particle.
        """
        s = self._require_not_negative(s)
        last_rate = -self.log_never_hit_table[-1] / self.longest
        log_fraction = np.interp(s, self.collisions_table, self.log_never_hit_table)
        return np.exp(log_fraction - last_rate * np.maximum(s - self.longest, 0.0))

    def mean_speed(self, s: Numbers) -> Values:
        """Compute the mean speed divided by the root-mean-square speed.

        Parameters
        ----------
        s : array_like, [1]
            Collisions per particle.
        """
        s = self._require_not_negative(s)
        decay = np.exp(-KURTOSIS_RELAXATION_RATE[self.dimension] * np.maximum(s - self.longest, 0.0))
        end = mean_speed(self.dimension) / math.sqrt(self.dimension)
        return end + (np.interp(s, self.collisions_table, self.mean_speed_table) - end) * decay

    def collisions(self, equilibrium_collisions: Numbers) -> Values:
        """Compute s from the collisions per particle in a gas in equilibrium at the same time.

        s is larger than the argument, because particles of equal speeds collide more often: initially by 2.3
        % in 3D and 1.6 % in 2D. The accuracy is 0.5 %.

        Parameters
        ----------
        equilibrium_collisions : array_like, [1]
            Collisions per particle nu t in a gas in equilibrium at the same energy, with nu =
            `enskog.collision_rate`.
        """
        tau = self._require_not_negative(equilibrium_collisions)
        beyond = np.maximum(tau - self.equilibrium_table[-1], 0.0)
        return np.interp(tau, self.equilibrium_table, self.collisions_table) + beyond


@cache
def relaxation(dimension: int) -> Relaxation:
    """Return the `Relaxation` of discs or spheres."""
    time, s, fourth, _, never, speed = np.loadtxt(
        _TABLES / f"relaxation_{checked_dimension(dimension)}d.csv", delimiter=",", skiprows=1, unpack=True
    )
    end = kurtosis(dimension)
    # per unit of the table's clock a particle collides <v_12> / v_rms times, with the mean relative speed
    # <v_12>
    ticks = math.sqrt(2.0) * mean_speed(dimension) / math.sqrt(dimension)
    return Relaxation(
        dimension=dimension,
        collisions_table=s,
        equilibrium_table=ticks * time,
        log_excess_table=np.log((end - fourth) / (end - 1.0)),
        log_never_hit_table=np.log(never),
        mean_speed_table=speed,
    )


# Entropy of a gas of spheres that relaxes from equal speeds, by the homogeneous Boltzmann equation.
#
# The equation is solved on a grid of energies v^2 in units of the mean square speed. Hard spheres scatter
# isotropically. So for isotropic velocities the rate of collisions of energies a + b -> c + d is proportional
# to the root of the smallest of the four. On the grid, number and energy are conserved to rounding, and the
# entropy rises in each step.


_PER_UNIT = 20.5  # cells per unit of energy; half-integer, so that energy 1 is the middle of a cell
_CELLS = 164  # up to energy 8, above which Maxwell's distribution has 1.6e-5 of the particles
_STEP = 0.05  # collisions per particle in a step
ENTROPY_UNCERTAINTY = 1e-3
"""Uncertainty of `Energies.deficit` due to the grid, for bins as wide as a cell or wider."""


@dataclass(frozen=True)
class Energies:
    """Solution at S times: collisions per particle (S,), fraction never hit (S,), shares of cells (S, K)."""

    collisions: np.ndarray
    never_hit: np.ndarray
    shares: np.ndarray

    @property
    def kurtosis(self) -> np.ndarray:
        """Kurtosis of the speeds at each time."""
        return self.shares @ _middles() ** 2

    def deficit(self, edges: np.ndarray) -> np.ndarray:
        """Compute the entropy deficit of a histogram of speeds at each time; see `entropy_deficit`."""
        cells = np.arange(_CELLS + 1) / _PER_UNIT
        maxwell = np.diff(maxwell_cdf(np.sqrt(cells), 3, 1.0 / 3.0))
        expected = _histogram(edges, maxwell, 0.0)
        rows = zip(self.shares, self.never_hit, strict=True)
        return np.array([entropy_deficit(_histogram(edges, *row), expected) for row in rows])


def entropy_deficit(shares: np.ndarray, expected: np.ndarray) -> np.ndarray:
    """Compute the entropy that a gas lacks to equilibrium, per particle and k_B: the sum of p ln(p/q) over
    classes of the speed with shares p (..., K) and equilibrium shares q (K,).
    """
    ratio = np.where(shares > 0.0, shares, expected) / expected
    return (shares * np.log(ratio)).sum(axis=-1)


def _middles() -> np.ndarray:
    return (np.arange(_CELLS) + 0.5) / _PER_UNIT


def _histogram(edges: np.ndarray, shares: np.ndarray, never_hit: float) -> np.ndarray:
    """Return shares of bins of the speed and of all above; particles never hit have exactly speed 1."""
    spread = shares.copy()
    spread[int(_PER_UNIT)] -= never_hit
    below = np.concatenate([[0.0], np.cumsum(spread)])
    found = np.interp(np.asarray(edges) ** 2, np.arange(_CELLS + 1) / _PER_UNIT, below)
    histogram = np.diff(np.append(found, below[-1]))
    histogram[np.searchsorted(edges, 1.0, side="right") - 1] += never_hit
    return histogram


@cache
def equal_speeds(longest: float) -> Energies:
    """Solve the Boltzmann equation of spheres from equal speeds, up to some collisions per particle."""
    cells, total = np.arange(_CELLS), np.arange(2 * _CELLS - 1)[:, None]  # pairs: a cell and total - cell
    other = total - cells
    exists = (other >= 0) & (other < _CELLS)
    other = np.where(exists, other, 0)
    lower = np.minimum(cells, other)
    once = exists * (2.0 * (2 * cells < total) + 1.0 * (2 * cells == total))  # each pair and its reverse
    root = np.diff(np.arange(_CELLS + 1) ** 1.5)  # states in a cell, and mean root of its energy

    def meeting(pairs: np.ndarray) -> np.ndarray:
        """Sum pairs (total, cell) of equal total, times the smallest root of these two and two others."""
        sums = np.cumsum(once * pairs, axis=1)
        within = np.cumsum(root * once * pairs, axis=1) + root * (sums[:, -1:] - sums)
        return np.where(exists, np.take_along_axis(within, lower, axis=1), 0.0)

    lost = meeting(np.ones_like(once))

    def rates(shares: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        pairs = np.where(exists, (shares / root)[cells] * (shares / root)[other], 0.0)
        return meeting(pairs).sum(axis=0), (pairs * lost).sum(axis=0)

    start = int(_PER_UNIT)
    shares, never, progress = np.eye(_CELLS)[start], 1.0, 0.0
    rows = [(progress, never, shares)]
    while progress < longest:  # midpoint rule
        gain, loss = rates(shares)
        time = _STEP / loss.sum()
        middle = shares + 0.5 * time * (gain - loss)
        never_middle = never * (1.0 - 0.5 * time * loss[start] / shares[start])
        gain, loss = rates(middle)
        never -= time * never_middle * loss[start] / middle[start]
        shares = shares + time * (gain - loss)
        progress += time * loss.sum()
        rows.append((progress, never, shares))
    return Energies(*(np.array(column) for column in zip(*rows, strict=True)))
