"""Cost of a config in core-hours, predicted; cost of a finished run by figure."""

from __future__ import annotations

import csv
import math
import statistics
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING

from gaspart import theory
from gaspart.accuracy import table
from gaspart.accuracy.advisers import adviser_of, candidate_engines, timed_as
from gaspart.errors import SceneError
from gaspart.files import whole_file
from gaspart.reproduction import job_time, registry
from gaspart.reproduction.claims.judging import Claim, judge, sufficient
from gaspart.reproduction.config import open_config
from gaspart.reproduction.figure import find_parts
from gaspart.reproduction.points.point import Point
from gaspart.scene.container import Container
from gaspart.scene.facts import Gas
from gaspart.scene.scene import Scene
from gaspart.scene.species import Species
from gaspart.simulation import Simulation

if TYPE_CHECKING:
    import xarray as xr


def predict(path: str) -> list[str]:
    """Predict core-hours by experiment of a config, merged as in the workflow, on this machine, and their
    sum.
    """
    lines, total, unknown = [], 0.0, []
    with open_config(path) as (_, planned):
        for experiment, points in planned.items():
            costs = [predicted_seconds(point) for point in points.values()]
            predicted = [seconds for seconds in costs if seconds is not None]
            if len(predicted) < len(costs):
                unknown.append(experiment)
                continue
            total += sum(predicted)
            lines.append(f"{experiment:28s} {sum(predicted) / 3600.0:10.4f} core-hours")
    lines.append(f"{'all of them':28s} {total / 3600.0:10.4f} core-hours")
    if unknown:
        rule = "not predicted (other jobs, or scenes whose collisions no theory counts)"
        lines.append(f"{rule}: {', '.join(unknown)}")
    return lines


def predicted_seconds(point: Point) -> float | None:
    """Predict the CPU time of a point from the theoretical number of collisions; None if unknown."""
    if point.job != "simulate":
        return None
    gas = point.scene.gas
    if gas is None or not gas.temperature > 0.0:
        return None
    engine = point.engine
    # Where a fluid and a crystal of discs or spheres coexist, the pressure is constant. The number of
    # collisions is then nearly constant.
    densest = theory.HIGHEST_PACKING_FRACTION[gas.dimension]
    fluid = replace(gas, packing_fraction=min(gas.packing_fraction, densest))
    rate = float(theory.collision_rate(**fluid.parameters))
    contacts = 0.5 * gas.count * rate * point.schedule.duration * point.replicas
    step, fine = adviser_of(engine).timed_step(point.scene), 1.0
    table_steps = [
        table_step
        for precision, table_step in table.steps(gas.dimension, timed_as(engine))
        if precision == "float64"
    ]
    nearest = (
        step
        if not step
        else min(table_steps, key=lambda candidate: abs(math.log(candidate / step)), default=step)
    )
    # below the shortest time step in the table, the cost is proportional to the number of steps
    if step and nearest > step:
        fine = nearest / step
    each = fine * table.seconds(gas.dimension, gas.packing_fraction, timed_as(engine), "float64", nearest)
    return contacts * each * _speed(gas, timed_as(engine), "float64") if math.isfinite(each) else None


def _speed(gas: Gas, engine: str, precision: str) -> float:
    """Return the relative speed at the nearest power of ten, as timed, of the particle number."""
    return speed_factor(gas.dimension, engine, precision, 10 ** round(math.log10(max(gas.count, 10))))


# CPU time that a reproduction used, and the length of the runs that each figure needs. An uncertainty falls
# as the inverse root of the length of the runs: a claim with the uncertainty u that requires u0 needs (u /
# u0)^2 times the measured length.


_WITHOUT_CHANCE = ("identity", "family")
"""Kinds of claims that longer runs do not decide."""
_COLUMNS = ("figure", "cpu_seconds", "shared_seconds", "claim", "verdict", "required", "reached", "multiple")


@dataclass(frozen=True)
class Need:
    """Claim with its `required` and `reached` uncertainty, decided by a measurement `multiple` times
    as long.
    """

    claim: str
    verdict: str
    required: float
    reached: float
    multiple: float


