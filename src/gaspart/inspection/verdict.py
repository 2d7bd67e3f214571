"""Result of a check, in one line."""

from __future__ import annotations

from dataclasses import dataclass

from gaspart.analysis.estimate import Estimate
from gaspart.errors import visible

_LONGEST = 1000  # number of characters
LIMIT = 4.0
"""Difference from theory, in standard errors, above which a check fails. By chance, one of 16 000 checks
exceeds it.
"""


@dataclass(frozen=True)
class Check:
    """Result of one check, None if it could not be made, and the reason; `acts`: by other forces."""

    name: str
    passed: bool | None
    text: str
    acts: bool = False

    def __str__(self) -> str:
        verdict = {True: "ok", False: "WRONG", None: "-"}[self.passed]
        return f"{verdict:6}{visible(self.name, _LONGEST)}: {visible(self.text, _LONGEST)}"


def compare_with_theory(
    name: str, measured: Estimate, theory: Estimate, basis: str, deviation: float | None = None
) -> Check:
    """Compare a measurement with theory; the check passes within `LIMIT` combined standard errors. `basis`:
    source of the theory, and the number of samples. `deviation`: deviation in standard errors, if its
    distribution is neither normal nor Student's t.
    """
    sigma = abs((measured - theory).deviation if deviation is None else deviation)
    text = f"{measured.value:.5g} +- {measured.error:.2g}, theory {theory.value:.5g}"
    text += f" +- {theory.error:.2g}" if theory.error else ""
    return Check(name, sigma <= LIMIT, f"{text}: {sigma:.1f} standard errors ({basis})")
