"""From pytest-benchmark's JSON to `results/tables/performance.csv` and `results/figures/performance.png`.

python benchmarks/table.py <json> <csv> <png>
"""

from __future__ import annotations

import json
import sys
from pathlib import Path

import numpy as np
import pandas as pd

from gaspart.rendering import style

DENSE = 0.05
"""The packing fraction from which spheres count as dense in the picture."""
COLUMNS = (
    "engine", "dimension", "count", "packing_fraction", "feature", "value", "spread", "unit", "rounds",
    "peer", "peer_value", "ratio", "plain_ratio", "bytes_per_particle", "tests_per_contact",
    "crossings_per_contact", "value_in_random_reads", "copy_bandwidth_GB_s", "read_latency_ns",
)  # fmt: skip


def table(run: dict) -> pd.DataFrame:
    """One row a benchmark: the median of its rounds with the half of their interquartile range; how often
    faster than its peer, and than the plain scene; work counted; the time in random reads of this machine."""
    rows = [_row(one, run["machine_info"]) for one in run["benchmarks"]]
    frame = pd.DataFrame(rows, columns=list(COLUMNS))
    plain = frame[frame["feature"] == "plain"].set_index(["engine", "dimension", "count", "packing_fraction"])
    for n, row in frame.iterrows():
        key = (row["engine"], row["dimension"], row["count"], row["packing_fraction"])
        if row["feature"] not in ("plain", "") and key in plain.index:
            quotient = row["value"] / plain.loc[key, "value"]
            frame.loc[n, "plain_ratio"] = quotient if row["engine"] == "event" else 1.0 / quotient
    return frame


def _row(one: dict, machine: dict) -> dict:
    info = one["extra_info"]
    reads = machine["read_latency_ns"]
    row = {"feature": "", **{key: info[key] for key in COLUMNS if key in info}}
    row |= {"copy_bandwidth_GB_s": machine["copy_bandwidth_GB_s"], "read_latency_ns": reads}
    values = np.array(info.get("values") or one["stats"]["data"], dtype=float)
    if info["engine"] == "event":
        values = np.array(info["stretches"]) / np.array(info["seconds"])
    elif info["engine"] == "step":
        values = np.array(info["seconds"]) / np.array(info["stretches"])
    low, value, high = np.percentile(values, [25, 50, 75])
    row |= {"value": value, "spread": 0.5 * (high - low), "rounds": len(values)}
    contacts = info.get("collisions", 0)
    if contacts:
        row["tests_per_contact"] = info["pair_tests"] / contacts
        row["crossings_per_contact"] = info["crossings"] / contacts
    if info["engine"] == "event":
        row |= {"ratio": value / info["peer_value"], "value_in_random_reads": 1e9 / value / reads}
    elif info["engine"] == "step":
        row |= {"ratio": info["peer_value"] / value, "value_in_random_reads": value / reads}
    return row


def draw(frame: pd.DataFrame):
    """Collisions a second against the packing fraction, with the peers'; and what a step costs a particle."""
    figure, axes = style.new((2.4,), (2.2,), (2.2,))
    plain = frame[(frame["engine"] == "event") & (frame["feature"] == "plain")]
    _events(axes[0], plain[plain["dimension"] == 3], "spheres (dashed: Smallenburg, C)")
    _events(axes[1], plain[plain["dimension"] == 2], "discs between walls (dashed: Spencer, C++)")
    _steps(axes[2], frame[frame["engine"] == "step"])
    return figure


def _events(axis, frame: pd.DataFrame, title: str) -> None:
    for kind, (count, part) in enumerate(frame.groupby("count")):
        eta, colour = part["packing_fraction"], style.COLOURS[kind]
        axis.plot(eta, 1e-6 * part["peer_value"], "--", color=colour)
        values, spread = 1e-6 * part["value"], 1e-6 * part["spread"]
        style.points(axis, eta, values, spread, kind=kind, label=f"N = {int(count):,}", linestyle="-")
    _finish(axis, frame, title)
    axis.set_xlabel("packing fraction $\\eta$")
    axis.set_ylabel("$10^6$ collisions / s")


def _steps(axis, frame: pd.DataFrame) -> None:
    kinds = {"plain": "float64, one thread", "two threads": "two threads", "float32": "float32"}
    for kind, (feature, label) in enumerate(kinds.items()):
        part = frame[frame["feature"] == feature]
        for dense, group in part.groupby(part["packing_fraction"] >= DENSE):
            text = f"{label}, $\\eta$ from 0.1" if dense else label
            values = group["count"], group["value"], group["spread"]
            style.points(axis, *values, kind=kind, hollow=bool(dense), label=text)
    peers = frame[frame["peer_value"].notna()]
    axis.plot(peers["count"], peers["peer_value"], "--", color=style.GREY, label="Frederickx & Meerts, C")
    _finish(axis, frame, "time steps of spheres")
    if len(frame):
        axis.set_xscale("log")
    axis.set_xlabel("number of spheres $N$")
    axis.set_ylabel("ns / (particle step)")


def _finish(axis, frame: pd.DataFrame, title: str) -> None:
    axis.set_title(title)
    if len(frame):
        axis.set_yscale("log")
        axis.legend(loc="upper right")


def main(source: str, csv: str, png: str) -> None:
    frame = table(json.loads(Path(source).read_text(encoding="utf-8")))
    for path in (csv, png):
        Path(path).parent.mkdir(parents=True, exist_ok=True)
    frame.to_csv(csv, index=False, float_format="%.5g")
    with style.use_style():
        style.save(draw(frame), png)


if __name__ == "__main__":
    main(*sys.argv[1:])
