"""Verdicts of the claims of one figure, corrected for their number, and a joint test."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from gaspart.analysis.estimate import Estimate, Number, as_estimate

if TYPE_CHECKING:
    from numpy.typing import ArrayLike


# The form of a claim: an estimate, what is expected of it, and the deviation between them.


CLAIM_KINDS = ("test", "identity", "reproduction", "family")
"""Kinds of claims: a test could be false, an identity is true by construction and checks the code.

A reproduction repeats a source's report, a family states that the deviations of a figure's value claims
scatter as their uncertainties state.
"""
POWER = 2.0
"""Standard deviations between the expected value and the alternative that a conclusive claim must resolve."""
NEGLIGIBLE = 0.1
"""Part of the measurement's uncertainty below which an allowance does not change a deviation (0.5 %)."""
UNVERIFIED = "the reference is quoted from memory and has not been verified"
"""Why a claim has no verdict: see `Claim.no_verdict`."""


@dataclass(frozen=True, kw_only=True)
class Claim:
    """Measured number and its expected value, in the unit that the claim's text gives.

    claim : the statement in words.
    expected : a plain number is exact; the uncertainty of an Estimate is the allowance for the uncertainty of
        the theory or the literature, whose origin is `allowance_source`, and which must not be derived from
        the data.
    source : source of the expected value.
    required : largest uncertainty of the measurement at which the claim means anything.
    fails_if : faults that would make it fail.
    kind : one of CLAIM_KINDS.
    bounds : lowest and highest allowed number, for a statement of bounds instead of a value (see `at_least`,
        `at_most`, `within`).
    exact_deviation : for numbers that are not Gaussian, their deviation as a Gaussian one (see `chi_square`).
    alternative : value of a competing theory, which a claim that agrees must exclude.
    follows : True if the number follows, or nearly, from other claims, so that the joint test does not count
        it again.
    no_verdict : reason why the number is reported only, such as UNVERIFIED.
    source_error : for a reproduction, reason why the source errs if it is not reproduced.

    Raises ValueError for an unknown kind, an empty text, source or fails_if, a negative required uncertainty,
    and an allowance without a source.
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
    def at_least(cls, *, claim: str, bound: Number, **others: Any) -> Claim:
        """Return the claim that the measured number is `bound` or more.

        `others` are the remaining fields of the claim.
        """
        text = f"{claim} (at least {bound:g})"
        return cls(claim=text, expected=bound, bounds=(bound, math.inf), **others)

    @classmethod
    def at_most(cls, *, claim: str, bound: Number, **others: Any) -> Claim:
        """Return the claim that the measured number is `bound` or less.

        `others` are the remaining fields of the claim.
        """
        text = f"{claim} (at most {bound:g})"
        return cls(claim=text, expected=bound, bounds=(-math.inf, bound), **others)

    @classmethod
    def within(cls, *, claim: str, expected: Number, half_width: Number, **others: Any) -> Claim:
        """Return the claim that the measured number lies within `half_width` of `expected`.

        `others` are the remaining fields. The required uncertainty defaults to half of half_width: the
        measurement's 95 % interval is then no wider than the band.
        """
        low, high = expected - half_width, expected + half_width
        text = f"{claim} (within {low:g} to {high:g})"
        return cls(
            claim=text, expected=expected, bounds=(low, high), **{"required": 0.5 * half_width} | others
        )

    @classmethod
    def chi_square(
        cls, *, chi_square: Number, degrees_of_freedom: int, error_freedom: Number = math.inf, **others: Any
    ) -> Claim:
        """Return a claim on chi-square per degree of freedom of many deviations, expected to be 1.

        The deviation is the Gaussian deviation with the same two-sided probability, because a chi-square that
        is far too small is also an error (too large error bars). The uncertainty sqrt(2 / dof) is the scatter
        of the statistic itself.

        error_freedom : degrees of freedom of the uncertainty if all deviations have one in common, from the
            scatter of a few samples; the statistic per degree of freedom then follows Fisher's distribution.
        others : the remaining fields of the claim.
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
    def joint(cls, *, claim: str, deviations: ArrayLike, **others: Any) -> Claim:
        """Return the `chi_square` of independent deviations, in standard deviations, of any shape."""
        import numpy as np

        deviations = np.asarray(deviations, dtype=float)
        text = f"{claim} (chi-square per degree of freedom)"
        total, freedom = float(np.sum(deviations**2)), deviations.size
        return cls.chi_square(claim=text, chi_square=total, degrees_of_freedom=freedom, **others)

    @property
    def form(self) -> str:
        """The kind of statement: "value", "bound" (or two), or "distribution", of many numbers at once."""
        if self.exact_deviation is not None:
            return "distribution"
        return "value" if self.bounds is None else "bound"

    @property
    def deviation_sigma(self) -> float:
        """Signed distance from the claimed value, in standard deviations; 0 inside of bounds.

        (measured - expected) / sqrt(sum of the squares of both uncertainties); for bounds, the nearer bound
        is used as the expected value. See `Estimate.deviation` for uncertainties that come from a few
        samples.
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
        """True if agreement would mean something.

        The uncertainty is not above the required one, and the alternative would be noticed.
        """
        return self.is_finite and self.measured.error <= self.required and self.has_power

    @property
    def is_scattered(self) -> bool:
        """True if the deviation of a true claim is an independent standard Gaussian one.

        This is so for a test of a value, with a verdict, whose allowance is negligible relative to the
        uncertainty of the measurement.
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
"""Tests and identities have one of the first three; a reproduction is reproduced, its source is in error (if
there is a reason why), it disagrees for no known reason, or is inconclusive; no verdict: the number is
reported only."""
FAMILY_LEVEL = math.erfc(3.0 / math.sqrt(2.0))
"""Chance that a family of true statements has any "disagrees", as in one two-sided 3-sigma test, 0.0027."""


