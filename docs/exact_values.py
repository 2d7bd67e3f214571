"""The page of exact values, from the table that the tests make (`tests/exact`)."""

import csv
from collections import defaultdict
from pathlib import Path

FILE = Path(__file__).parents[1] / "results/docs/exact_values.csv"
INTRODUCTION = """\
Symmetries find no wrong constant, no wrong weight and no area of the wrong particle: these leave all of them
in place. So every observable is also compared with a value that is known exactly, in every kind of scene.
The values share no code with gaspart: closed formulas (ideal and free-molecular gases, billiards, two
particles, few particles between reservoirs, the first terms in the time of time correlations), and a
Metropolis sampler of hard bodies in ``tests/exact``, with definitions of its own. Its contact densities are
ratios of insertions, without extrapolation; they give forces on walls and rates of collisions exactly,
whatever the geometry. ``PYTHONPATH=tests python -m exact.values`` samples them again; they are stored with
their uncertainty and recipe.

A cell has the largest deviation from its exact values, in standard uncertainties (as the normal deviate of
the same chance, corrected for the number of values), of a short run under each engine that serves the scene;
the tests require less than 4. An *r* means that the observable is undefined there and must be refused, a bar
that no exact value is known; the reasons are below. More than 80 planted errors, two or more of each
observable, are each caught by a named cell. The kinetic equations of the DSMC engine have closed forms of
their own. The theory that gaspart states for a run must agree with the run, too, within its
uncertainty. The last columns are balances: what counters of faces say of momentum, energy, force and number.

"""


def rows():
    """The rows of the table; none if it has not been made."""
    if not FILE.exists():
        return []
    with FILE.open(newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def page(heading, table, found=None):
    """The text of the page, of rows; heading(text, mark) and table(columns, rows) make its parts."""
    found = rows() if found is None else found
    text = heading("Exact values", "=") + INTRODUCTION
    if not found:
        return text + "This build of the site has no table: ``make docs`` makes it.\n\n"
    cells = [row for row in found if row["state"] != "not modelled"]
    observables = list(dict.fromkeys(row["observable"] for row in cells))
    runs = defaultdict(dict)
    for row in cells:
        runs[row["scene"], row["engine"]][row["observable"]] = row
    lines = [
        {
            "scene": f"{scene.replace('_', ' ')} ({engine})",
            **{name: _cell(cells[name]) for name in observables},
        }
        for (scene, engine), cells in runs.items()
    ]
    text += table({key.replace("_", " "): f"{{{key}}}" for key in ("scene", *observables)}, lines)
    for state, title in (("refused", "Undefined, and refused"), ("unknown", "No exact value")):
        groups = defaultdict(set)
        for row in found:
            if row["state"] == state:
                groups[row["text"]].add(row["observable"])
        reasons = [{"reason": why, "names": ", ".join(sorted(names))} for why, names in groups.items()]
        text += heading(title, "-") + table({"reason": "{reason}", "observables": "{names}"}, reasons)
    groups = defaultdict(set)
    for row in found:
        if row["state"] == "not modelled":
            groups[row["text"]].add(f"{row['scene'].replace('_', ' ')} ({row['engine']})")
    reasons = [{"reason": why, "names": ", ".join(sorted(names))} for why, names in groups.items()]
    text += heading("Scenes that an engine refuses", "-")
    return text + table({"reason": "{reason}", "scenes": "{names}"}, reasons)


def _cell(row):
    """The deviation, "r" or a bar."""
    return {"refused": "r", "unknown": "\\-"}.get(row["state"]) or row["deviation"]
