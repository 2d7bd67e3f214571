"""Values of a run in each interval between frames, and in blocks of intervals.

Z, the collision rate and the pressures on faces are computed only in this module. The functions of
`gaspart.analysis` reduce these values to a mean with an uncertainty. Figures combine the values in other
ways.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from gaspart.analysis.flow import Grid, per_area
from gaspart.analysis.run import Run
from gaspart.errors import SceneError
from gaspart.state.tally import compressibility_factor


def compressibility(run: Run) -> np.ndarray:
    r"""Compute the compressibility factor Z in each interval by the virial theorem, shape (T - 1,). With
    impulses dp exchanged at the distance dr,

        Z = P V / (N k_B T) = 1 + sum |dr . dp| / (d N k_B T t).

    The temperature is defined by the motion relative to the centre of mass, k_B T = 2 E' / (d (N - 1)). In a
    pair collision |dp| and the collision rate are both proportional to |v_n|, where v_n is the normal
    component of v_1 - v_2. So the sum is proportional to <v_n^2>. This mean is linear in the energy, so it is
    the same at fixed energy as in the canonical ensemble. With zero total momentum <v_1 . v_2> = -<v^2> / (N
    - 1), hence <v_n^2> = 2 k_B T / m with this T. So Z - 1 is the value of the canonical ensemble of N
    particles. Its difference from the infinite system is known to first order in 1/N
    (`theory.finite_size_correction(..., ensemble="canonical")`).
    """
    return compressibility_factor(
        run.increments("virial_sum"), run.count, run.dimension, run.temperature, np.diff(run.time)
    )


def collisions(run: Run) -> np.ndarray:
    """Compute the mean collisions of a moving particle in each interval, shape (T - 1,). A collision of two
    moving particles counts for both. Raises SceneError if the file does not contain all particles, or does
    not contain the number of collisions with fixed particles.
    """
    scene, met, count = run.scene, run.increments("collisions"), int(run.moving.sum())
    if count == 1:
        return np.asarray(met)
    if scene.has_fixed and "fixed_collisions" not in run.data:
        rule = "collisions with fixed particles are not counted apart; make the run again"
        raise SceneError("fixed_collisions", "missing", rule)
    with_fixed = run.increments("fixed_collisions") if scene.has_fixed else 0.0
    return np.asarray((2.0 * met - with_fixed) / count)


def collision_rate(run: Run) -> np.ndarray:
    """Compute the collision rate of a moving particle in each interval, shape (T - 1,)."""
    return collisions(run) / np.diff(run.time)


def face_impulses(run: Run) -> np.ndarray:
    """Compute the momentum (T - 1, 2d) given to each face in each interval, positive outwards. The momentum
    is 0 along axes without walls.
    """
    return np.asarray(run.increments("wall_impulse")[:, : 2 * run.dimension])


def face_pressures(run: Run) -> np.ndarray:
    """Compute the pressure on each face in each interval, as defined by `analysis.wall_pressure`. The shape
    is (T - 1, 2d). Unknown pressures are NaN.
    """
    return per_area(run, face_impulses(run), "momentum_per_area") / np.diff(run.time)[:, None]


@dataclass(frozen=True)
class Blocks:
    """K blocks of a run with equal lengths; the remaining frames are not used. Neighbouring blocks share the
    frame at which counters are read. Averages over frames exclude the first frame of the run. Raises
    ValueError for more blocks than intervals.
    """

    run: Run
    number: int

    @property
    def length(self) -> int:
        """Number of intervals in each block, equal to the number of frames."""
        return self.run.block_length(self.number)

    @property
    def ends(self) -> slice:
        """Indices (K + 1,) of the frames at the ends of the blocks."""
        return slice(None, self.number * self.length + 1, self.length)

    @property
    def frames(self) -> slice:
        """Slice of all frames in the blocks."""
        return slice(1, self.number * self.length + 1)

    @property
    def durations(self) -> np.ndarray:
        """Duration (K,) of each block."""
        return np.diff(self.run.time[self.ends])

    def growth(self, name: str) -> np.ndarray:
        """Compute the growth of a counter per time in each block, shape (K, ...)."""
        grown = np.diff(self.run.data[name].values[self.ends], axis=0)
        return np.asarray(grown / self.durations.reshape(-1, *[1] * (grown.ndim - 1)))

    def means(self, values: np.ndarray) -> np.ndarray:
        """Average values of intervals (T - 1, ...) in each block, shape (K, ...)."""
        used = values[: self.number * self.length]
        return np.asarray(used.reshape(self.number, self.length, *used.shape[1:]).mean(axis=1))

    def means_of_frames(self, values: np.ndarray) -> np.ndarray:
        """Average values of frames (T, ...) in each block, shape (K, ...)."""
        return self.means(values[1:])

    def sums(self, grid: Grid, cells: np.ndarray, weights: np.ndarray | None = None) -> np.ndarray:
        """Sum weights (T, N), or count particles, in cells over the frames of each block. The shape is (K,
        *cells).
        """
        block = np.arange(self.number).repeat(self.length)
        chosen = None if weights is None else np.broadcast_to(weights, cells.shape)[self.frames]
        return grid.sums(cells[self.frames], chosen, block)


def over(values: np.ndarray, ends: np.ndarray) -> np.ndarray:
    """Sum the values (T - 1, ...) of the intervals between frames `ends` (K + 1,). The sums have shape (K,
    ...).
    """
    return np.add.reduceat(values[: ends[-1]], ends[:-1], axis=0)


# Pressure at which two phases coexist, from a loop of P against volume: Maxwell's equal-area construction.


REPEATS = 100
"""Number of bootstrap samples of the loop; their scatter gives the error."""
_FINE = 2000


def plateau(
    volume: np.ndarray, pressure: np.ndarray, error: np.ndarray
) -> tuple[float, float, tuple[float, float]]:
    """Compute the coexistence pressure from a loop of p(V), by Maxwell's equal-area construction. A
    horizontal line at this pressure cuts off equal areas of the loop. Returns the pressure, its error, and
    the volumes at both ends of the line. The arguments are the volume per particle (in any order), the
    pressure and its standard errors, each of shape (P,). A finite system in the coexistence region has a loop
    (Mayer and Wood, J. Chem. Phys. 42, 4268 (1965)) because the interface of the finite system costs free
    energy. If the areas are equal, both phases have the same chemical potential. The loop is interpolated
    between the points by the monotonic method of Fritsch and Carlson. For the error, the points are drawn
    again from their errors many times; the error is half of the width of the central 68 % of the resulting
    pressures. Without a loop, or if less than half of the bootstrap samples have a loop, the result is NaN,
    NaN, (NaN, NaN).
    """
    order = np.argsort(volume)
    volume, pressure, error = (np.asarray(values, dtype=float)[order] for values in (volume, pressure, error))
    value, ends = _equal_areas(volume, pressure)
    noise = error * np.random.default_rng(0).standard_normal((REPEATS, error.size))
    redrawn = np.array([_equal_areas(volume, pressure + shift)[0] for shift in noise])
    finite = redrawn[np.isfinite(redrawn)]
    if math.isnan(value) or finite.size < REPEATS / 2:
        return math.nan, math.nan, (math.nan, math.nan)
    return value, float(0.5 * np.diff(np.percentile(finite, [15.87, 84.13]))[0]), ends


def _equal_areas(volume: np.ndarray, pressure: np.ndarray) -> tuple[float, tuple[float, float]]:
    """Return the pressure of the equal-area line and the volumes at its ends, largest first."""
    from scipy.interpolate import PchipInterpolator
    from scipy.optimize import brentq

    v = np.linspace(volume[0], volume[-1], _FINE)
    p = PchipInterpolator(volume, pressure)(v)
    rising = np.flatnonzero(np.diff(p) > 0.0)
    nothing = math.nan, (math.nan, math.nan)
    if rising.size == 0:
        return nothing
    low, high = p[rising[0] : rising[-1] + 2].min(), p[rising[0] : rising[-1] + 2].max()
    low, high = max(low, p[-1]), min(high, p[0])
    if not low < high:
        return nothing

    def ends(level: float) -> tuple[int, int]:
        inside = np.flatnonzero((p[:-1] - level) * (p[1:] - level) <= 0.0)
        return inside[0], inside[-1] + 1

    def excess(level: float) -> float:
        first, last = ends(level)
        return float(np.trapezoid(p[first : last + 1] - level, v[first : last + 1]))

    margin = 1e-9 * (high - low)
    if excess(low + margin) * excess(high - margin) > 0.0:
        return nothing
    level = brentq(excess, low + margin, high - margin, xtol=1e-6)
    first, last = ends(level)
    return float(level), (float(v[last]), float(v[first]))
