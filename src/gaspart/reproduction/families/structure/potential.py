r"""Chemical potential by insertion, and by a fit to the measured equation of state.

:math:`Z(\eta) = Z_\mathrm{ref}(\eta)\,(1 + c_1 \eta + c_2 \eta^2 + c_3 \eta^3)` is fitted to the measured
values. The reference serves only for interpolation between them. The compressibility, the free energy and the
chemical potential then follow by thermodynamics. They are linear in the coefficients.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
import xarray as xr

from gaspart import theory
from gaspart.analysis.estimate import Estimate
from gaspart.analysis.insertion import Insertions, insertions
from gaspart.analysis.run import Run
from gaspart.analysis.statistics import Fit, average, correlated_mean, fit_polynomial
from gaspart.reproduction.families.shared.runs import pressure, runs
from gaspart.reproduction.points.point import Point
from gaspart.reproduction.table import Table, table
from gaspart.scene.gas import plain_gas

POWERS = (1, 2, 3)
_NODES = 40  # nodes of integrals, whose integrands are polynomials except for the reference


@dataclass(frozen=True)
class MeasuredState:
    """Equation of state of one dimension, by a fit to measured Z / Z_ref - 1."""

    dimension: int
    fit: Fit

    def _estimate(self, reference: float, factors: list[float]) -> Estimate:
        """Return a quantity of the reference plus the contribution of each coefficient.

        The degrees of freedom of the error are the smallest of the coefficients.
        """
        parts = np.array(factors)
        error = np.sqrt(parts @ self.fit.covariance @ parts)
        return Estimate(reference + parts @ self.fit.values, error, self.fit.freedoms.min())

    def inverse_compressibility(self, eta: float) -> Estimate:
        """Compute d(eta Z) / d eta."""
        z = float(theory.compressibility_factor(eta, self.dimension))
        slope = 1.0 / float(theory.reduced_compressibility(eta, self.dimension))
        return self._estimate(slope, [eta**n * (slope + n * z) for n in POWERS])

    def _integral(self, eta: float, power: int) -> float:
        """Integrate Z_ref eta'^(power - 1) from 0 to eta."""
        nodes, weights = np.polynomial.legendre.leggauss(_NODES)
        inner = 0.5 * eta * (nodes + 1.0)
        z = theory.compressibility_factor(inner, self.dimension)
        return float(0.5 * eta * weights @ (z * inner ** (power - 1)))

    def free_energy(self, eta: float) -> Estimate:
        """Compute f_excess / (N k_B T), the integral of (Z - 1) / eta."""
        reference = float(theory.excess_free_energy(eta, self.dimension))
        return self._estimate(reference, [self._integral(eta, n) for n in POWERS])

    def chemical_potential(self, eta: float) -> Estimate:
        """Compute mu_excess / (k_B T) by the Gibbs-Duhem relation.

        The result is Z - 1 plus the integral of (Z - 1) / eta.
        """
        z = float(theory.compressibility_factor(eta, self.dimension))
        reference = float(theory.excess_chemical_potential(eta, self.dimension))
        return self._estimate(reference, [z * eta**n + self._integral(eta, n) for n in POWERS])


def measured_states(points: list[Point]) -> dict[int, MeasuredState]:
    """Return the equation of state of each dimension, from all its points in the fluid range."""
    highest = theory.HIGHEST_PACKING_FRACTION
    fluids = [point for point in points if point.scene.packing_fraction <= highest[point.scene.dimension]]
    gases = Table(table("point", fluids, _excess), "point")
    return {
        dimension: MeasuredState(dimension, fit_polynomial(own.packing_fraction, own.excess, powers=POWERS))
        for dimension, own in gases.by("dimension")
    }


def _excess(point: Point) -> dict[str, Any]:
    """Compute Z / Z_ref - 1 of a point, for the infinite system."""
    gas = plain_gas(point.scene)
    state = gas.packing_fraction, gas.dimension
    shift = float(theory.finite_size_correction(*state, gas.count, ensemble="canonical"))
    reference = float(theory.compressibility_factor(*state))
    return {
        "dimension": gas.dimension,
        "packing_fraction": gas.packing_fraction,
        "excess": (pressure(point).z - shift) / reference - 1.0,
    }


# The chemical potential and the partition function. Source C writes the partition function as :math:`V^N Q /
# (h^{dN} N!)\,(2\pi m k_B T)^{dN/2}` (Eqs. 41 to 46). Only the configuration integral Q is unknown. If N
# particles are in place, a further particle at a random position overlaps no other particle with the
# probability :math:`Q_{N+1}/Q_N`. Therefore ln Q is the sum of the logarithms of these probabilities over all
# smaller numbers in one container. Per particle, it is minus the mean of mu_excess / k_B T over all lower
# packing fractions. By the equation of state it is minus the integral of (Z - 1) / eta.


_POWERS = (0, 1, 2)  # powers of eta in the difference between measured chemical potential and reference


