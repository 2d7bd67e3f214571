"""The table of what the battery covers, for a page of the site: `PYTHONPATH=tests python -m battery.table`.

A row for each symmetry, observable, state and reason, with the runs of which it holds. `make docs` makes it.
"""

import csv
import re
import warnings
from collections import defaultdict
from functools import cache
from pathlib import Path

from battery import symmetries, twins
from battery.kinds_of_runs import runs
from battery.observed import names

from gaspart.analysis.observables import observables_with

FILE = Path(__file__).parents[2] / "results/docs/symmetries.csv"
COLUMNS = ("symmetry", "observable", "state", "reason", "runs", "deviation", "unit")
SYMMETRIES = (
    "shifted", "mirrored", "exchanged", "renumbered", "moving", "units",
    "one species", "simulation", "parts", "start",
)  # fmt: skip
"""All symmetries, in the order of the table."""
FLUXES = observables_with(needs="fluxes")
WHOLE = "(all variables of a file)"
"""In place of an observable: what a pair of runs is compared by."""
_PARTS = (
    symmetries.of_views,
    symmetries.in_units,
    symmetries.of_division,
    symmetries.of_simulation,
    symmetries.of_parts,
)
_NUMBER = re.compile(r"(?<![\w.])-?\d[\d.]*(e[+-]?\d+)?\b")


@cache
def cells(engine, name):
    """The cells of a run."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # of steps that are too long for the viscosity
        return [cell for part in _PARTS for cell in part(engine, name, names())]


@cache
def pairs(engine, name):
    """The pairs of runs of an engine and a kind of scene."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        return [*twins.of_views(engine, name), *twins.in_units(engine, name)]


def rows():
    """The rows of the table, as texts."""
    found = defaultdict(list)
    for engine, name in runs()[0]:
        for cell in cells(engine, name):
            reason = "" if cell.state == "tested" else _NUMBER.sub("#", cell.text)
            found[cell.symmetry, cell.observable, cell.state, reason, cell.unit].append(cell)
        for twin in pairs(engine, name):
            reason = "" if twin.state == "tested" else twin.text
            unit = "rounding" if twin.state == "tested" else ""
            found[twin.symmetry, WHOLE, twin.state, reason, unit].append(twin)
    order = {name: n for n, name in enumerate((WHOLE, *names()))}
    keys = sorted(
        found, key=lambda key: (SYMMETRIES.index(key[0]), order[key[1]], key[2] != "tested", key[2:])
    )
    return [_row(key, found[key]) for key in keys]


def _row(key, group):
    symmetry, observable, state, reason, unit = key
    by_engine = defaultdict(list)
    for one in group:
        by_engine[one.engine].append(one.scene)
    text = "; ".join(f"{engine}: {' '.join(scenes)}" for engine, scenes in by_engine.items())
    deviation = f"{max(one.deviation for one in group):.1g}" if state == "tested" else ""
    return dict(zip(COLUMNS, (symmetry, observable, state, reason, text, deviation, unit), strict=True))


def write():
    """Write the file."""
    found = rows()
    FILE.parent.mkdir(parents=True, exist_ok=True)
    with FILE.open("w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, COLUMNS, lineterminator="\n")
        writer.writeheader()
        writer.writerows(found)


if __name__ == "__main__":
    write()
