"""The folder that is judged, and the table of all findings, of which docs/pages.py makes a page."""

import csv
from importlib import metadata
from pathlib import Path

import published
import pytest
from referees import REFEREES, of_numbers

ROOT = Path(__file__).parents[2]
FOLDER = ROOT / "results/referees"
TABLE = ROOT / "docs/referees.csv"
COLUMNS = "package", "version", "what", "ours", "theirs", "distance", "allowed", "scale", "error", "planted"
FOUND = pytest.StashKey()


def pytest_configure(config):
    config.stash[FOUND] = {}
    if not (FOLDER / "published.json").exists():  # the last file that runs.py writes
        raise pytest.UsageError(f"{FOLDER}: no complete runs (make referees makes them)")


def pytest_generate_tests(metafunc):
    if "referee" in metafunc.fixturenames:
        chosen = [*REFEREES, *of_numbers(FOLDER)]
        metafunc.parametrize("referee", chosen, ids=[f"{one.package}: {one.what}" for one in chosen])


@pytest.fixture
def folder():
    return FOLDER


@pytest.fixture
def keep(request, referee):
    """A function that keeps a finding for the table, and returns it."""

    def kept(finding, planted=False):
        request.config.stash[FOUND][(referee.package, referee.what, planted)] = finding
        return finding

    return kept


def pytest_sessionfinish(session):
    """Renew the lines of the table whose referees have judged both; those of others stay."""
    found = session.config.stash[FOUND]
    referees = {(one.package, one.what): one for one in [*REFEREES, *of_numbers(FOLDER)]}
    known = {}
    if TABLE.exists():
        with TABLE.open(newline="", encoding="utf-8") as file:
            known = {(line["package"], line["what"]): line for line in csv.DictReader(file)}
    for key, referee in referees.items():
        if (*key, False) in found and (*key, True) in found:
            known[key] = row(referee, found)
    with TABLE.open("w", newline="", encoding="utf-8") as file:
        table = csv.DictWriter(file, (*COLUMNS, "in_ours", "in_theirs"), lineterminator="\n")
        table.writeheader()
        table.writerows(known[key] for key in referees if key in known)


def row(referee, found):
    """One line of the table. What depends on nothing but the locked environments is in it, and no time."""
    good, wrong = (found[referee.package, referee.what, planted] for planted in (False, True))
    line = {"package": referee.package, "what": referee.what, "ours": good.ours, "theirs": good.theirs}
    line |= {"scale": good.scale, "error": referee.error, "allowed": f"{good.allowed:g}"}
    line |= {"distance": f"{good.distance:.2g}", "planted": f"{wrong.distance:.2g}"}
    if referee in REFEREES:
        version = referee.version() if referee.version else metadata.version(referee.package)
        return line | {"version": version}
    deviations = published.deviations(FOLDER)[referee.what]
    return line | dict(zip(("in_ours", "in_theirs"), deviations, strict=True))
