"""A number with its standard uncertainty."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import xarray

Scalar = Any
"""A number of any library, an array without dimensions too; kept as a float."""


@dataclass(frozen=True)
class Estimate:
    """A number and its standard uncertainty, 0 where it is exact.

    freedom: degrees of freedom of the uncertainty, if it comes from the scatter of a few samples (their
    number less one); infinite if it is known otherwise. A deviation is then distributed as Student's t. Sums,
    products and quotients propagate the uncertainties of independent numbers to first order, and the degrees
    of freedom by the formula of Welch and Satterthwaite (Biometrics Bulletin 2, 110 (1946)). Raises
    ValueError for a negative uncertainty, and for degrees of freedom that are not positive.
    """

    value: Scalar
    error: Scalar = 0.0
    freedom: Scalar = math.inf

    def __post_init__(self) -> None:
        for name in ("value", "error", "freedom"):
            object.__setattr__(self, name, float(getattr(self, name)))
        if self.error < 0.0:
            raise ValueError(f"error: {self.error} (must not be negative)")
        if self.freedom <= 0.0:
            raise ValueError(f"freedom: {self.freedom} (must be positive)")

    @classmethod
    def of(cls, dataset: xarray.Dataset, name: str) -> Estimate:
        """The scalar variable `name` of a dataset, with the variable `name`_error as its uncertainty, and
        `name`_freedom, if there is one and it is finite, as the degrees of freedom of the uncertainty."""
        freedom = float(dataset.get(f"{name}_freedom", math.inf))
        return cls(dataset[name], dataset[f"{name}_error"], freedom if freedom > 0.0 else math.inf)

    @property
    def deviation(self) -> float:
        """Distance from 0 in standard deviations, infinite for an exact number that is not 0.

        Where the uncertainty comes from a few samples, the Gaussian deviation of the same probability as that
        of Student's t.
        """
        if self.error == 0.0:
            return math.copysign(math.inf, self.value) if self.value else 0.0
        t = self.value / self.error
        if math.isinf(self.freedom) or t == 0.0 or not math.isfinite(t):
            return t
        from scipy.special import ndtri, stdtr

        beyond = max(float(stdtr(self.freedom, -abs(t))), 1e-300)
        return math.copysign(-float(ndtri(beyond)), t)

    def __str__(self) -> str:
        return concise(self.value, self.error)

    def __neg__(self) -> Estimate:
        return Estimate(-self.value, self.error, self.freedom)

    def __add__(self, other: Estimate | Scalar) -> Estimate:
        other = as_estimate(other)
        return _sum(self.value + other.value, (self.error, self.freedom), (other.error, other.freedom))

    def __sub__(self, other: Estimate | Scalar) -> Estimate:
        return self + -as_estimate(other)

    def __mul__(self, other: Estimate | Scalar) -> Estimate:
        other = as_estimate(other)
        mine, its = self.error * abs(other.value), abs(self.value) * other.error
        return _sum(self.value * other.value, (mine, self.freedom), (its, other.freedom))

    def __truediv__(self, other: Estimate | Scalar) -> Estimate:
        other = as_estimate(other)
        value = self.value / other.value
        mine, its = self.error / abs(other.value), abs(value) * other.error / abs(other.value)
        return _sum(value, (mine, self.freedom), (its, other.freedom))


def concise(value: float, error: float) -> str:
    """A number with its uncertainty in the last two digits, as 1.242(20); without one, to six digits."""
    if not (0.0 < error < math.inf and math.isfinite(value)):
        return f"{value:.6g}"
    largest = max(abs(value), error)
    if not 1e-4 <= largest < 1e7:
        power = math.floor(math.log10(largest))
        return f"{concise(value / 10.0**power, error / 10.0**power)}e{power}"
    decimals = 1 - int(f"{error:.1e}".partition("e")[2])
    if decimals > 0:
        return f"{value:.{decimals}f}({round(error * 10**decimals)})"
    return f"{round(value, decimals):.0f}({round(error, decimals):.0f})"


def _sum(value: float, *parts: tuple[float, float]) -> Estimate:
    """The value with the uncertainty of all parts, each (error, degrees of freedom)."""
    error = math.hypot(*(error for error, _ in parts))
    if error == 0.0 or not math.isfinite(error):
        return Estimate(value, error)
    inverse = sum((part / error) ** 4 / freedom for part, freedom in parts)
    return Estimate(value, error, 1.0 / inverse if inverse > 0.0 else math.inf)


def as_estimate(number: Estimate | Scalar) -> Estimate:
    """An estimate as it is, another number as an exact one."""
    return number if isinstance(number, Estimate) else Estimate(number)