@dataclass(frozen=True)
class Budget:
    """Budget of a figure.

    seconds : CPU time of the points, the numbers and the picture of the figure.
    shared : CPU time of points that other figures use as well.
    needs : claims that longer runs can decide, the most demanding first.
    """

    figure: str
    seconds: float
    shared: float
    needs: tuple[Need, ...]

    @property
    def conclusive(self) -> tuple[Need, ...]:
        """Claims that are decided."""
        return tuple(need for need in self.needs if need.multiple <= 1.0)

    @property
    def sufficient(self) -> float:
        """Factor of the run length at which all decided claims are just decided; 0 without."""
        return max((need.multiple for need in self.conclusive), default=0.0)


def budgets(path: str | Path) -> list[Budget]:
    """Return the budgets of a finished config's figures, the dearest first; SceneError if something is
    missing.
    """
    import xarray as xr

    with open_config(path) as (config, planned):
        results = Path("results") / (config.get("run") or "")
        every = shown_points(config, planned)
        rows = []
        for figure, points in every.items():
            dataset = results / "measurements" / f"{figure}.nc"
            if not dataset.is_file():
                raise SceneError("results", str(dataset), "is not there: run the workflow first")
            others = {point for other in every if other != figure for point in every[other]}
            times = {point: point_seconds(results, point) for point in points}
            rows.append(
                Budget(
                    figure,
                    sum(times.values()) + _made(results, figure),
                    sum(seconds for point, seconds in times.items() if point in others),
                    _needs(claims_of(figure, config["figures"][figure], xr.load_dataset(dataset))),
                )
            )
    return sorted(rows, key=lambda row: -row.seconds)


def lines(path: str | Path, target: str | Path | None = None, progress: bool = False) -> list[str]:
    """Return the lines of `gaspart budget` for a config: budgets, or the progress of the workflow. If
    `target` is a CSV file, the budget is written to this file, a line for each claim. Raises the same errors
    as `budgets`.
    """
    if progress:
        return _progress(path)
    rows = budgets(path)
    if target is not None:
        _write(rows, target)
        return []
    text = [f"{'figure':26s} {'CPU s':>8s} {'shared':>8s}  decided  of {'length that suffices':>22s}"]
    for row in rows:
        length = f"{row.sufficient:.2g}" if row.conclusive else ""
        counted = f"{len(row.conclusive):7d} {len(row.needs):4d}"
        text.append(f"{row.figure:26s} {row.seconds:8.1f} {row.shared:8.1f}  {counted} {length:>22s}")
        text += [f"    {need.multiple:8.2g} times: {need.claim}" for need in row.needs if need.multiple > 1.0]
    return text


def _progress(path: str | Path) -> list[str]:
    """Return a line for each figure: its points that are made and left, and the CPU time of those left. The
    time of a point is that of its experiment's other points, or the predicted one; or it is unknown.
    """
    with open_config(path) as (config, planned):
        results = Path("results") / (config.get("run") or "")
        left: dict[tuple[str, str], float] = {}
        for experiment, points in planned.items():
            times = {
                name: _used(results, point) for name, point in points.items() if Path(point.path).exists()
            }
            mean = sum(times.values()) / len(times) if times else None
            for name, point in points.items():
                if name not in times:
                    seconds = predicted_seconds(point) if mean is None else mean
                    left[experiment, name] = math.nan if seconds is None else seconds
        every = shown_points(config, planned)
    text = [f"{'figure':26s} {'points':>8s} {'left':>6s} {'CPU s left':>12s}"]
    rows = {"all": [*{point: None for points in every.values() for point in points}], **every}
    for figure, points in rows.items():
        missing = [left[point] for point in points if point in left]
        known = sum(seconds for seconds in missing if not math.isnan(seconds))
        unknown = sum(map(math.isnan, missing))
        more = f", and {unknown} points of unknown time" if unknown else ""
        text.append(f"{figure:26s} {len(points):8d} {len(missing):6d} {known:12.0f}{more}")
    return text


def _used(results: Path, point: Point) -> float:
    """Return the CPU time of the job of a point that is made; 0 if its log is gone."""
    try:
        return point_seconds(results, (point.experiment, point.name))
    except SceneError:
        return 0.0


