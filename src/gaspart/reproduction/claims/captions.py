"""Measured numbers in captions: filled in from the claims, and copies of them found.

A caption names a measured number by the beginning of its claim, in double braces:

    the sphere's energy is {{equipartition M<V^2>/3kT, mass 1 times}} of that in equilibrium
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterable
from typing import Any

_PLACE = re.compile(r"\{\{\s*(.*?)\s*\}\}", re.DOTALL)
_NUMBER = re.compile(r"(?<![\w.^/-])\d+\.\d+(?![\w.])")
NOT_MEASURED = "(not measured in this run)"


def filled(caption: str, rows: Iterable[dict[str, Any]], absent: str = NOT_MEASURED) -> str:
    """The caption with the measured value of a claim in each place, as 0.930(16), from rows of its figure's
    claims table, or `absent` where there is no such claim.

    Raises ValueError if a place names several claims.
    """
    known = list(rows)

    def value(place: re.Match) -> str:
        beginning = " ".join(place[1].split())
        matching = [row for row in known if row["claim"].startswith(beginning)]
        if len(matching) > 1:
            raise ValueError(f"{{{{{beginning}}}}}: {len(matching)} claims begin so")
        if not matching or not math.isfinite(_number(matching[0], "measured")):
            return absent
        return concise(_number(matching[0], "measured"), _number(matching[0], "uncertainty"))

    return _PLACE.sub(value, caption)


def place_fault(caption: str) -> str:
    """The fault of the places of a caption; "" if there is none."""
    if any(not place.strip() for place in _PLACE.findall(caption)):
        return "{{ }} must hold the beginning of a claim"
    if "{{" in _PLACE.sub("", caption):
        return "{{ is not closed by }}"
    return ""


def _number(row: dict[str, Any], name: str) -> float:
    """A column of a table as a number; pandas leaves nothing where there is none."""
    return math.nan if row[name] == "" else float(row[name])


def concise(value: float, error: float) -> str:
    """A number with its uncertainty in units of the last digit, two digits of it if they are below 20."""
    if not (error > 0.0 and math.isfinite(error)):
        return f"{value:.5g}"
    digits = 1 - math.floor(math.log10(error))
    if error * 10.0**digits >= 19.5:
        digits -= 1
    if digits <= 0:
        return f"{round(value, digits):.0f}({round(error, digits):.0f})"
    return f"{value:.{digits}f}({error * 10.0**digits:.0f})"


def literal_copies(caption: str, rows: Iterable[dict[str, Any]]) -> list[str]:
    """Numbers that a caption states itself although they are measured, "1.34: claim".

    A number with a decimal point that is the measured value of a claim, but not its expected one, both
    rounded to as many digits. By chance a few are found that have another origin.
    """
    copies = []
    for text in _NUMBER.findall(_PLACE.sub("", caption)):
        places = len(text.split(".")[1])
        for row in rows:
            measured, expected = (round(_number(row, name), places) for name in ("measured", "expected"))
            if float(text) == measured != expected:
                copies.append(f"{text}: {row['claim']}")
    return copies
