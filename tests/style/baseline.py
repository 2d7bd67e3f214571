"""Number of departures from the style in each package, which may only decrease.

    PYTHONPATH=tests python -m style.baseline              compare with the baseline, as `make lint` does
    PYTHONPATH=tests python -m style.baseline --lower      lower the baseline to the present numbers
    PYTHONPATH=tests python -m style.baseline --list opening theory    list a rule in a package

The rules are those of `ruff` (pydocstyle), `style.wording` and `style.public`.
"""

from __future__ import annotations

import argparse
import json
import subprocess
import sys
from collections import Counter
from pathlib import Path

from style import public, wording
from style.wording import Departure

ROOT = Path(__file__).parents[2]
SOURCE = ROOT / "src/gaspart"
FILE = Path(__file__).with_name("baseline.json")
Counts = dict[str, dict[str, int]]


def all_departures() -> list[Departure]:
    """Return the violations of all rules in the package."""
    modules = sorted(SOURCE.rglob("*.py"))
    rows = [departure for path in modules for departure in wording.departures(path)]
    rows += [departure for name in public.public_names() for departure in public.departures(name)]
    return rows + _of_ruff()


def _of_ruff() -> list[Departure]:
    """Return the violations of pydocstyle's rules, also of those that `pyproject.toml` ignores."""
    command = [sys.executable, "-m", "ruff", "check", "--select=D", "--ignore=D105", "--output-format=json"]
    convention = ["--config", 'lint.pydocstyle.convention="numpy"']
    done = subprocess.run([*command, *convention, str(SOURCE)], cwd=ROOT, capture_output=True, text=True)
    entries = json.loads(done.stdout)
    return [
        Departure(entry["code"], Path(entry["filename"]), entry["location"]["row"], entry["message"])
        for entry in entries
    ]


def package_of(departure: Departure) -> str:
    """Return the package of a violation: the first folder below `gaspart`."""
    parts = departure.path.relative_to(SOURCE).parts
    return parts[0] if len(parts) > 1 else "gaspart"


def count(rows: list[Departure]) -> Counts:
    """Return the numbers of violations by rule and package, without zeros."""
    counts: dict[str, Counter[str]] = {}
    for departure in rows:
        counts.setdefault(departure.rule, Counter())[package_of(departure)] += 1
    return {rule: dict(sorted(counts[rule].items())) for rule in sorted(counts)}


def read() -> Counts:
    """Return the numbers that the baseline allows."""
    return json.loads(FILE.read_text(encoding="utf-8"))


def above(counts: Counts, allowed: Counts) -> list[tuple[str, str, int, int]]:
    """Return rule, package, number and allowed number wherever the number is larger."""
    rows = [
        (rule, package, number) for rule, packages in counts.items() for package, number in packages.items()
    ]
    limits = [(*row, allowed.get(row[0], {}).get(row[1], 0)) for row in rows]
    return [row for row in limits if row[2] > row[3]]


def lower(counts: Counts, allowed: Counts) -> Counts:
    """Return the smaller one of both numbers, for each rule and package of the baseline."""
    smaller = {
        rule: {
            package: min(number, counts.get(rule, {}).get(package, 0)) for package, number in packages.items()
        }
        for rule, packages in allowed.items()
    }
    positive = {rule: {key: n for key, n in packages.items() if n} for rule, packages in smaller.items()}
    return {rule: packages for rule, packages in positive.items() if packages}


def report(rows: list[Departure], allowed: Counts) -> str:
    """Return a line for each number above the baseline; "" if there is no such number."""
    lines = [
        f"{rule} in {package}: {number} departures, the baseline has {limit}; see them all with\n"
        f"    PYTHONPATH=tests python -m style.baseline --list '{rule}' {package}"
        for rule, package, number, limit in above(count(rows), allowed)
    ]
    return "\n".join(lines)


def main() -> int:
    """Compare with the baseline, lower it, or list; return the exit code."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--lower", action="store_true")
    parser.add_argument("--list", nargs=2, metavar=("RULE", "PACKAGE"))
    options = parser.parse_args()
    rows = all_departures()
    if options.list:
        chosen = [row for row in rows if [row.rule, package_of(row)] == options.list]
        print(*chosen, sep="\n")
        return 0
    allowed = read()
    if options.lower:
        allowed = lower(count(rows), allowed)
        FILE.write_text(json.dumps(allowed, indent=1) + "\n", encoding="utf-8")
    excess = report(rows, allowed)
    print(excess or f"style: {len(rows)} departures, none above the baseline")
    return 1 if excess else 0


if __name__ == "__main__":
    sys.exit(main())
