"""Speeds of a gas: Maxwell's distribution, its moments, and the way there from equal speeds.

k_B = 1; speeds in units of sqrt(temperature / mass).
"""

import math
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import numpy as np

from gaspart.errors import SceneError
from gaspart.theory._arguments import Numbers, Values, checked, checked_dimension

_TABLES = Path(__file__).parent / "data"

KURTOSIS_RELAXATION_RATE = {2: 0.4360, 3: 0.4748}
"""Final decay rate of K - K_eq, per collision per particle (computed; homogeneous Boltzmann equation)."""
RELAXATION_UNCERTAINTY = 3e-4
"""Standard uncertainty of the tabulated kurtosis and never-hit fraction (computed, Monte Carlo)."""


@checked
def mean_speed(
    dimension: int, temperature: float = 1.0, mass: float = 1.0, count: int | None = None
) -> float:
    """Mean speed in equilibrium: sqrt(pi k_B T / 2m) in 2D, sqrt(8 k_B T / (pi m)) in 3D (exact).

    With `count` particles at the fixed energy d N k_B T / 2 it is sqrt(n) Gamma(n) / Gamma(n + 1/2) times
    that, n = d N / 2: their velocities are uniform on a sphere in d N dimensions (exact).
    """
    ratio = {2: 0.5 * math.pi, 3: 8.0 / math.pi}[checked_dimension(dimension)]
    infinite = math.sqrt(ratio * temperature / mass)
    if count is None:
        return infinite
    return infinite * mean_speed_factor(dimension * count)


def mean_speed_factor(freedoms: float) -> float:
    """<|v|> of a velocity component of particles at fixed energy, over that of Maxwell's distribution with
    the same <v^2>: sqrt(n) Gamma(n) / Gamma(n + 1/2), n half the number of degrees of freedom (exact)."""
    half = 0.5 * freedoms
    return math.sqrt(half) * math.exp(math.lgamma(half) - math.lgamma(half + 0.5))


@checked
def maxwell_pdf(speed: Numbers, dimension: int, temperature: float = 1.0, mass: float = 1.0) -> Values:
    """Maxwell's density of speeds (exact; time / length; 0 for negative speeds; same shape as `speed`).

    With u = v sqrt(m / k_B T): u exp(-u^2/2) in 2D, sqrt(2/pi) u^2 exp(-u^2/2) in 3D, times sqrt(m / k_B T).
    """
    checked_dimension(dimension)
    scale = math.sqrt(mass / temperature)
    u = np.maximum(np.asarray(speed, dtype=float) * scale, 0.0)
    factor = u if dimension == 2 else math.sqrt(2.0 / math.pi) * u**2
    return scale * factor * np.exp(-0.5 * u**2)


@checked
def maxwell_cdf(
    speed: Numbers,
    dimension: int,
    temperature: float = 1.0,
    mass: float = 1.0,
    freedoms: float | None = None,
) -> Values:
    """Fraction of particles slower than `speed` (exact): incomplete gamma function P(d/2, m v^2 / 2 k_B
    T).

    With `freedoms` D, of equal particles at the fixed energy D k_B T / 2 together: their velocities are
    uniform on a sphere in D dimensions, d of which are those of one particle, and x = m v^2 / (D k_B T) has a
    beta distribution: I_x(d/2, (D - d)/2) (exact). D is d N; or d (N - 1) for velocities about the centre of
    mass times sqrt(N / (N - 1)). Raises SceneError for D <= d.
    """
    from scipy.special import betainc, gammainc

    energy = 0.5 * mass / temperature * np.maximum(np.asarray(speed, dtype=float), 0.0) ** 2
    half = 0.5 * checked_dimension(dimension)
    if freedoms is None:
        return gammainc(half, energy)
    if not freedoms > dimension:
        raise SceneError("freedoms", freedoms, f"must be more than the {dimension} of one particle")
    return betainc(half, 0.5 * freedoms - half, np.minimum(2.0 * energy / freedoms, 1.0))


@checked
def maxwell_ppf(probability: Numbers, dimension: int, temperature: float = 1.0, mass: float = 1.0) -> Values:
    """Speed below which the fraction `probability` of the particles lies: inverse of `maxwell_cdf`
    (exact)."""
    from scipy.special import gammaincinv

    checked_dimension(dimension)
    energy = gammaincinv(0.5 * dimension, np.asarray(probability, dtype=float))
    return np.sqrt(2.0 * temperature / mass * energy)


@checked
def kurtosis(dimension: int, count: int | None = None, zero_momentum: bool = False) -> float:
    """<v^4> / <v^2>^2 in equilibrium: (d+2)/d, that is 2 in 2D and 5/3 in 3D (exact).

    With `count` particles at fixed energy the velocities are uniform on a sphere in D = d N dimensions (d
    (N-1) if the total momentum is held at zero), and a particle's kurtosis is (d+2)/d times D/(D+2) (exact).
    """
    infinite = (checked_dimension(dimension) + 2.0) / dimension
    if count is None:
        return infinite
    freedoms = dimension * (count - 1 if zero_momentum else count)
    return infinite * freedoms / (freedoms + 2.0)


