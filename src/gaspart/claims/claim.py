"""The form of a claim: an estimate, what is expected of it, and the deviation between them."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from gaspart.analysis.estimate import Estimate, Scalar, as_estimate

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

KINDS = ("test", "identity", "reproduction")
"""test: could be false; identity: true by construction, checks the code; reproduction: a source's report."""


@dataclass(frozen=True, kw_only=True)
class Claim:
    """One measured number and what it should be, in the unit that the claim's text gives.

    claim: the statement in words; expected: with the uncertainty of the theory or the literature (a plain
    number is exact), and its source; required: the largest uncertainty of the measurement at which the claim
    means anything; fails_if: what would make it fail; kind: one of KINDS. bounds: the lowest and the highest
    allowed number, for a statement of bounds instead of a value (see `at_least`, `at_most`, `within`).
    exact_deviation: for numbers that are not Gaussian, their deviation as a Gaussian one (see `chi_square`).

    Raises ValueError for an unknown kind, an empty text, source or fails_if, a negative required uncertainty.
    """

    claim: str
    measured: Estimate
    expected: Estimate | Scalar
    required: Scalar
    source: str
    fails_if: str
    kind: str = "test"
    bounds: tuple[float, float] | None = None
    exact_deviation: float | None = None

    def __post_init__(self) -> None:
        if self.kind not in KINDS:
            raise ValueError(f"kind: {self.kind!r} (must be one of {', '.join(KINDS)})")
        for name in ("claim", "source", "fails_if"):
            if not getattr(self, name).strip():
                raise ValueError(
                    f"{name}: empty (a claim states what, its source, and what would make it fail)"
                )
        object.__setattr__(self, "expected", as_estimate(self.expected))
        object.__setattr__(self, "required", float(self.required))
        if self.required < 0.0:
            raise ValueError(f"required: {self.required} (must not be negative)")

    @classmethod
    def at_least(cls, *, claim: str, bound: Scalar, **others: Any) -> Claim:
        """The measured number is `bound` or more. others: the remaining fields of the claim."""
        text = f"{claim} (at least {bound:g})"
        return cls(claim=text, expected=bound, bounds=(bound, math.inf), **others)

    @classmethod
    def at_most(cls, *, claim: str, bound: Scalar, **others: Any) -> Claim:
        """The measured number is `bound` or less. others: the remaining fields of the claim."""
        text = f"{claim} (at most {bound:g})"
        return cls(claim=text, expected=bound, bounds=(-math.inf, bound), **others)

    @classmethod
    def within(cls, *, claim: str, expected: Scalar, half_width: Scalar, **others: Any) -> Claim:
        """The measured number lies within `half_width` of `expected`. others: the remaining fields.

        The required uncertainty defaults to half of half_width: the measurement's 95 % interval is then no
        wider than the band.
        """
        low, high = expected - half_width, expected + half_width
        text = f"{claim} (within {low:g} to {high:g})"
        return cls(
            claim=text, expected=expected, bounds=(low, high), **{"required": 0.5 * half_width} | others
        )

    @classmethod
    def chi_square(cls, *, chi_square: Scalar, degrees_of_freedom: int, **others: Any) -> Claim:
        """Chi-square of many deviations at once; measured is chi-square per degree of freedom, expected 1.

        The deviation is the Gaussian one of the same two-sided probability (a chi-square far too small is
        a fault as well: error bars too large); the uncertainty sqrt(2 / dof) is the statistic's own scatter.
        others: the remaining fields of the claim.
        """
        from scipy import stats

        above = stats.chi2.sf(chi_square, degrees_of_freedom)
        below = stats.chi2.cdf(chi_square, degrees_of_freedom)
        deviation = stats.norm.isf(above) if above < below else -stats.norm.isf(below)
        scatter = math.sqrt(2.0 / degrees_of_freedom)
        measured = Estimate(chi_square / degrees_of_freedom, scatter)
        return cls(
            measured=measured, expected=1.0, required=scatter, exact_deviation=float(deviation), **others
        )

    @classmethod
    def joint(cls, *, claim: str, deviations: ArrayLike, **others: Any) -> Claim:
        """`chi_square` of independent deviations in standard deviations, an array of any shape."""
        import numpy as np

        deviations = np.asarray(deviations, dtype=float)
        text = f"{claim} (chi-square per degree of freedom)"
        total, freedom = float(np.sum(deviations**2)), deviations.size
        return cls.chi_square(claim=text, chi_square=total, degrees_of_freedom=freedom, **others)

    @property
    def is_bound(self) -> bool:
        """Whether the claim states bounds rather than a value."""
        return self.bounds is not None

    @property
    def deviation_sigma(self) -> float:
        """Signed distance from what was stated, in standard deviations; 0 inside stated bounds.

        (measured - expected) / sqrt(sum of the squares of both uncertainties); for bounds, expected is the
        nearer bound.
        """
        if self.exact_deviation is not None:
            return self.exact_deviation
        stated = self.expected.value
        if self.bounds is not None:
            stated = min(max(self.measured.value, self.bounds[0]), self.bounds[1])
        difference = self.measured.value - stated
        spread = math.hypot(self.measured.error, self.expected.error)
        if spread == 0.0:
            return 0.0 if difference == 0.0 else math.copysign(math.inf, difference)
        return difference / spread

    @property
    def p_value(self) -> float:
        """Two-sided Gaussian probability of a deviation at least this large."""
        return math.erfc(abs(self.deviation_sigma) / math.sqrt(2.0))

    @property
    def is_conclusive(self) -> bool:
        """Whether all numbers are finite and the uncertainty is not above the required one."""
        numbers = (self.measured.value, self.measured.error, self.expected.value, self.expected.error)
        return all(map(math.isfinite, numbers)) and self.measured.error <= self.required

    @property
    def stated_source(self) -> str:
        """The source, with the expected value's own uncertainty where it has one."""
        if self.expected.error == 0.0:
            return self.source
        return f"{self.source} (± {self.expected.error:.2g})"
