"""Tables of judged claims: written per figure as CSV, read, collected and counted."""

from __future__ import annotations

import csv
import math
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from gaspart.claims.claim import Claim
from gaspart.claims.judging import VERDICTS, judge
from gaspart.files import whole_file

if TYPE_CHECKING:
    import pandas

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
_NUMBERS = ("measured", "uncertainty", "required_uncertainty", "expected", "deviation_sigma")


def write(path: str | Path, figure: str, claims: Sequence[Claim]) -> None:
    """Judge the claims of `figure` and write them as CSV with COLUMNS, atomically.

    Raises ValueError if two claims have the same text: their rows could not be distinguished.
    """
    texts = [claim.claim for claim in claims]
    for text in texts:
        if texts.count(text) > 1:
            raise ValueError(f"{figure}: the claim {text!r} occurs twice")
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
                    f"{claim.measured.value:.10g}",
                    f"{claim.measured.error:.4g}",
                    f"{claim.required:.4g}",
                    f"{claim.expected.value:.10g}",
                    claim.stated_source,
                    f"{claim.deviation_sigma:.3f}",
                    verdict,
                    claim.fails_if,
                ]
            )


def read(path: str | Path) -> list[dict[str, Any]]:
    """Rows of a claims table as dictionaries by column; the numbers as floats, NaN where pandas left none.

    Raises ValueError, naming the file, if its columns are not COLUMNS or a number or verdict is invalid.
    """
    with Path(path).open(newline="", encoding="utf-8") as file:
        table = csv.DictReader(file)
        if tuple(table.fieldnames or ()) != COLUMNS:
            raise ValueError(f"{path}: not a claims table (its columns must be {', '.join(COLUMNS)})")
        rows = list(table)
    for row in rows:
        try:
            row.update({name: math.nan if row[name] == "" else float(row[name]) for name in _NUMBERS})
        except (TypeError, ValueError) as error:
            raise ValueError(f"{path}: {error} in the row {row['claim']!r}") from None
        if row["verdict"] not in VERDICTS:
            raise ValueError(f"{path}: verdict: {row['verdict']!r} (must be one of {', '.join(VERDICTS)})")
    return rows


def collect(paths: Iterable[str | Path]) -> pandas.DataFrame:
    """All claims of several tables as one pandas DataFrame with COLUMNS, in the order of `paths`."""
    import pandas

    return pandas.DataFrame([row for path in paths for row in read(path)], columns=list(COLUMNS))


def summary(path: str | Path) -> str:
    """What a claims table says, in one line, "212 claims: 205 agree, 3 disagree, ...", and a line for each
    claim that disagrees. Raises ValueError as `read` does."""
    rows = read(path)
    counts = {verdict: sum(row["verdict"] == verdict for row in rows) for verdict in VERDICTS}
    lines = [
        f"{len(rows)} claims: {counts['agrees']} agree, {counts['disagrees']} disagree, "
        f"{counts['inconclusive']} inconclusive"
    ]
    lines += [f"disagrees: {row['figure']}: {row['claim']}" for row in rows if row["verdict"] == "disagrees"]
    return "\n".join(lines)