@checked
def kurtosis_scatter(dimension: int, count: int) -> tuple[float, float]:
    """Standard deviation and skewness, over equilibrium, of the kurtosis of `count` particles at one time.

    Of velocities uniform on a sphere in D = d N dimensions (exact): the kurtosis is N sum(q) / (sum e)^2 with
    e = v^2 and q = e^2, which does not depend on sum(e) there. So its moment of order m is N^m <sum(q)^m> /
    <(sum e)^2m> of independent normal velocities, whose <e^k> is d (d+2) ... (d+2k-2). A total momentum held
    at zero changes it by a part 1/N (neglected).
    """

    def moment(freedoms: int, order: int) -> float:
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
    """dK/ds at s = 0 from equal speeds, s collisions per particle: 64/225 in 2D, 8/35 in 3D (exact)."""
    return {2: 64.0 / 225.0, 3: 8.0 / 35.0}[checked_dimension(dimension)]


@dataclass(frozen=True)
class Relaxation:
    """Relaxation of a gas in which all speeds are equal at first, from the homogeneous Boltzmann equation.

    `s` is the number of collisions per particle so far, 2 N_collisions / N: on that clock the curves do not
    depend on diameter, speed or density (Enskog theory). Computed by Monte Carlo, good to
    RELAXATION_UNCERTAINTY up to `longest`; beyond it the last decay is continued, which stays within that
    error. Infinite number of particles: a finite gas at fixed energy ends at `kurtosis(dimension, count)`
    instead.
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

    def _checked(self, s: Numbers) -> np.ndarray:
        s = np.asarray(s, dtype=float)
        if not np.all(s >= 0.0):
            raise ValueError(f"collisions per particle: {s} (must not be negative)")
        return s

    def kurtosis(self, s: Numbers) -> Values:
        """<v^4> / <v^2>^2 after `s` collisions per particle: 1 at first, (d+2)/d in the end
        (dimensionless)."""
        s = self._checked(s)
        beyond = np.maximum(s - self.longest, 0.0) * KURTOSIS_RELAXATION_RATE[self.dimension]
        log_excess = np.interp(s, self.collisions_table, self.log_excess_table) - beyond
        end = kurtosis(self.dimension)
        return end - (end - 1.0) * np.exp(log_excess)

    def never_hit(self, s: Numbers) -> Values:
        """Fraction of the particles that have had no collision (dimensionless); slightly below exp(-s)."""
        s = self._checked(s)
        last_rate = -self.log_never_hit_table[-1] / self.longest
        log_fraction = np.interp(s, self.collisions_table, self.log_never_hit_table)
        return np.exp(log_fraction - last_rate * np.maximum(s - self.longest, 0.0))

    def mean_speed(self, s: Numbers) -> Values:
        """Mean speed over the root-mean-square speed: 1 at first, `mean_speed(d) / sqrt(d)` in the end."""
        s = self._checked(s)
        decay = np.exp(-KURTOSIS_RELAXATION_RATE[self.dimension] * np.maximum(s - self.longest, 0.0))
        end = mean_speed(self.dimension) / math.sqrt(self.dimension)
        return end + (np.interp(s, self.collisions_table, self.mean_speed_table) - end) * decay

    def collisions(self, equilibrium_collisions: Numbers) -> Values:
        """s at the time when a gas in equilibrium would have had `equilibrium_collisions` per particle.

        The argument is nu t at the same energy, with nu = `enskog.collision_rate`. s is the larger:
        particles of equal speeds collide more often, by 2.3 % in 3D and 1.6 % in 2D at first. Good to 0.5 %.
        """
        tau = self._checked(equilibrium_collisions)
        beyond = np.maximum(tau - self.equilibrium_table[-1], 0.0)
        return np.interp(tau, self.equilibrium_table, self.collisions_table) + beyond


@cache
def relaxation(dimension: int) -> Relaxation:
    """The `Relaxation` of discs (2) or spheres (3), from the tables in `theory/data` (computed)."""
    time, s, fourth, _, never, speed = np.loadtxt(
        _TABLES / f"relaxation_{checked_dimension(dimension)}d.csv", delimiter=",", skiprows=1, unpack=True
    )
    end = kurtosis(dimension)
    # In one tick of the table's clock a particle collides <v_12> / v_rms times, <v_12> the mean relative
    # speed.
    ticks = math.sqrt(2.0) * mean_speed(dimension) / math.sqrt(dimension)
    return Relaxation(
        dimension=dimension,
        collisions_table=s,
        equilibrium_table=ticks * time,
        log_excess_table=np.log((end - fourth) / (end - 1.0)),
        log_never_hit_table=np.log(never),
        mean_speed_table=speed,
    )
