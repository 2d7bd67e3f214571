"""Claims on an axis of deviations: where each dot is, and how it looks."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

LIMIT = 5.0
"""Standard deviations at the ends of the axis; what lies beyond is drawn at its end."""
_BAND = 3.0
_WIDTH = 0.24
"""Standard deviations below which two dots would overlap."""
_LEVELS = 4


@dataclass(frozen=True)
class Dot:
    """row: of the claims table; place: percent of the axis; level: 0, 1, ... from below, so that dots do not
    hide one another."""

    row: dict[str, Any]
    place: float
    level: int


def deviation(row: dict[str, Any]) -> float:
    """Where a claim stands, in standard deviations: a value by its deviation; a measured number within two
    bounds by its place between them, which are at -3 and 3; 0 if there is none."""
    low, high, measured = row["lowest"], row["highest"], row["measured"]
    if math.isfinite(low) and math.isfinite(high) and math.isfinite(measured) and high > low:
        return _BAND * (2.0 * measured - low - high) / (high - low)
    sigma = row["deviation_sigma"]
    return sigma if not math.isnan(sigma) else 0.0


def dots(rows: Iterable[dict[str, Any]]) -> list[Dot]:
    """The dots of some claims, from the lowest deviation to the highest."""
    last = [-math.inf] * _LEVELS
    placed = []
    for row in sorted(rows, key=deviation):
        at = min(max(deviation(row), -LIMIT), LIMIT)
        free = [level for level in range(_LEVELS) if at - last[level] >= _WIDTH]
        level = free[0] if free else min(range(_LEVELS), key=last.__getitem__)
        last[level] = at
        placed.append(Dot(row, 50.0 * (1.0 + at / LIMIT), level))
    return placed
