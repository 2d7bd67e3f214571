"""Verdicts of the claims of one figure, with a correction for their number."""

from __future__ import annotations

import math
from collections.abc import Sequence

from gaspart.claims.claim import Claim

VERDICTS = ("agrees", "disagrees", "inconclusive")
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


def judge(claims: Sequence[Claim]) -> list[str]:
    """Verdicts of one figure's claims, in their order.

    inconclusive: a number is not finite, or the uncertainty is above the required one, or the number is
    outside the stated bounds but not significantly. Tests and reproductions that are left form the family of
    Holm's correction; identities do not depend on chance and are judged by 3 sigma each.
    """
    family = [claim for claim in claims if claim.is_conclusive and claim.kind != "identity"]
    significant = {
        id(claim): rejected
        for claim, rejected in zip(family, holm([claim.p_value for claim in family]), strict=True)
    }
    verdicts = []
    for claim in claims:
        if not claim.is_conclusive:
            verdicts.append("inconclusive")
        elif significant.get(id(claim), claim.p_value <= FAMILY_LEVEL):
            verdicts.append("disagrees")
        elif claim.is_bound and claim.deviation_sigma != 0.0:
            verdicts.append("inconclusive")
        else:
            verdicts.append("agrees")
    return verdicts
