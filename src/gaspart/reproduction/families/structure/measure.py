r"""Structure of spheres and discs: g(r), S(k), and two numbers by several methods.

- The compressibility: by S(k) extrapolated to k = 0, and by :math:`1 / (d(\eta Z)/d\eta)` of the measured
  equation of state. 1 / S(k) = 1 - rho c(k), with the direct correlation function c. Its range is about one
  diameter. Therefore c(k) is an even power series that converges fast for k up to a few inverse diameters. 1
  / S is fitted by a polynomial in :math:`k^2` of order three, at all wave vectors of the container.
- The contact value of N particles: by g(r) extrapolated to the diameter, by the collisional virial,
  :math:`(Z_N - 1) / (2^{d-1} \eta)`, and by the collision rate divided by the rate of independent particles.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, fields
from typing import Any

import numpy as np
import xarray as xr

from gaspart import theory
from gaspart.analysis.estimate import Estimate
from gaspart.analysis.pairs import radial_distribution
from gaspart.analysis.run import Run
from gaspart.analysis.series import Blocks
from gaspart.analysis.statistics import fit_polynomial, jackknife, means_of
from gaspart.analysis.structure_factors import factors, in_shells, shells_of, wave_vectors
from gaspart.reproduction.families.shared.runs import runs, series_of
from gaspart.reproduction.families.structure.potential import (
    MeasuredState,
    chemical_potential,
    measured_states,
)
from gaspart.reproduction.points.point import Point
from gaspart.reproduction.table import table
from gaspart.scene.gas import Gas, plain_gas

__all__ = ["chemical_potential", "structure"]

Law = Callable[[np.ndarray, float], Any]

BLOCKS = 10
"""Number of blocks of each run; their scatter determines the errors."""
ORDERS = (0, 2, 4, 6)
"""Powers of k in the fit of 1 / S(k)."""
WIDTH = 0.005
"""Width of the bins of g(r) at contact, in diameters."""
WINDOW = 0.45
"""Range of the fit of g(r) at contact, times the contact value; the relative decrease of g in the range is
nearly constant."""
BINS, SHELLS, WAVES = 160, 80, 24
"""Number of bins of g(r) and of S(k) in the figure, and number of wave vectors in each bin of S(k)."""


@dataclass(frozen=True)
class Averages:
    """Means over blocks of frames, of all runs of a point.

    low : (B, M), S at the smallest wave numbers.
    near : (B, n), g near contact.
    g, s : (B, BINS) and (B, shells), the curves.
    z, rate : (B,).
    """

    low: np.ndarray
    near: np.ndarray
    g: np.ndarray
    s: np.ndarray
    z: np.ndarray
    rate: np.ndarray


def structure(points: list[Point], settings: dict) -> xr.Dataset:
    """Measure g(r), S(k) and derived numbers at each point of the experiments `measured`.

    The settings are in `FIGURES`. Variables over `point`, the numbers with _error and _freedom:

    dimension, packing_fraction, count : properties of the fluid
    s0, state_s0, s0_ratio : extrapolated S(0), S(0) by the measured equation of state, and their ratio
    contact_g, contact_z, contact_rate : (N - 1) / N times contact value, from g, Z and collision rate
    g_ratio, rate_ratio : contact_g and contact_rate divided by contact_z
    g_gain, s_gain : of spheres, distance of the curve from Verlet-Weis over distance from Percus-Yevick

    Distances of curves are root mean squares. Curves with _error are g over `bin`, at `distance` in
    diameters, and s over `shell`, at `wave_number` times the diameter.
    """
    measured = [point for point in points if point.experiment in settings["measured"]]
    inner = {"g": ("bin",), "distance": ("bin",), "s": ("shell",), "wave_number": ("shell",)}
    return table("point", measured, _row, measured_states(points), settings, inner=inner)


def _row(point: Point, states: dict[int, MeasuredState], settings: dict) -> dict[str, Any]:
    gas = plain_gas(point.scene)
    eta, dimension = gas.packing_fraction, gas.dimension
    lengths = np.array(point.scene.container.lengths) / gas.diameter
    low, size = wave_vectors(lengths, settings["small"])
    waves, shell, k = shells_of(lengths, settings["highest"], SHELLS, WAVES)
    furthest = min(settings["furthest"], 0.499 * float(lengths.min()))
    curves = waves, shell, furthest
    parts = [_blocks(run, gas, low, curves, settings["frames"]) for run in runs(point)]
    averages = Averages(
        *(np.concatenate([getattr(part, key.name) for part in parts]) for key in fields(Averages))
    )
    distance = furthest * (np.arange(BINS) + 0.5) / BINS
    row = _numbers(averages, gas, size)
    row["state_s0"] = 1.0 / states[dimension].inverse_compressibility(eta)
    row["s0_ratio"] = row["s0"] / row["state_s0"]
    if dimension == 3:
        row["g_gain"] = _gain(averages.g, theory.verlet_weis_rdf, theory.percus_yevick_rdf, distance, eta)
        laws = theory.verlet_weis_structure_factor, theory.percus_yevick_structure_factor
        row["s_gain"] = _gain(averages.s, *laws, k, eta)
    return {
        "dimension": dimension,
        "packing_fraction": eta,
        "count": gas.count,
        **row,
        "g": means_of(averages.g),
        "s": means_of(averages.s),
        "distance": distance,
        "wave_number": k,
    }


def _blocks(run: Run, gas: Gas, low: np.ndarray, curves: tuple, most: int) -> Averages:
    """Compute the averages of one run, with lengths in diameters.

    `curves` has wave vectors, their shells, and the largest distance. The curves use about `most` frames.
    """
    parts, series = Blocks(run, BLOCKS), series_of(run)
    sides = np.array(run.scene.container.lengths) / gas.diameter
    blocks = np.split(run.positions[parts.frames] / gas.diameter, BLOCKS)
    stride = max(1, (len(run.positions) - 1) // most)
    few = [frames[::stride] for frames in blocks]
    waves, shell, furthest = curves
    rounding = 2.0**-18  # so that pairs in contact are not below the first bin

    def g(frames: np.ndarray, bins: int, end: float) -> np.ndarray:
        pairs = gas.count / (gas.count - 1.0)
        return pairs * radial_distribution(frames, sides, bins, end)[1]

    def s(frames: np.ndarray, vectors: np.ndarray) -> np.ndarray:
        return np.asarray(factors(frames, sides, vectors).mean(axis=0))

    contact = round(1.0 / WIDTH)
    return Averages(
        low=np.array([s(frames, low) for frames in blocks]),
        near=np.array([g(frames, round(1.5 / WIDTH), 1.5 - rounding)[contact:] for frames in blocks], float),
        g=np.array([g(frames, BINS, furthest) for frames in few], float),
        s=np.array([in_shells(s(frames, waves), shell) for frames in few]),
        z=parts.means(series.z),
        rate=parts.means(series.rate),
    )


def _numbers(averages: Averages, gas: Gas, size: np.ndarray) -> dict[str, Estimate]:
    """Compute the compressibility and the contact values from block averages.

    S is given at wave numbers `size` (M,).
    """
    unit = 1.0 / (2.0 ** (gas.dimension - 1) * gas.packing_fraction)
    per_rate = _contact_per_rate(gas)
    contact = (averages.z.mean() - 1.0) * unit
    first = max(len(ORDERS) + 2, round(WINDOW / contact / WIDTH))
    distance = WIDTH * (np.arange(first) + 0.5)
    pairs = np.sqrt(averages.near[:, :first].mean(axis=0)) / (1.0 + distance) ** (0.5 * (gas.dimension - 1))
    k, equal, number = np.unique(size.round(9), return_inverse=True, return_counts=True)
    low = np.array([in_shells(values, equal) for values in averages.low])
    spread = 1.0 / (low.mean(axis=0) * np.sqrt(number))  # weights of 1 / S, up to a factor

    def at_contact(near: np.ndarray) -> float:
        fit = fit_polynomial(distance, near[:first], pairs, powers=(0, 1, 2, 3))
        return float(fit.values[0]) * (1.0 - 1.0 / gas.count)

    def at_zero(low: np.ndarray) -> float:
        return 1.0 / float(fit_polynomial(k, 1.0 / low, spread, powers=ORDERS).values[0])

    routes = {
        "s0": jackknife(at_zero, low),
        "contact_g": jackknife(at_contact, averages.near),
        "contact_z": jackknife(lambda z: (z - 1.0) * unit, averages.z),
        "contact_rate": jackknife(lambda rate: rate * per_rate, averages.rate),
        "g_ratio": jackknife(
            lambda near, z: at_contact(near) / ((z - 1.0) * unit), averages.near, averages.z
        ),
        "rate_ratio": jackknife(
            lambda rate, z: rate * per_rate / ((z - 1.0) * unit), averages.rate, averages.z
        ),
    }
    return {name: Estimate(*result, len(averages.z) - 1) for name, result in routes.items()}


def _contact_per_rate(gas: Gas) -> float:
    """Compute the contact value times (N - 1) / N, divided by the reduced collision rate.

    This ratio is exact for N particles. The reference equation of state cancels.
    """
    eta, dimension, count = gas.packing_fraction, gas.dimension, gas.count
    excess = theory.compressibility_factor(eta, dimension) - 1.0
    excess += theory.finite_size_correction(eta, dimension, count, "canonical")
    rate = theory.collision_rate(eta, dimension)
    rate *= theory.collision_rate_finite_size_factor(eta, dimension, count)
    return float(excess / (2.0 ** (dimension - 1) * eta * rate))


def _gain(samples: np.ndarray, better: Law, worse: Law, x: np.ndarray, eta: float) -> Estimate:
    """Compute the distance of the mean of samples (B, n) from one theory over another.

    Distances are root mean squares.
    """
    laws = [law(x, eta) for law in (better, worse)]

    def gain(mean: np.ndarray) -> float:
        near, far = (float(((mean - law) ** 2).sum()) for law in laws)
        return float(np.sqrt(near / far))

    return Estimate(*jackknife(gain, samples), len(samples) - 1)
