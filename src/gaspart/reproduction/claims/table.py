"""Tables of judged claims as CSV files, a file per figure: written, read, joined and counted."""

from __future__ import annotations

import csv
import math
import re
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from gaspart.errors import visible
from gaspart.files import whole_file
from gaspart.reproduction.claims.judging import (
    CLAIM_KINDS,
    VERDICTS,
    Claim,
    family_test,
    judge,
    reason,
)

if TYPE_CHECKING:
    import pandas


_STATED = (
    "measured",
    "uncertainty",
    "degrees_of_freedom",
    "required_uncertainty",
    "expected",
    "allowance",
    "lowest",
    "highest",
)
_JUDGED = ("deviation_sigma", "scattered")
COLUMNS = (
    *("figure", "claim", "kind", "form"),
    *_STATED,
    *("source", "allowance_source"),
    *_JUDGED,
    "verdict",
    "why",
    "fails_if",
)
"""Columns of a claims table, in this order.

allowance : uncertainty of the expected value.
lowest, highest : stated bounds, NaN for a value.
scattered : 1 if `deviation_sigma` of a true claim is a standard Gaussian number (`Claim.is_scattered`), else
    0.
"""
PLURALS = {"test": "tests", "identity": "identities", "reproduction": "reproductions", "family": "families"}
COUNTED = {"agrees": "agree", "disagrees": "disagree"}


def write(path: str | Path, figure: str, claims: Sequence[Claim]) -> None:
    """Judge the claims of `figure`, and write them atomically as CSV with `COLUMNS`. The joint test of the
    claims is written too. Raises ValueError if two claims have the same text: their rows could not be
    distinguished.
    """
    claims = [*claims, *family_test(claims)]
    texts = [claim.claim for claim in claims]
    for text in texts:
        if texts.count(text) > 1:
            raise ValueError(f"{figure}: the claim {text!r} occurs twice")
    Path(path).parent.mkdir(parents=True, exist_ok=True)
    with whole_file(path) as partial, partial.open("w", newline="", encoding="utf-8") as file:
        table = csv.DictWriter(file, COLUMNS, lineterminator="\n")
        table.writeheader()
        for claim, verdict in zip(claims, judge(claims), strict=True):
            table.writerow({"figure": figure, **_row(claim, verdict)})


def _row(claim: Claim, verdict: str) -> dict[str, str]:
    """Return a judged claim as a row: a value for each column."""
    lowest, highest = claim.bounds or (math.nan, math.nan)
    return {
        "claim": claim.claim,
        "kind": claim.kind,
        "form": claim.form,
        "measured": f"{claim.measured.value:.10g}",
        "uncertainty": f"{claim.measured.error:.4g}",
        "degrees_of_freedom": f"{claim.measured.freedom:.4g}",
        "required_uncertainty": f"{claim.required:.4g}",
        "expected": f"{claim.expected.value:.10g}",
        "allowance": f"{claim.expected.error:.4g}",
        "lowest": f"{lowest:.10g}",
        "highest": f"{highest:.10g}",
        "source": claim.source,
        "allowance_source": claim.allowance_source,
        "deviation_sigma": f"{claim.deviation_sigma:.3f}",
        "scattered": f"{claim.is_scattered:d}",
        "verdict": verdict,
        "why": reason(claim, verdict),
        "fails_if": claim.fails_if,
    }


def read(path: str | Path) -> list[dict[str, Any]]:
    """Read the rows of a claims table as dictionaries by column, with numbers as floats. Empty entries, which
    pandas writes for missing numbers, are read as NaN. Raises ValueError with the file's name if the columns
    are not `COLUMNS`, or if a number or verdict is invalid.
    """
    with Path(path).open(newline="", encoding="utf-8") as file:
        table = csv.DictReader(file)
        if tuple(table.fieldnames or ()) != COLUMNS:
            raise ValueError(f"{path}: not a claims table (its columns must be {', '.join(COLUMNS)})")
        rows = list(table)
    numbers = (*_STATED, *_JUDGED)
    for row in rows:
        try:
            row.update({name: math.nan if row[name] == "" else float(row[name]) for name in numbers})
        except (TypeError, ValueError) as error:
            raise ValueError(f"{path}: {error} in the row {row['claim']!r}") from None
        if row["verdict"] not in VERDICTS:
            raise ValueError(f"{path}: verdict: {row['verdict']!r} (must be one of {', '.join(VERDICTS)})")
    return rows


