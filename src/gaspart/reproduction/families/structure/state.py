r"""The measured equation of state: Z of many packing fractions, joined to a curve.

:math:`Z(\eta) = Z_\mathrm{ref}(\eta)\,(1 + c_1 \eta + c_2 \eta^2 + c_3 \eta^3)` is fitted to the measured
values, the reference being there to interpolate between them. What follows is thermodynamics: the
compressibility, the free energy and the chemical potential are linear in the coefficients.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from gaspart import theory
from gaspart.analysis.estimate import Estimate
from gaspart.analysis.statistics import Fit, fit_polynomial
from gaspart.reproduction.families.shared.pressure import pressure
from gaspart.reproduction.points.point import Point
from gaspart.reproduction.table import Table, table
from gaspart.scene.gas import plain_gas

POWERS = (1, 2, 3)
_NODES = 40  # of integrals, whose integrands are polynomials but for the reference


@dataclass(frozen=True)
class MeasuredState:
    """Equation of state of one dimension, by a fit to measured Z / Z_ref - 1."""

    dimension: int
    fit: Fit

    def _estimate(self, reference: float, factors: list[float]) -> Estimate:
        """Return a quantity of the reference with the additions of each coefficient.

        The degrees of freedom of the error are the fewest of the coefficients'.
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
        """Compute mu_excess / (k_B T) by Gibbs and Duhem.

        It is Z - 1 plus the integral of (Z - 1) / eta.
        """
        z = float(theory.compressibility_factor(eta, self.dimension))
        reference = float(theory.excess_chemical_potential(eta, self.dimension))
        return self._estimate(reference, [z * eta**n + self._integral(eta, n) for n in POWERS])


def measured_states(points: list[Point]) -> dict[int, MeasuredState]:
    """Return the equation of state of each dimension, from all its points in the fluid's range."""
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
