"""What a referee finds: how far a run of gaspart, or one of its numbers, is from what it should be."""

from dataclasses import dataclass

from scipy.stats import norm

SIGMA = "standard errors"
PART = "relative difference"
LENGTH = "largest difference"


@dataclass(frozen=True)
class Finding:
    """gaspart's number and the referee's, as texts; their `distance` on a `scale`; the largest `allowed`."""

    ours: str
    theirs: str
    distance: float
    allowed: float
    scale: str

    @property
    def passes(self):
        return self.distance <= self.allowed


def of_chance(p, ours, tests=1):
    """From the smallest p-value of some tests (Bonferroni), as the Gaussian deviation of the same chance."""
    chance = min(1.0, tests * float(p))
    return Finding(ours, f"p = {chance:.2g}", float(norm.isf(0.5 * chance)), 3.0, SIGMA)