def collect(paths: Iterable[str | Path]) -> pandas.DataFrame:
    """Join the claims of several tables, in the order of `paths`, to a pandas DataFrame with `COLUMNS`."""
    import pandas

    return pandas.DataFrame([row for path in paths for row in read(path)], columns=list(COLUMNS))


def counts(rows: Iterable[dict[str, Any]]) -> dict[str, dict[str, int]]:
    """Count claims by kind and verdict, in the order of both lists and without zeros: {kind: {verdict:
    number}}.
    """
    pairs = [(row["kind"], row["verdict"]) for row in rows]
    return {
        kind: {verdict: pairs.count((kind, verdict)) for verdict in VERDICTS if (kind, verdict) in pairs}
        for kind in CLAIM_KINDS
        if any(kind == other for other, _ in pairs)
    }


def summary(path: str | Path) -> str:
    """Summarise a claims table as text. The first line has the number of claims. Then follow a line for each
    kind, "tests: 205 agree, 3 disagree", and a line for each claim that disagrees. Raises ValueError as
    `read` does.
    """
    rows = read(path)
    lines = [f"{len(rows)} claims"]
    for kind, verdicts in counts(rows).items():
        parts = (f"{number} {COUNTED.get(verdict, verdict)}" for verdict, number in verdicts.items())
        lines.append(f"{PLURALS[kind]}: {', '.join(parts)}")
    lines += [f"disagrees: {row['figure']}: {row['claim']}" for row in rows if row["verdict"] == "disagrees"]
    return "\n".join(map(visible, lines))


# Measured numbers in captions. They are filled in from the claims, and literal copies of them are detected. A
# caption names a measured number by the beginning of its claim, in double braces: the sphere's energy is
# {{equipartition M<V^2>/3kT, mass 1 times}} of that in equilibrium


_PLACE = re.compile(r"\{\{\s*(.*?)\s*\}\}", re.DOTALL)
_NUMBER = re.compile(r"(?<![\w.^/-])\d+\.\d+(?![\w.])")
NOT_MEASURED = "(not measured in this run)"


def fill_caption(caption: str, rows: Iterable[dict[str, Any]], absent: str = NOT_MEASURED) -> str:
    """Replace the placeholders of a caption by measured values, such as 0.930(16). The values come from the
    rows of the figure in the claims table. If there is no such claim, `absent` is inserted. Raises ValueError
    if a placeholder fits several claims.
    """
    entries = list(rows)

    def value(match: re.Match) -> str:
        beginning = " ".join(match[1].split())
        matching = [row for row in entries if row["claim"].startswith(beginning)]
        if len(matching) > 1:
            raise ValueError(f"{{{{{beginning}}}}}: {len(matching)} claims begin so")
        if not matching or not math.isfinite(_number(matching[0], "measured")):
            return absent
        return concise(_number(matching[0], "measured"), _number(matching[0], "uncertainty"))

    return _PLACE.sub(value, caption)


def place_fault(caption: str) -> str:
    """Return the fault of the placeholders in a caption; "" without a fault."""
    if any(not beginning.strip() for beginning in _PLACE.findall(caption)):
        return "{{ }} must hold the beginning of a claim"
    if "{{" in _PLACE.sub("", caption):
        return "{{ is not closed by }}"
    return ""


def _number(row: dict[str, Any], name: str) -> float:
    """Return a column of a row as a number; NaN for an empty entry."""
    return math.nan if row[name] == "" else float(row[name])


def concise(value: float, error: float) -> str:
    """Format a number with its uncertainty in units of the last digit: two digits below 20, else one."""
    if not (error > 0.0 and math.isfinite(error)):
        return f"{value:.5g}"
    digits = 1 - math.floor(math.log10(error))
    if error * 10.0**digits >= 19.5:
        digits -= 1
    if digits <= 0:
        return f"{round(value, digits):.0f}({round(error, digits):.0f})"
    return f"{value:.{digits}f}({error * 10.0**digits:.0f})"


def literal_copies(caption: str, rows: Iterable[dict[str, Any]]) -> list[str]:
    """Return measured numbers that a caption contains as literal text. Each result has the form "1.34:
    claim". Such a number has a decimal point. It equals the measured value of a claim, but not its expected
    value, if both are rounded to the same number of digits. A few numbers of another origin are reported by
    chance.
    """
    copies = []
    for text in _NUMBER.findall(_PLACE.sub("", caption)):
        digits = len(text.split(".")[1])
        for row in rows:
            measured, expected = (round(_number(row, name), digits) for name in ("measured", "expected"))
            if float(text) == measured != expected:
                copies.append(f"{text}: {row['claim']}")
    return copies
