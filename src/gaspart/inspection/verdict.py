"""The outcome of a check, in one line."""

from __future__ import annotations

from dataclasses import dataclass

from gaspart.analysis.estimate import Estimate
from gaspart.errors import visible

_LONGEST = 1000  # characters
LIMIT = 4.0
"""Standard errors from theory beyond which a check fails: by chance once in 16 000."""


@dataclass(frozen=True)
class Check:
    """The outcome of one check: whether it is passed (None: it could not be made), and why.

    acts: whether it has found that more than elastic contacts moves the particles.
    """

    name: str
    passed: bool | None
    text: str
    acts: bool = False

    def __str__(self) -> str:
        word = {True: "ok", False: "WRONG", None: "-"}[self.passed]
        return f"{word:6}{visible(self.name, _LONGEST)}: {visible(self.text, _LONGEST)}"


def compared(
    name: str, measured: Estimate, theory: Estimate, basis: str, deviation: float | None = None
) -> Check:
    """Passed within `LIMIT` standard errors, those of both sides in quadrature.

    basis: the source of theory, and how many samples there are; deviation: in standard errors, if it is not
    the one of a normal or Student's distribution.
    """
    sigma = abs((measured - theory).deviation if deviation is None else deviation)
    text = f"{measured.value:.5g} +- {measured.error:.2g}, theory {theory.value:.5g}"
    text += f" +- {theory.error:.2g}" if theory.error else ""
    return Check(name, sigma <= LIMIT, f"{text}: {sigma:.1f} standard errors ({basis})")
