"""Run lengths of all points: the least CPU time with which all claims are decided.

    python -m gaspart.reproduction.allocation config/config.yaml PAGE [FOLDER ...]

reads the finished run of the config. It also reads further runs with other seeds; they are in FOLDERs, with a
config of the same path. The program writes the block `lengths` at the end of the config, and a table of all
points to PAGE. All runs are independent: the config gets a new seed before each run. An uncertainty from a
few blocks or replicas is itself uncertain. The mean of the variances of two runs is less uncertain.

The number of a claim is computed from several points p. Its variance is the sum over these points, sum_p c_p
/ x_p. Here x_p is the multiple of the length of point p (x_p = 1 without `lengths`). The part c_p is found by
enlarging the uncertainties in the rows of point p. To decide the claim, its variance must be at most V. The
total time is sum_p t_p x_p, where t_p is the time of point p. This time is least under all these conditions
if x_p^2 = sum_k lambda_k c_kp / t_p, with a multiplier lambda_k >= 0 for each claim k (for a single claim: J.
Neyman, J. R. Stat. Soc. 97, 558 (1934)).
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

from gaspart.errors import SceneError
from gaspart.reproduction import cost as budget
from gaspart.reproduction.claims.judging import judge, sufficient
from gaspart.reproduction.config import open_config
from gaspart.reproduction.points.point import Point
from gaspart.reproduction.table import MADE_OF
from gaspart.yaml_text import read_yaml

IN_HAND = 1.6
"""Safety factor: the runs of a claim are this many times longer than the claim needs."""
SHORTEST, LONGEST = 0.3, 1.5
"""Smallest and largest multiple of the length of a run."""
WHOLE = ("buoyancy", "chemical_potential")
"""Figures whose runs keep their full length.

`buoyancy` was tried with 0.45 of the length. The squared deviations of its claims, in standard errors, then
had a mean of 2.63(37). Its discs wander so slowly that the uncertainties from shorter runs are too small. For
`chemical_potential`, shorter runs have too few frames with an insertion for a verdict.
"""
_ENLARGED = 2.0
"""Factor by which variances are enlarged, to find the part of each point."""
_EXPLAINED = 0.98
"""Fraction of a variance; if the points explain more than this, the rest is attributed to rounding."""
_HEAD = "\nlengths:"


@dataclass(frozen=True)
class Demand:
    """Decided claim of a figure.

    parts : fraction of the claim's variance that is due to each point; the sum is 1 or less.
    rest : fraction of the variance that is due to no single point.
    most : maximum variance of the claim, divided by its variance at the full length of the runs.
    """

    figure: str
    claim: str
    parts: Mapping[str, float]
    rest: float
    most: float


@dataclass(frozen=True)
class Run:
    """Finished run of a config.

    results : folder of the results of the run.
    lengths : multiple of the run length, by point, for the points that have a multiple.
    """

    results: Path
    lengths: Mapping[str, float]

    def measurement(self, figure: str) -> xr.Dataset:
        """Return the measurement of a figure."""
        return xr.load_dataset(self.results / "measurements" / f"{figure}.nc")

    def seconds(self, point: str) -> float | None:
        """Return the CPU time of a point at its full length.

        None if the run has not stored this time.
        """
        experiment, _, name = point.partition("/")
        try:
            return budget.point_seconds(self.results, (experiment, name)) / self.lengths.get(point, 1.0)
        except SceneError:
            return None


def demands(figure: str, block: Mapping, runs: Sequence[Run]) -> list[Demand]:
    """Return the demands of the claims of a figure that at least one run decided."""
    needs: dict[str, list[dict[str, float]]] = {}
    decided = set()
    for run in runs:
        for claim, is_decided, parts in _needs(figure, block, run):
            needs.setdefault(claim, []).append(parts)
            decided |= {claim} if is_decided else set()
    return [_mean_demand(figure, claim, parts) for claim, parts in needs.items() if claim in decided]


def _needs(figure: str, block: Mapping, run: Run) -> Iterator[tuple[str, bool, dict[str, float]]]:
    """Yield each claim with an uncertainty: text, True if decided, length needed by each point.

    The length is a multiple of the full length. If the claim's number had the scatter of this point alone,
    the claim would just be decided at that length. The key "" has the remainder of the variance that no
    single point explains.
    """
    dataset = run.measurement(figure)
    before = budget.claims_of(figure, block, dataset)
    rows = list(_rows(dataset))
    after = [budget.claims_of(figure, block, _enlarge_errors(dataset, position)) for position, _ in rows]
    for n, (claim, verdict) in enumerate(zip(before, judge(before), strict=True)):
        multiple = sufficient(claim)
        if claim.kind == "family" or claim.form == "distribution" or claim.no_verdict:
            continue  # longer runs do not decide these claims
        if not math.isfinite(multiple):
            continue
        parts: dict[str, float] = {}
        for (_, points), stated in zip(rows, after, strict=True):
            grown = (stated[n].measured.error / claim.measured.error) ** 2 - 1.0
            for point in points:
                part = max(grown, 0.0) / (_ENLARGED - 1.0) / len(points)
                parts[point] = parts.get(point, 0.0) + part
        total = sum(parts.values())
        requirements = {
            point: multiple * run.lengths.get(point, 1.0) * part / max(total, 1.0)
            for point, part in parts.items()
            if part > 0.0
        }
        requirements[""] = 0.0 if total > _EXPLAINED else multiple * (1.0 - total)
        yield claim.claim, multiple <= 1.0 and verdict != "inconclusive", requirements


def _mean_demand(figure: str, claim: str, needs: Sequence[Mapping[str, float]]) -> Demand:
    """Return the demand of a claim from the mean of its needs in several runs."""
    points = {point for need in needs for point in need}
    mean = {point: sum(need.get(point, 0.0) for need in needs) / len(needs) for point in points}
    rest = mean.pop("")
    total = rest + sum(mean.values())
    most = max(1.0 / (IN_HAND * total), 1.0 / LONGEST)
    return Demand(figure, claim, {point: part / total for point, part in mean.items()}, rest / total, most)


def _rows(dataset: xr.Dataset) -> Iterator[tuple[dict[str, int], list[str]]]:
    """Yield the rows of a measurement that name their points: index by dimension, and points."""
    for name, column in dataset.variables.items():
        if str(name).endswith(MADE_OF):
            for position, text in np.ndenumerate(column.values.astype(object)):
                if isinstance(text, str):  # otherwise the entry is a gap in a table with two dimensions
                    yield dict(zip(map(str, column.dims), position, strict=True)), text.splitlines()


def _enlarge_errors(dataset: xr.Dataset, position: Mapping[str, int]) -> xr.Dataset:
    """Return a measurement in which a row has larger uncertainties and more scatter of replicas."""
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

    cost : CPU time of each point, in s.
    figures : points of each figure.
    shortest : smallest multiple of each point that needs more than `SHORTEST`.

    The price of a demand is the time in s that would be saved if the variance could be e = 2.72 times larger.
    Some points of a figure are named in no row, and some claims have a `rest`. For these points a single
    multiple is used: the multiple that would suffice if all points had it.
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
    """Return the smallest multiple of each point at which its figure has enough samples.

    Blocks and lags need these samples.
    """
    multiples: dict[str, float] = {}
    for figure, points in budget.shown_points(config, planned).items():
        for experiment, name in points:
            settings, key = planned[experiment][name].settings, f"{experiment}/{name}"
            intervals = max(config["figures"][figure].get("blocks", 0), settings.get("lags", 0))
            samples = settings.get("samples", math.inf)
            # If samples are fewer than blocks, they are fractions of frames, or replicas.
            multiple = intervals / samples if intervals <= samples else 0.0
            multiples[key] = max(multiples.get(key, 0.0), multiple)
    return multiples


def _least_cost(shares: np.ndarray, times: np.ndarray, least: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Minimise sum t x under the conditions shares @ (1 / x) <= 1 and bounds.

    The bounds are least <= x <= LONGEST. The function returns x and the multipliers of the first conditions.
    It finds these multipliers by iteration: each is multiplied by a factor that depends on the excess or
    deficit of its condition.
    """
    lengths = np.maximum(least, SHORTEST)
    multipliers = np.where(shares.any(axis=1), times.mean(), 0.0)
    for _ in range(4000):
        lengths = np.clip(np.sqrt(multipliers @ shares / times), least, LONGEST)
        multipliers *= (shares @ (1.0 / lengths)) ** 0.5
    missing = max(1.0, float((shares @ (1.0 / lengths)).max(initial=0.0)))
    return lengths * missing, multipliers


