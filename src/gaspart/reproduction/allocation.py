"""Lengths of the runs of each point: the least CPU time that decides all claims.

    python -m gaspart.reproduction.allocation config/config.yaml PAGE

reads a finished run, writes the block `lengths` at the end of the config, and a table of all points to PAGE.
The run is an independent one: before the next run the config gets another seed.

The variance of a claim is a sum over the points of which its number is made, sum_p c_p / x_p, where x_p is
the multiple of the length of point p. The part c_p follows from enlarging the uncertainties of the rows of
point p. A decided claim needs a variance of at most V. The time sum_p t_p x_p, where t_p is the time of point
p, is least under all these conditions if x_p^2 = sum_k lambda_k c_kp / t_p, with a multiplier lambda_k >= 0
for each claim k (for one claim: J. Neyman, J. R. Stat. Soc. 97, 558 (1934)).
"""

from __future__ import annotations

import itertools
import math
import sys
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from gaspart.reproduction import cost as budget
from gaspart.reproduction.claims.judging import judge, sufficient
from gaspart.reproduction.config import open_config
from gaspart.reproduction.points.point import Point
from gaspart.reproduction.table import MADE_OF

IN_HAND = 1.3
"""Factor by which the length of the runs of a claim is larger than the claim needs."""
SHORTEST, LONGEST = 0.1, 1.5
"""Limits of the multiples."""
_ENLARGED = 2.0
"""Factor by which variances are enlarged, to find their parts."""
_EXPLAINED = 0.98
"""Part of a variance above which the rest is an effect of rounding."""
_HEAD = "\nlengths:"


@dataclass(frozen=True)
class Demand:
    """Decided claim of a figure.

    parts : part of its variance that each point has; their sum is 1 or less.
    rest : part that no single point has.
    most : multiple of the variance that it may have.
    """

    figure: str
    claim: str
    parts: Mapping[str, float]
    rest: float
    most: float


def demands(figure: str, block: Mapping, dataset: xr.Dataset) -> Iterator[Demand]:
    """Find the demands of the claims of a figure that runs decide and that are decided."""
    before = budget.claims_of(figure, block, dataset)
    rows = list(_rows(dataset))
    after = [budget.claims_of(figure, block, _enlarge_errors(dataset, position)) for position, _ in rows]
    for n, (claim, verdict) in enumerate(zip(before, judge(before), strict=True)):
        multiple = sufficient(claim)
        if not budget.is_decided_by_runs(claim) or not multiple <= 1.0 or verdict == "inconclusive":
            continue
        parts: dict[str, float] = {}
        for (_, points), stated in zip(rows, after, strict=True):
            grown = (stated[n].measured.error / claim.measured.error) ** 2 - 1.0
            for point in points:
                part = max(grown, 0.0) / (_ENLARGED - 1.0) / len(points)
                parts[point] = parts.get(point, 0.0) + part
        total = sum(parts.values())
        scale = 1.0 / max(total, 1.0)
        parts = {point: part * scale for point, part in parts.items() if part > 0.0}
        rest = 0.0 if total > _EXPLAINED else 1.0 - total
        yield Demand(figure, claim.claim, parts, rest, 1.0 / (multiple * IN_HAND))


def _rows(dataset: xr.Dataset) -> Iterator[tuple[dict[str, int], list[str]]]:
    """Find the rows of a measurement that state their points: place by dimension, points."""
    for name, column in dataset.variables.items():
        if str(name).endswith(MADE_OF):
            for position, text in np.ndenumerate(column.values.astype(object)):
                if isinstance(text, str):  # else a gap of a table with two dimensions
                    yield dict(zip(map(str, column.dims), position, strict=True)), text.splitlines()


def _enlarge_errors(dataset: xr.Dataset, position: Mapping[str, int]) -> xr.Dataset:
    """Return the data with enlarged uncertainties, and an enlarged scatter of replicas, in a row."""
    factor = np.ones([dataset.sizes[over] for over in position])
    factor[tuple(position.values())] = math.sqrt(_ENLARGED)
    scale = xr.DataArray(factor, dims=tuple(position))
    changed = {}
    for name, column in dataset.data_vars.items():
        replicas = [dim for dim in column.dims if str(dim).endswith("replica")]
        if not set(position) <= set(column.dims):
            continue
        if str(name).endswith("_error"):
            changed[name] = (column * scale).transpose(*column.dims)
        elif replicas and column.dtype.kind == "f":
            mean = column.mean(replicas)
            changed[name] = (mean + (column - mean) * scale).transpose(*column.dims)
    return dataset.assign(changed)


