"""Verdicts of the claims of a figure, corrected for their number, and a joint test."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from gaspart.analysis.estimate import Estimate, Number, as_estimate

if TYPE_CHECKING:
    from numpy.typing import ArrayLike


# A claim: an estimate, its expected value, and the deviation between them.


CLAIM_KINDS = ("test", "identity", "reproduction", "family")
"""Kinds of claims.

A test could be false. An identity is true by construction, and checks the code. A reproduction repeats a
published result. A family states that the deviations of a figure's values scatter as their uncertainties
predict.
"""
POWER = 2.0
"""Resolution of a conclusive claim: expected and alternative value differ by at least this many standard
deviations."""
NEGLIGIBLE = 0.1
"""Largest allowance that counts as negligible, divided by the uncertainty of the measurement; it changes a
deviation by 0.5 %."""
UNVERIFIED = "the reference is quoted from memory and has not been verified"
"""Reason for a claim without a verdict; see `Claim.no_verdict`."""


@dataclass(frozen=True)
class Claim:
    """Measured number and its expected value; the claim's text gives their unit.

    claim : the statement in words.
    expected : expected value. A plain number is exact. The uncertainty of an Estimate is the allowance: the
        uncertainty of the theory or the literature. Its origin is `allowance_source`; it must not be derived
        from the data.
    source : source of the expected value.
    required : largest uncertainty of the measurement at which the claim is conclusive.
    fails_if : faults that would make the claim fail.
    kind : one of CLAIM_KINDS.
    bounds : lowest and highest allowed number, if the claim states bounds instead of a value (see `at_least`,
        `at_most`, `within`).
    exact_deviation : deviation of a number that is not Gaussian. It is the deviation of a Gaussian number
    with the same probability (see `chi_square`).
    alternative : value of a competing theory. A claim agrees only if it excludes this value.
    follows : True if the number is (nearly) determined by other claims. The joint test then leaves it out.
    no_verdict : reason why the number is reported without a verdict, such as UNVERIFIED.
    source_error : error of the source that explains why its result is not reproduced.

    Raises ValueError for an unknown kind, an empty text, `source` or `fails_if`, a negative required
    uncertainty, or an allowance without a source.
    """

    claim: str
    measured: Estimate
    expected: Estimate | Number
    required: Number
    source: str
    fails_if: str
    kind: str = "test"
    bounds: tuple[float, float] | None = None
    exact_deviation: float | None = None
    allowance_source: str = ""
    alternative: Number | None = None
    follows: bool = False
    no_verdict: str = ""
    source_error: str = ""

    def __post_init__(self) -> None:
        if self.kind not in CLAIM_KINDS:
            raise ValueError(f"kind: {self.kind!r} (must be one of {', '.join(CLAIM_KINDS)})")
        for name in ("claim", "source", "fails_if"):
            if not getattr(self, name).strip():
                raise ValueError(
                    f"{name}: empty (a claim states what, its source, and what would make it fail)"
                )
        object.__setattr__(self, "expected", as_estimate(self.expected))
        object.__setattr__(self, "required", float(self.required))
        if self.required < 0.0:
            raise ValueError(f"required: {self.required} (must not be negative)")
        if self.expected.error > 0.0 and not self.allowance_source.strip():
            raise ValueError(
                f"allowance_source: empty (the allowance {self.expected.error:g} needs a source)"
            )

    @classmethod
    def at_least(cls, claim: str, measured: Estimate, bound: Number, *rest: Any, **others: Any) -> Claim:
        """Return the claim that the measured number is at least `bound`; `rest` and `others` are further
        fields.
        """
        text = f"{claim} (at least {bound:g})"
        others["bounds"] = (bound, math.inf)
        return cls(text, measured, bound, *rest, **others)

    @classmethod
    def at_most(cls, claim: str, measured: Estimate, bound: Number, *rest: Any, **others: Any) -> Claim:
        """Return the claim that the measured number is at most `bound`; `rest` and `others` are further
        fields.
        """
        text = f"{claim} (at most {bound:g})"
        others["bounds"] = (-math.inf, bound)
        return cls(text, measured, bound, *rest, **others)

    @classmethod
    def within(
        cls, claim: str, measured: Estimate, expected: Number, half_width: Number,
        source: str, fails_if: str, **others: Any,
    ) -> Claim:  # fmt: skip
        """Return the claim that the measured number lies within `half_width` of `expected`. `others` are the
        remaining fields. If they do not contain the required uncertainty, it is `half_width` / 2. The 95 %
        interval of the measurement is then no wider than the interval of the claim.
        """
        low, high = expected - half_width, expected + half_width
        text = f"{claim} (within {low:g} to {high:g})"
        required = others.pop("required", 0.5 * half_width)
        return cls(text, measured, expected, required, source, fails_if, bounds=(low, high), **others)

    @classmethod
    def chi_square(
        cls, *, chi_square: Number, degrees_of_freedom: int, error_freedom: Number = math.inf, **others: Any
    ) -> Claim:
        """Return the claim that chi-square per degree of freedom is 1. The deviation of the claim is the
        deviation of a Gaussian number with equal two-sided probability. It is two-sided because a chi-square
        that is far too small is also an error: the error bars are too large. The uncertainty sqrt(2 / dof) is
        the scatter of the statistic itself. `error_freedom`: degrees of freedom of a common uncertainty of
        all deviations, if it was computed from a few samples. The statistic per degree of freedom then
        follows Fisher's distribution. `others`: the remaining fields of the claim.
        """
        from scipy.special import chdtr, chdtrc, fdtr, fdtrc, ndtri

        if math.isinf(error_freedom):
            above, below = (tail(degrees_of_freedom, chi_square) for tail in (chdtrc, chdtr))
        else:
            each = chi_square / degrees_of_freedom
            above, below = (tail(degrees_of_freedom, error_freedom, each) for tail in (fdtrc, fdtr))
        deviation = -ndtri(above) if above < below else ndtri(below)
        scatter = math.sqrt(2.0 / degrees_of_freedom)
        measured = Estimate(chi_square / degrees_of_freedom, scatter)
        return cls(
            measured=measured, expected=1.0, required=scatter, exact_deviation=float(deviation), **others
        )

    @classmethod
    def joint(cls, claim: str, deviations: ArrayLike, source: str, fails_if: str, **others: Any) -> Claim:
        """Return the `chi_square` claim on independent deviations, in standard deviations, of any shape."""
        import numpy as np

        deviations = np.asarray(deviations, dtype=float)
        text = f"{claim} (chi-square per degree of freedom)"
        total, freedom = float(np.sum(deviations**2)), deviations.size
        others |= {"source": source, "fails_if": fails_if}
        return cls.chi_square(claim=text, chi_square=total, degrees_of_freedom=freedom, **others)

    @property
    def form(self) -> str:
        """Form of the statement: "value", "bound" (one or two), or "distribution" (of many numbers)."""
        if self.exact_deviation is not None:
            return "distribution"
        return "value" if self.bounds is None else "bound"

    @property
    def deviation_sigma(self) -> float:
        """Signed distance from the expected value, in standard deviations; 0 within bounds. The distance is
        (measured - expected) / sqrt(u1^2 + u2^2), where u1 and u2 are the uncertainties of the two values.
        For bounds, the nearer bound is the expected value. See `Estimate.deviation` for uncertainties from a
        few samples.
        """
        if self.exact_deviation is not None:
            return self.exact_deviation
        stated = self.expected.value
        if self.bounds is not None:
            stated = min(max(self.measured.value, self.bounds[0]), self.bounds[1])
        return (self.measured - Estimate(stated, self.expected.error)).deviation

    @property
    def p_value(self) -> float:
        """Two-sided Gaussian probability of a deviation at least this large."""
        return math.erfc(abs(self.deviation_sigma) / math.sqrt(2.0))

    @property
    def is_finite(self) -> bool:
        """True if the measured and the expected number and their uncertainties are finite."""
        numbers = (self.measured.value, self.measured.error, self.expected.value, self.expected.error)
        return all(map(math.isfinite, numbers))

    @property
    def has_power(self) -> bool:
        """True if the combined uncertainty distinguishes the alternative, if one exists."""
        if self.alternative is None:
            return True
        spread = math.hypot(self.measured.error, self.expected.error)
        return abs(float(self.alternative) - self.expected.value) >= POWER * spread

    @property
    def is_conclusive(self) -> bool:
        """True if agreement would be significant: by the required uncertainty and against the alternative."""
        return self.is_finite and self.measured.error <= self.required and self.has_power

    @property
    def is_scattered(self) -> bool:
        """True if the deviation of a true claim is an independent standard Gaussian number. This holds for a
        test of a value with a verdict. Its allowance must be negligible relative to the uncertainty of the
        measurement.
        """
        return (
            not self.follows
            and self.form == "value"
            and self.kind == "test"
            and not self.no_verdict
            and self.is_finite
            and self.measured.error > 0.0
            and self.expected.error <= NEGLIGIBLE * self.measured.error
        )


VERDICTS = ("agrees", "disagrees", "inconclusive", "reproduced", "source in error", "no verdict")
"""Verdicts. The first three are for tests and identities. A reproduction is reproduced; or its source is in
error, if an error is known; or it disagrees for an unknown reason; or it is inconclusive. With "no verdict"
the number is only reported."""
FAMILY_LEVEL = math.erfc(3.0 / math.sqrt(2.0))
"""Probability that a family of true claims has at least one "disagrees". This is 0.0027, the probability that
a two-sided 3-sigma test rejects a true claim.
"""


def holm(p_values: Sequence[float], level: float = FAMILY_LEVEL) -> list[bool]:
    """Return True for each hypothesis of a family that Holm's step-down procedure rejects. The smallest of m
    probabilities is compared with level / m, the second smallest with level / (m-1), and so on. The procedure
    stops at the first probability above its threshold. The probability of any wrong rejection is at most
    `level`, even if the hypotheses depend on each other (Holm, Scand. J. Stat. 6, 65 (1979)).
    """
    rejected = [False] * len(p_values)
    order = sorted(range(len(p_values)), key=lambda index: p_values[index])
    for rank, index in enumerate(order):
        if p_values[index] > level / (len(p_values) - rank):
            break
        rejected[index] = True
    return rejected


def family_test(claims: Sequence[Claim]) -> list[Claim]:
    """Return a list with the joint test of a figure's claims, or an empty list. The list is empty if fewer
    than two claims count, or if no value scatters. A claim counts if it states a value that other claims do
    not determine. If an allowance is not negligible, the deviation is not a standard Gaussian number. Holm's
    correction detects a single deviation that is too large. This two-sided chi-square detects many deviations
    that are a little too large, and uncertainties that are too large.
    """
    tested = [claim for claim in claims if claim.form == "value" and claim.kind == "test"]
    if sum(claim.measured.error != 0.0 for claim in tested) < 2:
        return []
    deviations = [claim.deviation_sigma for claim in claims if claim.is_scattered]
    text = "deviations of all values without an allowance"
    common = {
        "kind": "family",
        "source": "standard deviations are what they state, and the expected values are true",
        "fails_if": "many small biases, or uncertainties that are too small or too large",
    }
    return [Claim.joint(claim=text, deviations=deviations, **common)] if deviations else []


def judge(claims: Sequence[Claim]) -> list[str]:
    """Return the verdicts of the claims of one figure, in the order of the claims. All tests and
    reproductions with finite numbers are one family. Holm's correction determines which of their deviations
    are significant. Identities do not depend on chance, and the joint test represents all claims; therefore
    these are tested separately at 3 sigma. A claim without a significant deviation is inconclusive in three
    cases: its uncertainty is larger than required, it does not exclude the alternative, or its number is
    outside of the bounds.
    """
    family = [
        claim
        for claim in claims
        if claim.is_finite and not claim.no_verdict and claim.kind in ("test", "reproduction")
    ]
    significant = {
        id(claim): rejected
        for claim, rejected in zip(family, holm([claim.p_value for claim in family]), strict=True)
    }
    return [_verdict(claim, significant.get(id(claim), claim.p_value <= FAMILY_LEVEL)) for claim in claims]


def _verdict(claim: Claim, is_significant: bool) -> str:
    """Return the verdict of one claim from the significance of its deviation."""
    if claim.no_verdict:
        return "no verdict"
    if not claim.is_finite:
        return "inconclusive"
    is_reproduction = claim.kind == "reproduction"
    if is_significant:
        return "source in error" if is_reproduction and claim.source_error else "disagrees"
    if not claim.is_conclusive or (claim.form == "bound" and claim.deviation_sigma != 0.0):
        return "inconclusive"
    return "reproduced" if is_reproduction else "agrees"


def reason(claim: Claim, verdict: str) -> str:
    """Return the reason for a verdict that is inconclusive or missing, or for a source's error. For an
    inconclusive claim the reason contains a factor: a measurement longer by this factor would make the claim
    conclusive.
    """
    if verdict == "no verdict":
        return claim.no_verdict
    if verdict == "source in error":
        return claim.source_error
    if verdict != "inconclusive":
        return ""
    if not claim.is_finite:
        return "not measured in this run"
    more = f"{sufficient(claim):.3g} times the measurement would decide it"
    if claim.measured.error > claim.required:
        return f"the uncertainty is above the required one: {more}"
    if not claim.has_power:
        if math.isinf(sufficient(claim)):
            return "the theory's own uncertainty hides the alternative: only a better theory would decide it"
        return f"the alternative is not excluded: {more}"
    outside = (3.0 / claim.deviation_sigma) ** 2
    return f"outside the bounds, but not significantly: {outside:.3g} times the measurement would decide it"


def sufficient(claim: Claim) -> float:
    """Compute the factor by which the measurement must be longer to be just conclusive. The uncertainty falls
    as the inverse root of the length. It is NaN without numbers, or without an uncertainty.
    """
    error = claim.measured.error
    if not claim.is_finite or not error > 0.0:
        return math.nan
    if not claim.required > 0.0:
        return math.inf
    multiple = (error / claim.required) ** 2
    if claim.alternative is not None:
        distance = abs(float(claim.alternative) - claim.expected.value) / POWER
        room = distance**2 - claim.expected.error**2
        multiple = max(multiple, error**2 / room if room > 0.0 else math.inf)
    return multiple
