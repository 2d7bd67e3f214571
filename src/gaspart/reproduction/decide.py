"""Efforts that decide the claims of a finished run: more for the experiments behind claims that are open.

What is continued depends on uncertainties alone, never on how far a number is from its expected value:
otherwise only the runs that happen to disagree would be longer, and verdicts would be biased.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from gaspart.errors import SceneError
from gaspart.reproduction.claims.judging import sufficient
from gaspart.reproduction.config import open_config, write_efforts
from gaspart.reproduction.cost import claims_of, is_decided_by_runs, point_seconds
from gaspart.reproduction.points.points import all_points, effort_of, points
from gaspart.reproduction.table import MADE_OF

if TYPE_CHECKING:
    import xarray as xr

    from gaspart.reproduction.claims.judging import Claim
    from gaspart.reproduction.points.point import Point

MOST = 4.0
"""Largest effort with which a claim is decided."""


@dataclass(frozen=True)
class Open:
    """Claim that is not decided: the experiments behind its uncertainty, and the effort that it needs."""

    figure: str
    claim: str
    experiments: frozenset[str]
    effort: float


def decide(path: str | Path) -> list[str]:
    """Write the efforts of the next run beside the points, and return lines that say which and how long.
    `path` is the config of a finished run. Without a claim that more effort could decide nothing is written,
    and the list is empty. Raises SceneError if a figure has not been made.
    """
    import xarray as xr

    with open_config(path) as (config, _):
        present = {name: effort_of(config, name) for name in config["experiments"]}
        results = Path("results") / (config.get("run") or "")
        undecided: list[Open] = []
        for figure, block in config["figures"].items():
            file = results / "measurements" / f"{figure}.nc"
            if not file.is_file():
                raise SceneError("results", str(file), "is not there: run the workflow first")
            undecided += find_open(figure, block, xr.load_dataset(file), present)
        chosen = next_efforts(undecided, present)
        if not chosen:
            return []
        lines = _describe(config, chosen, present, undecided, results)
        write_efforts(Path(config["points"]), chosen)
    return lines


def find_open(
    figure: str, block: Mapping[str, Any], dataset: xr.Dataset, present: Mapping[str, float]
) -> list[Open]:
    """Return the claims of a figure that more effort than `present` could decide."""
    stated = claims_of(figure, block, dataset)
    names = block["experiments"]
    larger = {name: claims_of(figure, block, with_larger_errors(dataset, name)) for name in names}
    rows = []
    for number, claim in enumerate(stated):
        multiple = sufficient(claim)
        if not is_decided_by_runs(claim) or not 1.0 < multiple < math.inf:
            continue
        behind = [name for name in names if _error(larger[name], number) != claim.measured.error]
        used = frozenset(behind or names)
        rows.append(Open(figure, claim.claim, used, multiple * min(present[name] for name in used)))
    return rows


def _error(stated: list[Claim], number: int) -> float:
    return stated[number].measured.error if number < len(stated) else math.nan


def with_larger_errors(dataset: xr.Dataset, experiment: str) -> xr.Dataset:
    """Return a data set with twice the errors in the rows that are made from points of an experiment."""
    changed = dataset.copy(deep=True)
    for name, made in dataset.data_vars.items():
        if not str(name).endswith(MADE_OF):
            continue
        own = [f"\n{experiment}/" in f"\n{text}" for text in made.values.ravel()]
        factor = made.copy(data=np.where(np.reshape(own, made.shape), 2.0, 1.0))
        for other, values in dataset.data_vars.items():
            if str(other).endswith("_error") and set(made.dims) <= set(values.dims):
                changed[other] = (values * factor).transpose(*values.dims)
    return changed


def next_efforts(undecided: list[Open], present: Mapping[str, float]) -> dict[str, float]:
    """Return the efforts of the experiments to continue: twice the present ones, at most `MOST`. A claim that
    would need more than twice `MOST` is left open.
    """
    wanted = {name for one in undecided if one.effort <= 2.0 * MOST for name in one.experiments}
    return {name: min(2.0 * present[name], MOST) for name in sorted(wanted) if present[name] < MOST}


def _describe(
    config: dict[str, Any],
    chosen: Mapping[str, float],
    present: Mapping[str, float],
    undecided: list[Open],
    results: Path,
) -> list[str]:
    """Return a line for each experiment to continue, with the CPU time to expect, and their sum."""
    before = all_points(config)
    for name, effort in chosen.items():
        config["experiments"][name]["effort"] = effort
    lines, total = [], 0.0
    for name in chosen:
        seconds = 0.0
        for point in points(config, name):
            added = _length(point) / _length(before[name][point.name]) - 1.0
            seconds += added * point_seconds(results, (name, point.name))
        total += seconds
        count = sum(name in one.experiments for one in undecided)
        efforts = f"effort {present[name]:g} to {chosen[name]:g}"
        lines.append(f"{name}: {efforts} for {count} claims, some {seconds:.0f} s of CPU time")
    left = [one for one in undecided if one.effort > 2.0 * MOST]
    lines += [f"left open: {one.figure}: {one.claim} (needs an effort of {one.effort:.2g})" for one in left]
    return [*lines, f"all: some {total:.0f} s of CPU time"]


def _length(point: Point) -> float:
    """Return the length of all runs of a point, in units that equal points share."""
    if point.job == "simulate" and "until" not in point.settings:
        return point.schedule.duration * point.replicas
    return float(point.replicas * point.settings.get("samples", 1))
