"""Claims: a measured number beside what theory, the literature or a source says, and the verdict.

A claim agrees, disagrees, or is inconclusive (its uncertainty is above the one required, or it lies outside a
stated bound without being significantly so): inconclusive is not a pass. With hundreds of claims some exceed
3 sigma by chance, so the claims of one figure are a family, and a family as a whole is wrong about a true
statement with the probability of one 3-sigma test (Holm's correction at the level 0.0027, two-sided). This
module holds the form of a claim and the judging; `experiments/<family>/claims.py` states what figures claim.
"""

from __future__ import annotations

import csv
import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from gaspart.files import whole_file

if TYPE_CHECKING:
    import pandas

Scalar = Any
"""A number of any library, an array without dimensions too; a `Claim` keeps it as a float."""
KINDS = ("test", "identity", "reproduction")
"""test: could be false; identity: true by construction, checks the code; reproduction: a source's report."""
VERDICTS = ("agrees", "disagrees", "inconclusive")
COLUMNS = (
    "figure",
    "claim",
    "kind",
    "measured",
    "uncertainty",
    "required_uncertainty",
    "expected",
    "source",
    "deviation_sigma",
    "verdict",
    "fails_if",
)
"""Columns of a claims table, in this order. `source` states the expected value's uncertainty, if any."""
FAMILY_LEVEL = math.erfc(3.0 / math.sqrt(2.0))
"""Chance that a family of true statements has any "disagrees": that of one two-sided 3-sigma test, 0.0027."""

_NUMBERS = ("measured", "uncertainty", "required_uncertainty", "expected", "deviation_sigma")


@dataclass(frozen=True)
class Claim:
    """One measured number and what it should be.

    claim: the statement in words; kind: one of KINDS; measured and its standard uncertainty;
    required_uncertainty: the largest uncertainty at which the claim means anything; expected, with
    expected_uncertainty (standard, of the theory or literature value), and its source; fails_if: what would
    make it fail. All numbers in the unit the claim's text gives. low, high: a statement of bounds instead of
    a value (see `at_least`, `at_most`, `within`). exact_deviation: for numbers that are not Gaussian, their
    deviation as a Gaussian one (see `chi_square`).

    Raises ValueError for an unknown kind, an empty text, source or fails_if, a negative uncertainty.
    """

    claim: str
    kind: str
    measured: Scalar
    uncertainty: Scalar
    required_uncertainty: Scalar
    expected: Scalar
    source: str
    expected_uncertainty: Scalar = 0.0
    fails_if: str = ""
    low: float | None = None
    high: float | None = None
    exact_deviation: float | None = None

    def __post_init__(self) -> None:
        if self.kind not in KINDS:
            raise ValueError(f"kind: {self.kind!r} (must be one of {', '.join(KINDS)})")
        for name in ("claim", "source", "fails_if"):
            if not getattr(self, name).strip():
                raise ValueError(f"{name}: empty (a claim states what, by whom, and what would make it fail)")
        for name in ("measured", "expected", "uncertainty", "required_uncertainty", "expected_uncertainty"):
            object.__setattr__(self, name, float(getattr(self, name)))
        for name in ("uncertainty", "required_uncertainty", "expected_uncertainty"):
            if getattr(self, name) < 0.0:
                raise ValueError(f"{name}: {getattr(self, name)} (must not be negative)")

    @classmethod
    def at_least(
        cls,
        claim: str,
        kind: str,
        measured: Scalar,
        uncertainty: Scalar,
        required_uncertainty: Scalar,
        bound: Scalar,
        source: str,
        fails_if: str,
    ) -> Claim:
        """The measured number is `bound` or more."""
        return cls(
            f"{claim} (at least {bound:g})",
            kind,
            measured,
            uncertainty,
            required_uncertainty,
            bound,
            source,
            fails_if=fails_if,
            low=bound,
            high=math.inf,
        )

    @classmethod
    def at_most(
        cls,
        claim: str,
        kind: str,
        measured: Scalar,
        uncertainty: Scalar,
        required_uncertainty: Scalar,
        bound: Scalar,
        source: str,
        fails_if: str,
    ) -> Claim:
        """The measured number is `bound` or less."""
        return cls(
            f"{claim} (at most {bound:g})",
            kind,
            measured,
            uncertainty,
            required_uncertainty,
            bound,
            source,
            fails_if=fails_if,
            low=-math.inf,
            high=bound,
        )

    @classmethod
    def within(
        cls,
        claim: str,
        kind: str,
        measured: Scalar,
        uncertainty: Scalar,
        expected: Scalar,
        half_width: Scalar,
        source: str,
        fails_if: str,
        required_uncertainty: Scalar = None,
    ) -> Claim:
        """The measured number lies within `half_width` of `expected`.

        required_uncertainty defaults to half of half_width: the measurement's 95 % interval is then no wider
        than the band.
        """
        return cls(
            f"{claim} (within {expected - half_width:g} to {expected + half_width:g})",
            kind,
            measured,
            uncertainty,
            0.5 * half_width if required_uncertainty is None else required_uncertainty,
            expected,
            source,
            fails_if=fails_if,
            low=expected - half_width,
            high=expected + half_width,
        )

    @classmethod
    def chi_square(
        cls, claim: str, kind: str, chi_square: Scalar, degrees_of_freedom: int, source: str, fails_if: str
    ) -> Claim:
        """Chi-square of many deviations at once; measured is chi-square per degree of freedom, expected 1.

        The deviation is the Gaussian one of the same two-sided probability (a chi-square far too small is
        a fault as well: error bars too large); the uncertainty sqrt(2 / dof) is the statistic's own scatter.
        """
        from scipy import stats

        above = stats.chi2.sf(chi_square, degrees_of_freedom)
        below = stats.chi2.cdf(chi_square, degrees_of_freedom)
        deviation = stats.norm.isf(above) if above < below else -stats.norm.isf(below)
        scatter = math.sqrt(2.0 / degrees_of_freedom)
        return cls(
            claim,
            kind,
            chi_square / degrees_of_freedom,
            scatter,
            scatter,
            1.0,
            source,
            fails_if=fails_if,
            exact_deviation=float(deviation),
        )

    @property
    def is_bound(self) -> bool:
        """Whether the claim states bounds rather than a value."""
        return self.low is not None

    @property
    def deviation_sigma(self) -> float:
        """Signed distance from what was stated, in standard deviations; 0 inside stated bounds.

        (measured - expected) / sqrt(uncertainty^2 + expected_uncertainty^2), for bounds with the nearer bound
        as expected.
        """
        if self.exact_deviation is not None:
            return self.exact_deviation
        if self.low is not None and self.high is not None:
            difference = self.measured - min(max(self.measured, self.low), self.high)
        else:
            difference = self.measured - self.expected
        spread = math.hypot(self.uncertainty, self.expected_uncertainty)
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
        numbers = (self.measured, self.uncertainty, self.expected, self.expected_uncertainty)
        return all(map(math.isfinite, numbers)) and self.uncertainty <= self.required_uncertainty

    @property
    def stated_source(self) -> str:
        """The source, with the expected value's own uncertainty where it has one."""
        if self.expected_uncertainty == 0.0:
            return self.source
        return f"{self.source} (± {self.expected_uncertainty:.2g})"


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


