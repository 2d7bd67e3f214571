"""Verdicts of the claims of one figure, with a correction for their number, and their joint test."""

from __future__ import annotations

import math
from collections.abc import Sequence

from gaspart.reproduction.claims.claim import POWER, Claim

VERDICTS = ("agrees", "disagrees", "inconclusive", "reproduced", "source in error", "no verdict")
"""Tests and identities have one of the first three; a reproduction is reproduced, its source is in error (if
there is a reason why), it disagrees for no known reason, or is inconclusive; no verdict: the number is
reported only."""
FAMILY_LEVEL = math.erfc(3.0 / math.sqrt(2.0))
"""Chance that a family of true statements has any "disagrees": that of one two-sided 3-sigma test, 0.0027."""


def holm(p_values: Sequence[float], level: float = FAMILY_LEVEL) -> list[bool]:
    """Which of a family's hypotheses are rejected (list of bool), by Holm's step-down procedure.

    The smallest of m probabilities is compared with level / m, the next with level / (m-1) ... until one is
    above. The chance of any wrong rejection is at most `level`, whatever the dependences (Holm, Scand. J.
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
    """The joint test of a figure's claims: [one claim], or [] if fewer than two of them state a value that
    is not counted exactly, or none of these scatters: beside an allowance that is not negligible, a deviation
    is no standard Gaussian number.

    Holm's correction notices one deviation that is too large; this chi-square, two-sided, notices many that
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
    """Verdicts of one figure's claims, in their order.

    A deviation is significant by Holm's correction for the family of all tests and reproductions with finite
    numbers; identities do not depend on chance, and the joint test stands for all: they are judged by 3 sigma
    each. What does not deviate significantly is inconclusive if its uncertainty is above the required one, if
    it does not exclude the alternative, or if it lies outside stated bounds.
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
    """The verdict of one claim, whose deviation is significant or not."""
    if claim.no_verdict:
        return "no verdict"
    if not claim.is_finite:
        return "inconclusive"
    is_reproduction = claim.kind == "reproduction"
    if is_significant:
        return "source in error" if is_reproduction and claim.why else "disagrees"
    if not claim.is_conclusive or (claim.form == "bound" and claim.deviation_sigma != 0.0):
        return "inconclusive"
    return "reproduced" if is_reproduction else "agrees"


def reason(claim: Claim, verdict: str) -> str:
    """Why a verdict is none, or inconclusive, with the multiple of the measurement that would decide it; or
    why the source is in error. Empty for others."""
    if verdict == "no verdict":
        return claim.no_verdict
    if verdict == "source in error":
        return claim.why
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
    """The multiple of the measurement that would just make a claim conclusive, since its uncertainty falls as
    the inverse root of the length: below 1 where less would do, infinite where none would. NaN without
    numbers, and for a measurement without uncertainty."""
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
