"""The page of the symmetries of observables, from the table that the battery of tests writes."""

import csv
from collections import defaultdict
from pathlib import Path

FILE = Path(__file__).parents[1] / "results/docs/symmetries.csv"
ABOUT = {
    "shifted": "All particles are moved by half of the container along its periodic axes.",
    "mirrored": "One axis is mirrored, with the faces, the gravity and the flow along it.",
    "exchanged": "The three axes change places.",
    "renumbered": "The order of the species is reversed, and particles of each have other numbers.",
    "moving": "The motion is seen from a frame that moves uniformly; walls may slide along themselves there.",
    "units": "Units of mass, length and time are others, by powers of two, with the powers as declared.",
    "one species": "One species is stated as two that are equal, or two equal ones as one.",
    "simulation": "A simulation is measured instead of the file of its run.",
    "parts": "A run against its halves: the mean of both, or, of what is no mean over time, each other.",
    "start": "Measured from a later time on, as the end of the file alone.",
}
"""Symmetry -> what is done, in the order of the table."""
INTRODUCTION = """\
A small run of each kind of scene is made with each engine that models it, and seen otherwise: shifted,
mirrored, from a moving frame, in other units. Every observable must then be what its declaration says: the
same, or with its names, places, signs and units changed. A second run, which *starts* from the state seen
otherwise, must write the same file, as long as rounding has not grown (*all variables of a file*). The table
is made by the tests (``make docs``, or ``PYTHONPATH=tests python -m battery.table``), which fail if an
observable, an engine, a kind of face or a symmetry is missing.

Numbers are those of runs in which a symmetry was tested, with the largest deviation: in rounding, relative
to the largest value, or in standard uncertainties (σ) where samples are compared. A bar means that it is
defined in none of the runs; the reasons are below. Frames are in single precision, with numbers of about
seven digits. All runs, engines and reasons are in ``results/docs/symmetries.csv``.

"""


def rows():
    """The rows of the table; none if it has not been made."""
    if not FILE.exists():
        return []
    with FILE.open(newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def runs_in(text):
    """How many runs are named: `event: periodic walls; step: periodic`."""
    return sum(len(part.partition(": ")[2].split()) for part in text.split("; "))


def page(heading, table):
    """The text of the page; heading(text, mark) and table(columns, rows) make its parts."""
    found = rows()
    tested = {(row["observable"], row["symmetry"]): row for row in found if row["state"] == "tested"}
    names = list(dict.fromkeys(row["observable"] for row in found))
    lines = []
    for name in names:
        cells = {symmetry: _cell(tested.get((name, symmetry))) for symmetry in ABOUT}
        lines.append({"observable": name, **cells})
    columns = {key: f"{{{key}}}" for key in ("observable", *ABOUT)}
    text = heading("Symmetries of observables", "=") + INTRODUCTION
    text += (
        table(columns, lines) if lines else "This build of the site has no table: ``make docs`` makes it.\n\n"
    )
    for symmetry, about in ABOUT.items():
        text += heading(symmetry.capitalize(), "-") + about + "\n\n" + _reasons(found, symmetry, table)
    return text


def _cell(row):
    """The number of runs and the largest deviation."""
    if row is None:
        return "\\-"
    unit = " σ" if row["unit"] == "errors" else ""
    return f"{runs_in(row['runs'])}: {row['deviation']}{unit}"


def _reasons(found, symmetry, table):
    """Why a symmetry is not defined, or the observable refused both before and after."""
    groups = defaultdict(list)
    for row in found:
        if row["symmetry"] == symmetry and row["state"] != "tested":
            groups[row["reason"]].append(row)
    lines = [
        {
            "reason": reason.replace("*", "\\*").replace("|", "\\|"),
            "observables": ", ".join(row["observable"] for row in rows),
            "runs": " to ".join(map(str, sorted({min(n), max(n)})))
            if (n := [runs_in(r["runs"]) for r in rows])
            else "",
        }
        for reason, rows in groups.items()
    ]
    columns = {
        "not defined, or refused alike": "{reason}",
        "observables": "{observables}",
        "runs of each": "{runs}",
    }
    return table(columns, lines) if lines else ""
