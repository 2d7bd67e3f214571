"""Numbers with standard uncertainties."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:  # single numbers, as in claims, do not need numpy
    import numpy as np
    import xarray

Number = Any
"""A number, or an array of any array library. It is stored as a float or as an array of floats."""


@dataclass(frozen=True, eq=False)
class Estimate:
    """Number with its standard uncertainty (0 if exact), or an array of such numbers. `freedom` is the number
    of degrees of freedom of the uncertainty. If the uncertainty comes from the scatter of a few samples,
    `freedom` is the number of samples minus one. Otherwise it is infinite. With a finite `freedom`, a
    deviation follows Student's t distribution. Sums, products and quotients propagate the uncertainties to
    first order, as for independent numbers. They propagate the degrees of freedom by the formula of Welch and
    Satterthwaite (Biometrics Bulletin 2, 110 (1946)). Arrays are broadcast to a common shape. The result for
    each element is bitwise identical to the result for a single number. An estimate of an array has a length,
    and can be indexed and iterated over along its first axis. Its array must not be changed. Raises
    ValueError for a negative uncertainty, for degrees of freedom that are not positive, and for arrays whose
    shapes cannot be broadcast.
    """

    value: Number
    error: Number = 0.0
    freedom: Number = math.inf

    __array_ufunc__ = None  # in an operation of an array and an estimate, the estimate's method is used

    def __post_init__(self) -> None:
        parts = [_floats(part) for part in (self.value, self.error, self.freedom)]
        if not all(isinstance(part, float) for part in parts):
            parts = _arrays(parts)
        for name, part in zip(("value", "error", "freedom"), parts, strict=True):
            object.__setattr__(self, name, part)
        if _any(self.error < 0.0):
            raise ValueError(f"error: {self.error} (must not be negative)")
        if _any(self.freedom <= 0.0):
            raise ValueError(f"freedom: {self.freedom} (must be positive)")

    @classmethod
    def of(cls, dataset: xarray.Dataset, name: str) -> Estimate:
        """Return the variable `name` of a dataset, with `name`_error as its uncertainty. If the variable
        `name`_freedom exists and is positive, it gives the number of degrees of freedom.
        """
        column, error = dataset[name], dataset[f"{name}_error"]
        if f"{name}_freedom" not in dataset:
            return cls(column, error)
        freedom = dataset[f"{name}_freedom"]  # NaN if there is no uncertainty
        freedom = freedom.where(freedom > 0.0, math.inf).broadcast_like(column).transpose(*column.dims)
        return cls(column, error, freedom)

    @classmethod
    def stack(cls, estimates: Sequence[Estimate]) -> Estimate:
        """Join estimates of the same shape along a new first axis. An empty sequence gives an empty array."""
        parts = ([estimate._parts[k] for estimate in estimates] for k in range(3))
        return cls(*parts)

    @property
    def deviation(self) -> Number:
        """Value divided by its standard deviation; infinite for an exact number other than 0. If the
        uncertainty comes from a few samples, the deviation follows Student's t distribution. It is then
        converted to the Gaussian deviation that has the same probability.
        """
        return _each(_deviation, 1)(self.value, self.error, self.freedom)

    @property
    def weights(self) -> np.ndarray:
        """Weights 1 / error^2 of the elements of an array, divided by their sum."""
        weights: np.ndarray = self.error**-2
        return weights / weights.sum()

    def __str__(self) -> str:
        if isinstance(self.value, float):
            return concise(self.value, self.error)
        return f"[{', '.join(map(str, self))}]"

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Estimate):
            return NotImplemented
        if isinstance(self.value, float) and isinstance(other.value, float):
            return self._parts == other._parts
        import numpy as np

        return all(map(np.array_equal, self._parts, other._parts))

    def __hash__(self) -> int:
        return hash(self._parts)  # raises TypeError for arrays

    @property
    def _parts(self) -> tuple[Number, Number, Number]:
        return self.value, self.error, self.freedom

    def __bool__(self) -> bool:
        return isinstance(self.value, float) or len(self) > 0

    def __len__(self) -> int:
        return len(self.value)

    def __iter__(self) -> Iterator[Estimate]:
        return (Estimate(*parts) for parts in zip(*self._parts, strict=True))

    def __getitem__(self, key: Any) -> Estimate:
        return Estimate(self.value[key], self.error[key], self.freedom[key])

    def __neg__(self) -> Estimate:
        return Estimate(-self.value, self.error, self.freedom)

    def __add__(self, other: Estimate | Number) -> Estimate:
        other = as_estimate(other)
        return _sum(self.value + other.value, (self.error, self.freedom), (other.error, other.freedom))

    def __sub__(self, other: Estimate | Number) -> Estimate:
        return self + -as_estimate(other)

    def __mul__(self, other: Estimate | Number) -> Estimate:
        other = as_estimate(other)
        mine, its = self.error * abs(other.value), abs(self.value) * other.error
        return _sum(self.value * other.value, (mine, self.freedom), (its, other.freedom))

    def __truediv__(self, other: Estimate | Number) -> Estimate:
        other = as_estimate(other)
        value = self.value / other.value
        mine, its = self.error / abs(other.value), abs(value) * other.error / abs(other.value)
        return _sum(value, (mine, self.freedom), (its, other.freedom))

    __radd__, __rmul__ = __add__, __mul__

    def __rsub__(self, other: Number) -> Estimate:
        return as_estimate(other) - self

    def __rtruediv__(self, other: Number) -> Estimate:
        return as_estimate(other) / self


def concise(value: float, error: float) -> str:
    """Format a number with its uncertainty in the last two digits, such as 1.242(20). If the number has no
    uncertainty, it is written with six digits.
    """
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


def as_estimate(number: Estimate | Number) -> Estimate:
    """Return an estimate unchanged; convert other numbers and arrays to exact estimates."""
    return number if isinstance(number, Estimate) else Estimate(number)


def _floats(number: Number) -> float | np.ndarray:
    """Convert a number to a float, an array to an array of floats."""
    if isinstance(number, (float, int)):
        return float(number)
    import numpy as np

    array = np.asarray(number, dtype=float)
    return array if array.ndim else float(array)


def _arrays(parts: list) -> list[np.ndarray]:
    """Return read-only copies of arrays, broadcast to one shape."""
    import numpy as np

    copies = [np.array(part) for part in np.broadcast_arrays(*parts)]
    for copy in copies:
        copy.flags.writeable = False
    return copies


def _any(wrong: bool | np.ndarray) -> bool:
    return bool(wrong if isinstance(wrong, bool) else wrong.any())


def _sum(value: Number, *parts: tuple[Number, Number]) -> Estimate:
    """Return a value whose uncertainty combines two contributions (error, degrees of freedom)."""
    return Estimate(value, *_each(_together, 2)(*parts[0], *parts[1]))


def _each(function: Callable[..., Any], results: int) -> Callable[..., Any]:
    """Extend a function of floats to arrays; single floats stay, because math and numpy differ in
    last bits.
    """

    def of_any(*numbers: Number) -> Any:
        if all(isinstance(number, float) for number in numbers):
            return function(*numbers)
        import numpy as np

        with np.errstate(invalid="ignore"):  # comparison with NaN gives NaN without a warning
            return np.vectorize(function, otypes=[float] * results)(*numbers)

    return of_any


def _together(error: float, freedom: float, other: float, other_freedom: float) -> tuple[float, float]:
    """Compute the error of a sum of two numbers, and its degrees of freedom."""
    both = math.hypot(error, other)
    if both == 0.0 or not math.isfinite(both):
        return both, math.inf
    inverse = (error / both) ** 4 / freedom + (other / both) ** 4 / other_freedom
    return both, 1.0 / inverse if inverse > 0.0 else math.inf


def _deviation(value: float, error: float, freedom: float) -> float:
    """Compute the deviation of `Estimate.deviation` for one number."""
    if error == 0.0:
        return math.copysign(math.inf, value) if value else 0.0
    t = value / error
    if math.isinf(freedom) or t == 0.0 or not math.isfinite(t):
        return t
    from scipy.special import ndtri, stdtr

    beyond = max(float(stdtr(freedom, -abs(t))), 1e-300)
    return math.copysign(-float(ndtri(beyond)), t)