def allocate(
    demanded: Sequence[Demand],
    cost: Mapping[str, float],
    figures: Mapping[str, Sequence[str]],
    shortest: Mapping[str, float] | None = None,
) -> tuple[dict[str, float], list[float]]:
    """Return the multiple of the length of each point, and the price of each demand.

    cost : time of each point, in s.
    figures : points of each figure.
    shortest : least multiple of points that need more than `SHORTEST`.

    The price is the time in s that e times (2.72) the variance would save. Points of a figure that no row
    states, and the points of a claim with a rest, have the multiple that would suffice if all points had it.
    """
    names = sorted(cost)
    index = {name: n for n, name in enumerate(names)}
    least = np.array([max(SHORTEST, (shortest or {}).get(name, 0.0)) for name in names])
    shares = np.zeros((len(demanded), len(names)))
    for k, demand in enumerate(demanded):
        for point, part in demand.parts.items():
            shares[k, index[point]] = part
    for figure, points in figures.items():
        own = [demand for demand in demanded if demand.figure == figure]
        stated = {point for demand in own for point in demand.parts}
        multiple = max((1.0 / demand.most for demand in own), default=1.0)
        uniform = max((1.0 / demand.most for demand in own if demand.rest), default=SHORTEST)
        for point in points:
            n = index[point]
            least[n] = max(least[n], min(uniform if point in stated else multiple, 1.0))
    most = np.array([demand.most for demand in demanded])
    times = np.array([max(cost[name], 1e-3) for name in names])
    lengths, prices = _least_cost(shares / most[:, None], times, least)
    return dict(zip(names, lengths.tolist(), strict=True)), prices.tolist()


def shortest_multiples(
    config: Mapping[str, Any], planned: Mapping[str, Mapping[str, Point]]
) -> dict[str, float]:
    """Return the multiple of each point that leaves its figure enough samples for blocks and lags."""
    multiples: dict[str, float] = {}
    for figure, points in budget.shown_points(config, planned).items():
        for experiment, name in points:
            settings, key = planned[experiment][name].settings, f"{experiment}/{name}"
            intervals = max(config["figures"][figure].get("blocks", 0), settings.get("lags", 0))
            samples = settings.get("samples", math.inf)
            # Where samples are fewer than blocks, these are parts of frames or replicas.
            multiple = intervals / samples if intervals <= samples else 0.0
            multiples[key] = max(multiples.get(key, 0.0), multiple)
    return multiples


def _least_cost(shares: np.ndarray, times: np.ndarray, least: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Minimise sum t x with shares @ (1 / x) <= 1 in given bounds.

    The bounds are least <= x <= LONGEST. Returns x and the multipliers of the first conditions, which are
    found by multiplication with the excess or the deficit.
    """
    lengths = np.maximum(least, SHORTEST)
    multipliers = np.where(shares.any(axis=1), times.mean(), 0.0)
    for _ in range(4000):
        lengths = np.clip(np.sqrt(multipliers @ shares / times), least, LONGEST)
        multipliers *= (shares @ (1.0 / lengths)) ** 0.5
    missing = max(1.0, float((shares @ (1.0 / lengths)).max(initial=0.0)))
    return lengths * missing, multipliers


def main(path: str, page: str) -> None:
    """Allocate lengths from the run of a config; see the module."""
    with open_config(path) as (config, planned):
        results = Path("results") / (config.get("run") or "")
        figures = budget.shown_points(config, planned)
        demanded = [
            demand
            for figure in figures
            for demand in demands(figure, config["figures"][figure], _read_measurement(results, figure))
        ]
        names = {figure: ["/".join(point) for point in points] for figure, points in figures.items()}
        points = {point for points in figures.values() for point in points}
        cost = {"/".join(point): budget.point_seconds(results, point) for point in points}
        multiples, prices = allocate(demanded, cost, names, shortest_multiples(config, planned))
        had = config.get("lengths") or {}
    for name in multiples:
        experiment, _, point = name.partition("/")
        multiples[name] = max(SHORTEST, multiples[name] * (had.get(experiment) or {}).get(point, 1.0))
    _write_lengths(Path(path), multiples)
    Path(page).write_text(_page(multiples, cost, demanded, prices), encoding="utf-8")


def _read_measurement(results: Path, figure: str) -> xr.Dataset:
    return xr.load_dataset(results / "measurements" / f"{figure}.nc")


def _write_lengths(path: Path, multiples: Mapping[str, float]) -> None:
    """Replace the block at the end of a config."""
    lines = [_HEAD.strip()]
    for experiment, points in itertools.groupby(multiples, key=lambda name: name.partition("/")[0]):
        lines.append(f"  {experiment}:")
        lines += [f'    "{name.partition("/")[2]}": {multiples[name]:.2g}' for name in points]
    before = path.read_text(encoding="utf-8").partition(_HEAD)[0]
    path.write_text(before.rstrip() + "\n\n" + "\n".join(lines) + "\n", encoding="utf-8")


def _page(
    multiples: Mapping[str, float],
    cost: Mapping[str, float],
    demanded: Sequence[Demand],
    prices: Sequence[float],
) -> str:
    """Return a table of all points, the most expensive first, and a table of claims.

    The claims are those that cost most.
    """
    rows = ["| point | s in the run | multiple | claim that needs it most |", "| --- | --- | --- | --- |"]
    for point in sorted(multiples, key=lambda name: -cost[name]):
        neediest = max(
            demanded, key=lambda candidate: candidate.parts.get(point, 0.0) / candidate.most, default=None
        )
        text = f"{neediest.figure}: {neediest.claim}" if neediest and point in neediest.parts else "–"
        rows.append(f"| {point} | {cost[point]:.1f} | {multiples[point]:.2g} | {text} |")
    rows += ["", "| claim | s saved by e times its variance | length that it needs |", "| --- | --- | --- |"]
    for demand, price in sorted(zip(demanded, prices, strict=True), key=lambda pair: -pair[1]):
        rows.append(f"| {demand.figure}: {demand.claim} | {price:.1f} | {1.0 / demand.most:.2g} |")
    return "\n".join(rows) + "\n"


if __name__ == "__main__":
    main(*sys.argv[1:])
