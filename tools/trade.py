"""Trade of the reproduction: its processor time against what its claims decide.

python tools/trade.py 0.25 results 36.6 25.2     record a run: effort, results, minutes of CPU and of wall
python tools/trade.py                            draw what is recorded: docs/trade.png

The minutes are those of `time make EFFORT=...` (user and sys), with all runs that the results go on from.
"""

from __future__ import annotations

import csv
import math
import sys
from pathlib import Path

from gaspart.reproduction.claims import table

TABLE = Path("docs/trade.csv")
CONCLUSIVE = {"agrees", "disagrees", "reproduced", "source in error"}
"""Verdicts that longer runs would not change but by chance."""


def verdicts(results: Path) -> dict[str, float]:
    """Return the numbers of figures, claims and verdicts, and the rms of deviations in standard errors."""
    files = sorted((results / "claims").glob("*.csv"))
    rows = [row for file in files for row in table.read(file)]
    found = [row["verdict"] for row in rows]
    sigmas = [row["deviation_sigma"] for row in rows if row["scattered"] == 1.0]
    return {
        "figures made": len(files),
        "claims": len(rows),
        "conclusive": sum(verdict in CONCLUSIVE for verdict in found),
        "agree": sum(verdict in ("agrees", "reproduced") for verdict in found),
        "disagree": found.count("disagrees"),
        "rms z": math.sqrt(sum(sigma**2 for sigma in sigmas) / len(sigmas)) if sigmas else math.nan,
    }


def record(effort: str, results: Path, cpu: str, wall: str) -> None:
    """Write the row of a run into the table; a row of the same effort is replaced."""
    row = {"effort": effort, "CPU min": cpu, "wall min": wall, **verdicts(results)}
    text = {name: f"{value:.3g}" if isinstance(value, float) else str(value) for name, value in row.items()}
    rows = {one["effort"]: one for one in read()} | {effort: text}
    with TABLE.open("w", newline="", encoding="utf-8") as file:
        written = csv.DictWriter(file, [*text], lineterminator="\n")
        written.writeheader()
        written.writerows(sorted(rows.values(), key=lambda one: float(one["CPU min"])))


def read() -> list[dict[str, str]]:
    """Return the recorded rows."""
    if not TABLE.exists():
        return []
    with TABLE.open(newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def draw() -> None:
    """Draw shares of claims, and the rms of deviations, against CPU time."""
    import matplotlib.pyplot as plt

    rows = read()
    time = [float(row["CPU min"]) for row in rows]
    figure, (left, right) = plt.subplots(1, 2, figsize=(7.0, 2.8), layout="constrained")
    for name, marker in (("conclusive", "o"), ("agree", "s")):
        left.plot(time, [float(row[name]) / float(row["claims"]) for row in rows], f"{marker}-", label=name)
    left.set(ylabel="share of claims", ylim=(0.0, 1.0))
    left.legend(loc="center left")
    right.plot(time, [float(row["rms z"]) for row in rows], "o-")
    right.axhline(1.0, linewidth=0.8, color="0.5")
    right.set(ylabel="rms deviation (standard errors)", ylim=(0.0, 1.5))
    for axes in (left, right):
        axes.set(xlabel="CPU time in min", xlim=(0.0, None))
        for row, x in zip(rows, time, strict=True):
            at = {"xycoords": ("data", "axes fraction"), "ha": "center", "va": "bottom"}
            axes.annotate(row["effort"], (x, 0.03), rotation=90, fontsize="small", **at)
    figure.savefig("docs/trade.png", dpi=150)


if __name__ == "__main__":
    if len(sys.argv) > 1:
        effort, results, cpu, wall = sys.argv[1:]
        record(effort, Path(results), cpu, wall)
    draw()
