r"""The measured equation of state: Z of many packing fractions, joined to a curve.

:math:`Z(\eta) = Z_\mathrm{ref}(\eta)\,(1 + c_1 \eta + c_2 \eta^2 + c_3 \eta^3)` is fitted to the measured
values, the reference being there to interpolate between them. What follows is thermodynamics: the
compressibility, the free energy and the chemical potential are linear in the coefficients.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from gaspart import theory
from gaspart.analysis.estimate import Estimate
from gaspart.analysis.statistics import Fit, fit_polynomial
from gaspart.reproduction.families.shared.pressure import Pressure, pressure
from gaspart.reproduction.points.point import Point
from gaspart.scene.gas import plain_gas

POWERS = (1, 2, 3)
_NODES = 40  # of integrals, whose integrands are polynomials but for the reference


@dataclass(frozen=True)
class MeasuredState:
    """The equation of state of one dimension, by a fit to measured Z / Z_ref - 1."""

    dimension: int
    fit: Fit

    def _estimate(self, reference: float, factors: list[float]) -> Estimate:
        """A quantity of the reference and what each coefficient adds to it; the degrees of freedom of the
        error are the fewest of the coefficients'."""
        parts = np.array(factors)
        error = np.sqrt(parts @ self.fit.covariance @ parts)
        return Estimate(reference + parts @ self.fit.values, error, self.fit.freedoms.min())

    def inverse_compressibility(self, eta: float) -> Estimate:
        """d(eta Z) / d eta."""
        z = float(theory.compressibility_factor(eta, self.dimension))
        slope = 1.0 / float(theory.reduced_compressibility(eta, self.dimension))
        return self._estimate(slope, [eta**n * (slope + n * z) for n in POWERS])

    def _integral(self, eta: float, power: int) -> float:
        """That of Z_ref eta'^(power - 1) from 0 to eta."""
        nodes, weights = np.polynomial.legendre.leggauss(_NODES)
        inner = 0.5 * eta * (nodes + 1.0)
        return float(
            0.5
            * eta
            * weights
            @ (theory.compressibility_factor(inner, self.dimension) * inner ** (power - 1))
        )

    def free_energy(self, eta: float) -> Estimate:
        """F_excess / (N k_B T), the integral of (Z - 1) / eta."""
        reference = float(theory.excess_free_energy(eta, self.dimension))
        return self._estimate(reference, [self._integral(eta, n) for n in POWERS])

    def chemical_potential(self, eta: float) -> Estimate:
        """mu_excess / (k_B T) by Gibbs and Duhem, Z - 1 and the integral of (Z - 1) / eta."""
        z = float(theory.compressibility_factor(eta, self.dimension))
        reference = float(theory.excess_chemical_potential(eta, self.dimension))
        return self._estimate(reference, [z * eta**n + self._integral(eta, n) for n in POWERS])


def measured_states(points: list[Point]) -> tuple[dict[int, MeasuredState], dict[str, Pressure]]:
    """The equation of state of each dimension, of all points; and the pressure of each point, by its path.

    Z is corrected to the infinite system. Points beyond the fluid's reference are left out of the fit.
    """
    pressures = {point.path: pressure(point) for point in points}
    states = {}
    for dimension in {point.scene.dimension for point in points}:
        eta, values = [], []
        for point in points:
            gas = plain_gas(point.scene)
            if (
                gas.dimension != dimension
                or gas.packing_fraction > theory.HIGHEST_PACKING_FRACTION[dimension]
            ):
                continue
            shift = float(
                theory.finite_size_correction(
                    gas.packing_fraction, dimension, gas.count, ensemble="canonical"
                )
            )
            reference = float(theory.compressibility_factor(gas.packing_fraction, dimension))
            eta.append(gas.packing_fraction)
            values.append((pressures[point.path].z - shift) / reference - 1.0)
        ratios = [value.value for value in values], [value.error for value in values]
        freedoms = [value.freedom for value in values]
        fit = fit_polynomial(np.array(eta), *ratios, powers=POWERS, freedoms=freedoms)
        states[dimension] = MeasuredState(dimension, fit)
    return states, pressures
