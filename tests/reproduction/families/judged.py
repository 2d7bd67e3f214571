"""The verdicts of claims made from data with known answers."""

from gaspart.reproduction.claims import judge


def verdicts(claims, beginning=""):
    """The verdicts of those claims that begin so."""
    return {
        verdict
        for claim, verdict in zip(claims, judge(claims), strict=True)
        if claim.claim.startswith(beginning)
    }
