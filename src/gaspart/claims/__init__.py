"""Claims: a measured number beside what theory, the literature or a source states, and the verdict.

A claim agrees, disagrees, or is inconclusive (its uncertainty is above the one required, or it lies outside a
stated bound without being significantly so): inconclusive is not a pass. With hundreds of claims some exceed
3 sigma by chance, so the claims of one figure are a family, and a family as a whole is wrong about a true
statement with the probability of one 3-sigma test (Holm's correction at the level 0.0027, two-sided).
`experiments/<family>/claims.py` states what figures claim.
"""

from gaspart.claims.claim import KINDS, Claim, Estimate
from gaspart.claims.judging import FAMILY_LEVEL, VERDICTS, holm, judge
from gaspart.claims.table import COLUMNS, collect, read, summary, write

__all__ = [
    "COLUMNS",
    "FAMILY_LEVEL",
    "KINDS",
    "VERDICTS",
    "Claim",
    "Estimate",
    "collect",
    "holm",
    "judge",
    "read",
    "summary",
    "write",
]
