"""The table of extremes: every scene in every engine and precision."""

from __future__ import annotations

from functools import partial
from typing import Any

import xarray as xr

from gaspart.reproduction.families.extremes.guard import run_guarded
from gaspart.reproduction.families.extremes.rows import ROWS, Row
from gaspart.reproduction.families.extremes.trial import TRIAL_ENGINES, Outcome, attempt
from gaspart.reproduction.points.point import Point
from gaspart.reproduction.table import table

LIMIT = 300.0
"""Seconds after which a row counts as one that hangs."""
HANGS = "hangs"
UNITS = {
    "energy": "kinetic energy",
    "momentum": "sum of all |p|",
    "overlap": "contact distance",
    "seconds": "s",
}
_ALL_PAIRS = "event, all pairs"


def stability_extremes(points: list[Point], settings: dict) -> xr.Dataset:
    """Run all rows of the table, or the rows of the setting `groups`, without points.

    Returns over row and engine: verdict ("passes", "refused", "fails", "hangs"), message, of the refusal or
    failure; energy, momentum, overlap, contacts, missed (see `extremes.trial.Outcome`), seconds; refusal, 1
    if a refusal is the expected result. Over row: group; expected, the contacts that there must be by an
    exact answer, -1 where all pairs are the referee.
    """
    groups = settings.get("groups")
    rows = [row for row in ROWS if groups is None or row.group in groups]
    limit = LIMIT * len(TRIAL_ENGINES)
    lost = [Outcome(HANGS, f"not done within {limit:g} s")] * len(TRIAL_ENGINES)
    outcomes = [outcome or lost for outcome in run_guarded(run_row, rows, limit)]
    dataset = table("row", list(zip(rows, outcomes, strict=True)), _columns, inner=("engine",), units=UNITS)
    return dataset.assign_coords(row=[row.name for row in rows], engine=list(TRIAL_ENGINES))


def _columns(of: tuple[Row, list[Outcome]]) -> dict[str, Any]:
    row, outcomes = of
    names = ("verdict", "message", *UNITS, "contacts", "missed")
    return {
        **{name: [getattr(outcome, name) for outcome in outcomes] for name in names},
        "refusal": [engine.startswith(row.refused) for engine in TRIAL_ENGINES],
        "group": row.group,
        "expected": -1 if row.contacts is None else row.contacts,
    }


def run_row(row: Row) -> list[Outcome]:
    """Run a row in each engine; the search through all pairs first, as the referee."""
    trial = partial(attempt, row)
    referee = trial(_ALL_PAIRS)
    return [referee if engine == _ALL_PAIRS else trial(engine, referee) for engine in TRIAL_ENGINES]