def _write(rows: Sequence[Budget], target: str | Path) -> None:
    with whole_file(target) as partial, partial.open("w", newline="", encoding="utf-8") as file:
        table = csv.writer(file, lineterminator="\n")
        table.writerow(_COLUMNS)
        for row in rows:
            own = row.figure, f"{row.seconds:.1f}", f"{row.shared:.1f}"
            for need in row.needs:
                numbers = (f"{number:.3g}" for number in (need.required, need.reached, need.multiple))
                table.writerow((*own, need.claim, need.verdict, *numbers))


def shown_points(
    config: Mapping, planned: Mapping[str, Mapping[str, Point]]
) -> dict[str, list[tuple[str, str]]]:
    """Return the experiment and the name of each point of each figure."""
    return {
        figure: [(experiment, name) for experiment in block["experiments"] for name in planned[experiment]]
        for figure, block in config["figures"].items()
    }


def point_seconds(results: Path, point: tuple[str, str]) -> float:
    """Return the CPU time of a point's job. Raises SceneError if the point was not made."""
    for rule in ("simulate", "compute"):
        if used := job_time.read_used(results, rule, *point):
            return used.seconds
    raise SceneError("results", str(results / "logs"), f"has no time of the point {'/'.join(point)}")


def _made(results: Path, figure: str) -> float:
    """Return the CPU time of the job for numbers, verdicts and pictures of a figure."""
    used = job_time.read_used(results, "figure", figure)
    return used.seconds if used else 0.0


def claims_of(figure: str, block: Mapping, dataset: xr.Dataset) -> list[Claim]:
    """Return the claims of a figure, judged as in the workflow."""
    family, name = registry.find(figure, block)
    return list(find_parts(registry.home(family), name).claims(dataset, *registry.stated_claims(block)))


def is_decided_by_runs(claim: Claim) -> bool:
    """Return True if longer runs could decide a claim."""
    return not (claim.kind in _WITHOUT_CHANCE or claim.form == "distribution" or claim.no_verdict)


def _needs(stated: Sequence[Claim]) -> tuple[Need, ...]:
    """Return the claims of a figure that runs can decide, the most demanding first."""
    needs = []
    for claim, verdict in zip(stated, judge(stated), strict=True):
        multiple = sufficient(claim)
        if is_decided_by_runs(claim) and math.isfinite(multiple):
            needs.append(Need(claim.claim, verdict, claim.required, claim.measured.error, multiple))
    return tuple(sorted(needs, key=lambda need: -need.multiple))


# Speed of this machine relative to the machine of the table.


_LEAST, _MOST = 500, 100_000  # particles in a timed run
_GROWTH = 0.15  # growth exponent of the time per contact with N, beyond the processor cache
_CONTACTS = 2e4


@cache
def speed_factor(dimension: int, engine: str, precision: str, count: int) -> float:
    """Measure the CPU time of a contact on this machine, divided by the table's time. The reference gas of
    the engine (`timed_at`) is simulated and timed three times with `count` particles, after a short run from
    a lattice. `engine` is the engine's name in the table.
    """
    growth = max(1.0, count / _MOST) ** _GROWTH
    count = min(max(count, _LEAST), _MOST)
    timed = next(candidate for candidate in candidate_engines() if timed_as(candidate) == engine)
    fraction, step = adviser_of(timed).timed_at
    side = (count * theory.particle_volume(dimension) / fraction) ** (1.0 / dimension)
    particles = Species(count, 0.5, temperature=1.0, arrangement="lattice")
    gas = Scene(Container((side,) * dimension, boundary="periodic"), species=(particles,))
    rate = float(theory.collision_rate(fraction, dimension))
    run = Simulation(gas, adviser_of(timed).at_step(gas, step, precision), seed=1)
    run.advance(duration=1.0 / rate)
    stretch = 2.0 * max(_CONTACTS, 0.5 * count) / (count * rate)
    seconds = []
    for _ in range(3):
        before, start = run.time, time.process_time()
        run.advance(duration=stretch)
        seconds.append((time.process_time() - start) / (0.5 * count * rate * (run.time - before)))
    table_seconds = table.seconds(dimension, fraction, engine, precision, step)
    return growth * statistics.median(seconds) / table_seconds if math.isfinite(table_seconds) else math.inf