def main(path: str, page: str, *folders: str) -> None:
    """Allocate run lengths from the finished runs of a config, as the module describes."""
    runs = [_open_run(Path(folder), path) for folder in (".", *folders)]
    with open_config(path) as (config, planned):
        figures = budget.shown_points(config, planned)
        demanded = [
            demand for figure in figures for demand in demands(figure, config["figures"][figure], runs)
        ]
        names = {figure: ["/".join(point) for point in points] for figure, points in figures.items()}
        shortest = shortest_multiples(config, planned)
    shortest |= {point: 1.0 for figure in WHOLE for point in names.get(figure, ())}
    cost = {point: _mean_seconds(runs, point) for points in names.values() for point in points}
    multiples, prices = allocate(demanded, cost, names, shortest)
    _write_lengths(Path(path), multiples)
    Path(page).write_text(_page(multiples, cost, demanded, prices), encoding="utf-8")


def _open_run(folder: Path, path: str) -> Run:
    config = read_yaml(folder / path)
    lengths = {
        f"{experiment}/{point}": multiple
        for experiment, points in (config.get("lengths") or {}).items()
        for point, multiple in points.items()
    }
    return Run(folder / "results" / (config.get("run") or ""), lengths)


def _mean_seconds(runs: Sequence[Run], point: str) -> float:
    stored = [seconds for run in runs if (seconds := run.seconds(point)) is not None]
    if not stored:
        raise SceneError("results", str(runs[0].results), f"has no time of the point {point}")
    return sum(stored) / len(stored)


def _write_lengths(path: Path, multiples: Mapping[str, float]) -> None:
    """Replace the block `lengths` of a config by the multiples that differ from 1."""
    rounded = {name: float(f"{multiple:.2g}") for name, multiple in multiples.items()}
    lines = [_HEAD.strip()]
    different = (name for name in rounded if rounded[name] != 1.0)
    for experiment, points in itertools.groupby(different, key=lambda name: name.partition("/")[0]):
        lines.append(f"  {experiment}:")
        lines += [f'    "{name.partition("/")[2]}": {rounded[name]:g}' for name in points]
    before = path.read_text(encoding="utf-8").partition(_HEAD)[0]
    path.write_text(before.rstrip() + "\n\n" + "\n".join(lines) + "\n", encoding="utf-8")


def _page(
    multiples: Mapping[str, float],
    cost: Mapping[str, float],
    demanded: Sequence[Demand],
    prices: Sequence[float],
) -> str:
    """Return a table of all points, the most expensive first, and a table of claims.

    The second table has the most expensive claims.
    """
    rows = [
        "| point | s at the whole length, if proportional to it | multiple | claim that needs it most |",
        "| --- | --- | --- | --- |",
    ]
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
