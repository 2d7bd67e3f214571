"""The table of extremes: every scene in every engine and precision."""

from __future__ import annotations

from functools import partial

import numpy as np
import xarray as xr

from gaspart.reproduction.families.extremes.guard import guarded
from gaspart.reproduction.families.extremes.rows import ROWS, Row
from gaspart.reproduction.families.extremes.trial import TRIAL_ENGINES, Outcome, attempt
from gaspart.reproduction.points.point import Point

LIMIT = 300.0
"""Seconds after which a row counts as one that hangs."""
HANGS = "hangs"
_ALL_PAIRS = "event, all pairs"


def stability_extremes(points: list[Point], settings: dict) -> xr.Dataset:
    """Run all rows of the table, or those whose group is in the setting `groups`. There are no points.

    Returns over row and engine: verdict ("passes", "refused", "fails", "hangs"), message, what was refused or
    failed; energy, momentum, overlap, contacts, missed (see `extremes.trial.Outcome`), seconds; refusal,
    whether a refusal is the expected result. Over row:
    group; expected, the contacts that there must be by an exact answer, -1 where all pairs are the referee.
    """
    groups = settings.get("groups")
    rows = [row for row in ROWS if groups is None or row.group in groups]
    limit = LIMIT * len(TRIAL_ENGINES)
    outcomes = guarded(run_row, rows, limit)
    lost = [Outcome(HANGS, f"not done within {limit:g} s")] * len(TRIAL_ENGINES)
    table = [outcome or lost for outcome in outcomes]

    def column(name: str, unit: str) -> tuple[tuple[str, str], np.ndarray, dict[str, str]]:
        values = np.array([[getattr(outcome, name) for outcome in line] for line in table])
        return ("row", "engine"), values, {"units": unit}

    return xr.Dataset(
        {
            "verdict": column("verdict", "1"),
            "message": column("message", "1"),
            "energy": column("energy", "kinetic energy"),
            "momentum": column("momentum", "sum of all |p|"),
            "overlap": column("overlap", "contact distance"),
            "contacts": column("contacts", "1"),
            "missed": column("missed", "1"),
            "seconds": column("seconds", "s"),
            "refusal": (
                ("row", "engine"),
                np.array([[engine.startswith(row.refused) for engine in TRIAL_ENGINES] for row in rows]),
            ),
            "group": ("row", [row.group for row in rows]),
            "expected": ("row", [-1 if row.contacts is None else row.contacts for row in rows]),
        },
        coords={"row": [row.name for row in rows], "engine": list(TRIAL_ENGINES)},
    )


def run_row(row: Row) -> list[Outcome]:
    """What becomes of a row in each engine; the search through all pairs first, for it is the referee."""
    trial = partial(attempt, row)
    referee = trial(_ALL_PAIRS)
    return [referee if engine == _ALL_PAIRS else trial(engine, referee) for engine in TRIAL_ENGINES]
