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

    Sums, products and quotients propagate the uncertainties of independent numbers to first order. Raises
    ValueError for a negative uncertainty.
    """

    value: Scalar
    error: Scalar = 0.0

    def __post_init__(self) -> None:
        for name in ("value", "error"):
            object.__setattr__(self, name, float(getattr(self, name)))
        if self.error < 0.0:
            raise ValueError(f"error: {self.error} (must not be negative)")

    @classmethod
    def of(cls, dataset: xarray.Dataset, name: str) -> Estimate:
        """The scalar variable `name` of a dataset, with the variable `name`_error as its uncertainty."""
        return cls(dataset[name], dataset[f"{name}_error"])

    def __neg__(self) -> Estimate:
        return Estimate(-self.value, self.error)

    def __add__(self, other: Estimate | Scalar) -> Estimate:
        other = as_estimate(other)
        return Estimate(self.value + other.value, math.hypot(self.error, other.error))

    def __sub__(self, other: Estimate | Scalar) -> Estimate:
        return self + -as_estimate(other)

    def __mul__(self, other: Estimate | Scalar) -> Estimate:
        other = as_estimate(other)
        error = math.hypot(self.error * other.value, self.value * other.error)
        return Estimate(self.value * other.value, error)

    def __truediv__(self, other: Estimate | Scalar) -> Estimate:
        other = as_estimate(other)
        value = self.value / other.value
        return Estimate(value, math.hypot(self.error, value * other.error) / abs(other.value))


def as_estimate(number: Estimate | Scalar) -> Estimate:
    """An estimate as it is, another number as an exact one."""
    return number if isinstance(number, Estimate) else Estimate(number)