def holm(p_values: Sequence[float], level: float = FAMILY_LEVEL) -> list[bool]:
    """Return the rejected hypotheses of a family, as a list of bool, by Holm's step-down procedure.

    The smallest of m probabilities is compared with level / m, the next with level / (m-1) ... until one is
    above. The probability of any wrong rejection is at most `level`, for any dependences (Holm, Scand. J.
    Stat. 6, 65 (1979)).
    """
    rejected = [False] * len(p_values)
    order = sorted(range(len(p_values)), key=lambda index: p_values[index])
    for rank, index in enumerate(order):
        if p_values[index] > level / (len(p_values) - rank):
            break
        rejected[index] = True
    return rejected


def family_test(claims: Sequence[Claim]) -> list[Claim]:
    """Return the joint test of a figure's claims, [one claim], or [].

    The result is [] if fewer than two claims have a value that is not counted exactly, or if no such value
    scatters. With an allowance that is not negligible, a deviation is not a standard Gaussian number. Holm's
    correction detects one deviation that is too large. This two-sided chi-square detects many deviations that
    are a little too large, and uncertainties that are too large.
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
    """Return verdicts of one figure's claims, in their order.

    Holm's correction determines which deviations are significant, for the family of all tests and
    reproductions with finite numbers. Identities do not depend on chance, and the joint test represents all
    claims, so each of these is tested at 3 sigma. A claim that does not deviate significantly is inconclusive
    if its uncertainty is larger than required, if it does not exclude the alternative, or if it is outside of
    its bounds.
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
    """Return the verdict of one claim, whose deviation is significant or not."""
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
    """Return the reason of a verdict that is inconclusive or missing, or of a source's error.

    For an inconclusive claim it contains the multiple of the measurement that would make it conclusive. The
    reason is empty for other verdicts.
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
    """Compute the multiple of the measurement that would just make a claim conclusive.

    The uncertainty falls as the inverse root of the length. The multiple is below 1 where less would do,
    infinite where no length would. NaN without numbers, and for a measurement without uncertainty.
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