def chemical_potential(points: list[Point], settings: dict) -> xr.Dataset:
    """Measure mu_excess / (k_B T) at each point of `measured`, by insertion and Gibbs-Duhem.

    `measured` are experiments. The settings are in `FIGURES`. Variables over `point`, by ascending packing
    fraction in each dimension:

    dimension, packing_fraction, count : properties of the fluid
    probability, expected : probability that a random position is free, and by the measured equation of state
    inserted : chemical potential by insertion, for the infinite fluid (finite size is subtracted)
    integrated, ratio : chemical potential by the measured equation of state, and ratio of both
    reference : chemical potential by the reference equation of state, with _error
    successes, hit_frames, frames : numbers of free positions, of frames that have any, and of all frames
    places : number of random positions that the trials represent
    resolution : probability that corresponds to a single success
    works : 1 if there are `enough` hit frames
    ln_q, ln_q_integrated, ln_q_ratio : minus ln Q / N by insertion, by the equation of state, and their ratio

    ln Q / N is for this packing fraction, and NaN if insertion does not work. `expected` is for this number
    of particles. Variables from probability to ratio, and of ln_q, have _error and _freedom.
    """
    states = measured_states(points)
    measured = [point for point in points if point.experiment in settings["measured"]]
    measured.sort(key=lambda point: (point.scene.dimension, point.scene.packing_fraction))
    rows = [_row(point, states[point.scene.dimension], settings) for point in measured]
    for dimension, state in states.items():
        works = [row for row in rows if row["dimension"] == dimension and row["works"]]
        if len(works) >= len(_POWERS):  # coefficients of the curve
            _add_partition(works, state)
    return table("point", rows, dict, of=measured).assign_attrs(enough=settings["enough"])


def _row(point: Point, state: MeasuredState, settings: dict) -> dict[str, Any]:
    gas = plain_gas(point.scene)
    eta, dimension = gas.packing_fraction, gas.dimension
    insertions = [
        _insertions(run, gas.diameter, settings, point.seed(k)) for k, run in enumerate(runs(point))
    ]
    hits = sum(int(np.count_nonzero(replica.successes)) for replica in insertions)
    frames = sum(len(replica.share) for replica in insertions)
    chance = average([_chance(replica) for replica in insertions])
    finite = float(theory.insertion_finite_size_correction(eta, dimension, gas.count))
    integrated = state.chemical_potential(eta)
    inserted = _minus_log(chance) - finite
    expected = math.exp(-integrated.value - finite)
    resolution = sum(replica.resolution * len(replica.share) ** 2 for replica in insertions) / frames**2
    return {
        "dimension": dimension,
        "packing_fraction": eta,
        "count": gas.count,
        "probability": chance,
        "expected": Estimate(expected, expected * integrated.error, integrated.freedom),
        "inserted": inserted,
        "integrated": integrated,
        "ratio": inserted / integrated,
        "reference": (
            float(theory.excess_chemical_potential(eta, dimension)),
            float(theory.chemical_potential_uncertainty(eta, dimension)),
        ),
        "successes": sum(int(replica.successes.sum()) for replica in insertions),
        "hit_frames": hits,
        "frames": frames,
        "places": 1.0 / resolution,
        "resolution": resolution,
        "works": int(hits >= settings["enough"]),
    }


def _minus_log(chance: Estimate) -> Estimate:
    """Compute minus the logarithm; NaN for 0."""
    if chance.value == 0.0:
        return Estimate(math.nan, math.nan)
    return Estimate(-math.log(chance.value), chance.error / chance.value, chance.freedom)


def _insertions(run: Run, diameter: float, settings: dict, seed: tuple[int, ...]) -> Insertions:
    """Return insertions in evenly spaced frames of a run."""
    positions = run.positions[1:]
    stride = -(-len(positions) // settings["frames"])
    lengths = run.scene.container.lengths
    return insertions(positions[::stride], lengths, [(slice(None), diameter)], settings["trials"], seed)


def _chance(insertions: Insertions) -> Estimate:
    """Average over frames; without a success the error is the resolution."""
    if not insertions.successes.any():
        return Estimate(0.0, insertions.resolution)
    return correlated_mean(insertions.probability).estimate


def _add_partition(rows: list[dict[str, Any]], state: MeasuredState) -> None:
    """Add minus ln Q / N, by insertion and by the equation of state, to rows.

    All rows have the same dimension.
    """
    eta = np.array([row["packing_fraction"] for row in rows])
    logarithms = ln_q(eta, Estimate.stack([row["inserted"] for row in rows]), state.dimension)
    for row, inserted in zip(rows, logarithms, strict=True):
        integrated = state.free_energy(row["packing_fraction"])
        row |= {"ln_q": inserted, "ln_q_integrated": integrated, "ln_q_ratio": inserted / integrated}


def ln_q(eta: np.ndarray, potential: Estimate, dimension: int) -> Estimate:
    """Compute minus ln Q / N at packing fractions eta (n,) from excess chemical potentials.

    A curve is fitted to the potentials: the reference times a polynomial in eta. Its integral over eta is
    divided by eta. The degrees of freedom of the errors are the smallest of the coefficients.
    """
    reference = theory.excess_chemical_potential(eta, dimension)
    fit = fit_polynomial(eta, potential / reference - 1.0, powers=_POWERS)
    nodes, weights = np.polynomial.legendre.leggauss(40)
    inner = 0.5 * eta[:, None] * (nodes + 1.0)
    curve = 0.5 * weights * theory.excess_chemical_potential(inner, dimension)
    parts = np.stack([(curve * inner**power).sum(axis=1) for power in _POWERS], axis=1)
    errors = np.sqrt(((parts @ fit.covariance) * parts).sum(axis=1))
    return Estimate(curve.sum(axis=1) + parts @ fit.values, errors, fit.freedoms.min())