def write(path: str | Path, figure: str, claims: Sequence[Claim]) -> None:
    """Judge the claims of `figure` and write them as CSV with COLUMNS, whole or not at all.

    Raises ValueError if two claims have the same text: a row could not be told from the other.
    """
    texts = [claim.claim for claim in claims]
    for text in texts:
        if texts.count(text) > 1:
            raise ValueError(f"{figure}: the claim {text!r} stands twice")
    Path(path).parent.mkdir(parents=True, exist_ok=True)
    with whole_file(path) as partial, partial.open("w", newline="", encoding="utf-8") as file:
        table = csv.writer(file, lineterminator="\n")
        table.writerow(COLUMNS)
        for claim, verdict in zip(claims, judge(claims), strict=True):
            table.writerow(
                [
                    figure,
                    claim.claim,
                    claim.kind,
                    f"{claim.measured:.10g}",
                    f"{claim.uncertainty:.4g}",
                    f"{claim.required_uncertainty:.4g}",
                    f"{claim.expected:.10g}",
                    claim.stated_source,
                    f"{claim.deviation_sigma:.3f}",
                    verdict,
                    claim.fails_if,
                ]
            )


def read(path: str | Path) -> list[dict[str, Any]]:
    """Rows of a claims table as dictionaries by column; the numbers as floats.

    Raises ValueError, naming the file, if its columns are not COLUMNS or a number or verdict is not one.
    """
    with Path(path).open(newline="", encoding="utf-8") as file:
        table = csv.DictReader(file)
        if tuple(table.fieldnames or ()) != COLUMNS:
            raise ValueError(f"{path}: not a claims table (its columns must be {', '.join(COLUMNS)})")
        rows = list(table)
    for row in rows:
        try:
            row.update({name: float(row[name]) for name in _NUMBERS})
        except (TypeError, ValueError) as error:
            raise ValueError(f"{path}: {error} in the row {row['claim']!r}") from None
        if row["verdict"] not in VERDICTS:
            raise ValueError(f"{path}: verdict: {row['verdict']!r} (must be one of {', '.join(VERDICTS)})")
    return rows


def collect(paths: Iterable[str | Path]) -> pandas.DataFrame:
    """All claims of several tables as one pandas DataFrame with COLUMNS, in the order of `paths`."""
    import pandas

    return pandas.DataFrame([row for path in paths for row in read(path)], columns=list(COLUMNS))


def summary(table: pandas.DataFrame) -> str:
    """One line that counts the verdicts of a `collect`ed table: "212 claims: 205 agree, 3 disagree, ..."."""
    counts = {verdict: int((table["verdict"] == verdict).sum()) for verdict in VERDICTS}
    return (
        f"{len(table)} claims: {counts['agrees']} agree, {counts['disagrees']} disagree, "
        f"{counts['inconclusive']} inconclusive"
    )
