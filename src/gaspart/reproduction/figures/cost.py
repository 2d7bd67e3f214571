"""Cost of the features of a scene, and gain from several cores.

Each job times two runs alternately, A B B A, so that disturbances of the machine affect both.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from itertools import compress
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike

from gaspart.analysis.estimate import Estimate
from gaspart.rendering import style
from gaspart.rendering.style import Axes, Figure
from gaspart.reproduction.claims import Claim
from gaspart.reproduction.figure import Parts
from gaspart.reproduction.figures._timings import (
    SYSTEMATIC,
    log_ratios,
    median,
    per_event,
    ratio_of_jobs,
    weights,
)
from gaspart.reproduction.points.point import Point
from gaspart.reproduction.table import Row, Table, merge_with_prefixes, table
from gaspart.scene.scene import Scene

TITLE, CHAPTER = "Cost of features, gain by cores", "Speed and accuracy"

# The price of features: a scene is timed with a feature and without it. Several jobs of one feature differ in
# their equilibration; their scatter is the uncertainty.

PLAIN = "plain"
FEATURES = {"gravity": "gravity", "roughness": "spin"}  # of `scene.features`, with their names in the figure
COUNTED = ("pair_tests", "box_visits", "crossings")
LARGEST_RATIO = 1.25  # allowed time with a feature over the time without it: the speed is then 0.8
REORDERED = 1e-3  # fraction of all instructions, since the compiler may order some of them differently


def measure_price(points: list[Point], settings: dict) -> xr.Dataset:
    """Measure costs per event (collision or wall hit), and ratios to the scene without the feature. Points
    that count instructions add those of each engine's kernel, and of a kernel whose source does not have the
    features (`stripped`).
    """
    groups: dict[tuple, list[dict]] = {}
    for job in (_price_job(point) for point in points if point.job == "measure_cost"):
        groups.setdefault((job["engine"], job["feature"]), []).append(job)
    counted = [xr.load_dataset(point.path) for point in points if point.job == "count_instructions"]
    kernels = [run.rename(engine="kernel") for run in counted]
    return xr.merge(
        [table("point", list(groups.values()), price_row), *kernels], join="outer", compat="no_conflicts"
    )


def price_row(jobs: list[dict]) -> dict:
    """Return the row of several jobs of a feature; errors of a single job are NaN."""
    means = {name: float(np.mean([job[name] for job in jobs])) for name in ("seconds", *COUNTED)}
    ratio = ratio_of_jobs([job["log_ratio"] for job in jobs])
    return {"engine": jobs[0]["engine"], "feature": jobs[0]["feature"], **means, "ratio": ratio}


def _price_job(point: Point) -> dict:
    with xr.open_dataset(point.path) as run:
        costs = per_event(run)
        engine, extras = run.attrs["engine"], run.attrs["extras"].split()
        log_ratio = float(log_ratios(run, costs["events"].values)[0])
    own = {name: float(costs[name][0]) for name in ("seconds", *COUNTED)}
    return {"engine": engine, "feature": _feature(point.scene, extras), "log_ratio": log_ratio, **own}


def _feature(scene: Scene, extras: list[str]) -> str:
    """Return the feature that distinguishes a scene from a plain periodic gas of equal spheres."""
    has = {
        "recording": "record_events" in extras,
        "stress": "stress" in extras,
        **{name: feature in scene.features for feature, name in FEATURES.items()},
        "walls": bool(scene.container.walls),
        "two masses": len({kind.mass for kind in scene.species}) > 1,
    }
    return next((name for name, present in has.items() if present), PLAIN)


def claim_price(dataset: xr.Dataset) -> Iterator[Claim]:
    """Yield the claims that absent features leave no code behind, and that present ones cost little."""
    kernels, timed = Table(dataset, "kernel"), Table(dataset, "point")
    for kernel in kernels:
        yield Claim.within(
            f"absent features: instructions of the {kernel.kernel} engine's kernel over those of one whose "
            "source never had them", Estimate(kernel.instructions / kernel.stripped), 1.0, REORDERED,
            "branches on None vanish when a kernel is compiled (counted)",
            "an absent feature leaves code behind",
        )  # fmt: skip
    for plain in timed[timed.feature == PLAIN]:
        yield Claim(
            "time per event of the plain scene over that of itself beside it, "
            f"{plain.engine} engine", plain.ratio, 1.0, 0.05, "the same work, timed in turn",
            "what disturbs the machine favours one of two scenes, or the uncertainty is too small",
        )  # fmt: skip
    for row in timed[timed.feature != PLAIN]:
        yield Claim.at_most(
            f"time per event with {row.feature} over that without, {row.engine} engine",
            row.ratio, LARGEST_RATIO, 0.1, "at least 0.8 of the speed without (this project's aim)",
            "a feature slows the engine down",
        )  # fmt: skip


def draw_price(dataset: xr.Dataset) -> Figure:
    """Draw relative time and counted operations per event, for each feature."""
    figure, (times, counts) = style.new((2.9,), (2.9,))
    timed = Table(dataset, "point")
    positions = {name: -k for k, name in enumerate(dict.fromkeys(timed.feature))}
    times.axvline(1.0, color=style.GREY, linewidth=0.6, zorder=1)
    times.axvspan(0.0, LARGEST_RATIO, color=style.GREY, alpha=0.18, linewidth=0, zorder=0)
    for kind, (engine, costs) in enumerate(timed.by("engine")):
        rows = np.array([positions[name] for name in costs.feature]) + 0.12 * (0.5 - kind)
        plain = costs[costs.feature == PLAIN].seconds[0]
        style.points(times, costs.ratio, rows, kind=kind, label=f"{engine}: plain {1e6 * plain:.3g} µs")
        for hollow, name in enumerate(("pair_tests", "crossings")):
            label = f"{engine}: {name.replace('_', ' ')}"
            if getattr(costs, name).any():
                style.points(counts, getattr(costs, name), rows, kind=kind, hollow=bool(hollow), label=label)
    for axis in (times, counts):
        axis.set_yticks(list(positions.values()), positions)
        axis.set_ylim(-len(positions) + 0.4, 1.6)
        axis.tick_params(axis="y", which="both", length=0)
        axis.legend(loc="upper right", ncols=2 if axis is counts else 1)
    most = (timed.ratio.value + timed.ratio.error).max()
    style.label_axes(times, "time per event / without the feature", xlim=(0.0, max(1.6, 1.1 * most)))
    style.label_axes(counts, "counted work per event", xscale="log")
    style.letters(times, counts)
    return figure


# Several cores, by threads of one run and by equal simultaneous runs (`copies`). Wall-clock time is compared
# with one run on one core. Simultaneous runs wait for nothing except a core: their waiting time is the time
# that other programs used. For p cores, p times its share is part of the uncertainty of each speed.

ENGINES = {"event": "event-driven", "step": "time-stepped", "dsmc": "DSMC"}
KNOWN = 0.15  # largest relative uncertainty of speeds that are fitted
SLABS = {"DSMC, Enskog": 8**3 * 64}
"""Engines whose threads share collisions by slabs of cells, with the smallest number of particles for this.
From this number on, each of two threads has a slab at any time (docs/dsmc.md). With fewer particles,
collisions are not shared. More threads share them unevenly, which Amdahl's law does not describe."""


def speed_up(cores: ArrayLike, count: ArrayLike, serial: float, overhead: float) -> np.ndarray:
    """Compute the speed-up by threads for N particles (Amdahl, AFIPS Conf. Proc. 30, 483 (1967)). `serial` is
    the fraction of the work that runs on one core. `overhead` is the number of particles whose work on one
    core takes as long as starting and joining threads.
    """
    shared, waited = (1.0 - serial) / np.asarray(cores), overhead / np.asarray(count)
    return np.asarray(1.0 / (serial + shared + waited))


def measure_cores(points: list[Point], settings: dict) -> xr.Dataset:
    """Measure speeds relative to one run on one core, and fit `speed_up` to each gas and engine with threads.
    `same` is 1 if all bits equal the bits on one core. A speed is NaN if the machine has too few cores.
    """
    jobs = [_cores_job(point) for point in points]
    waits = [job.pop("waiting") for job in jobs]
    available = max(job.pop("available") for job in jobs)
    waiting = float(np.mean([wait for wait in waits if math.isfinite(wait)] or [math.nan]))
    for job in jobs:
        own = job["speed"]
        job["speed"] = Estimate(own.value, math.hypot(own.error, job["cores"] * waiting))
    runs = table("run", jobs, dict, units={})
    threads = Table(runs, "run")
    gases = [gas for *_, gas in threads[threads.copies == 1].by("engine", "packing_fraction")]
    models = table("model", gases, fit_speed_up, units={"overhead": "particles"})
    return merge_with_prefixes(run=runs, model=models).assign_attrs(cores=available, waiting=waiting)


def _cores_job(point: Point) -> dict:
    copies = point.settings.get("copies", 1)
    with xr.open_dataset(point.path) as run:
        own, alone = np.log(run.wall_seconds.values)
        gain, error = median(math.log(copies) + alone - own)
        used = int(run.cores[0])
        busy = np.median(run.seconds.values[0] / (used * run.wall_seconds.values[0]))
        model = f", {run.attrs['model'].capitalize()}" if run.attrs["model"] else ""
        return {
            "engine": ENGINES[run.attrs["engine"]] + model,
            "packing_fraction": round(run.packing_fraction, 9),  # one number for gases of all sizes
            "count": int(run.attrs["count"]),
            "copies": copies,
            "cores": used,
            "speed": Estimate(math.exp(gain), math.exp(gain) * math.hypot(error, SYSTEMATIC)),
            "same": int(len(set(run.bits.values.tolist())) == 1),
            "waiting": max(0.0, 1.0 - busy) if copies > 1 and math.isfinite(busy) else math.nan,
            "available": int(run.attrs["cores"]),
        }


def fit_speed_up(gas: Table) -> dict:
    """Fit the speed-ups for all numbers of particles and cores (except `SLABS`). The model is linear in its
    parameters: 1 / speed - 1 / p = s (1 - 1 / p) + N_0 / N. A parameter at its bound 0 has the uncertainty 0.
    The result is NaN if fewer than two speeds are known.
    """
    from scipy.optimize import nnls

    engine = gas.engine[0]
    used = gas.speed.error < KNOWN * gas.speed.value  # excluded if there is none: NaN
    if engine in SLABS:
        used &= (gas.count >= SLABS[engine]) & (gas.cores == 2)
    timed = gas[used]
    fitted = {"serial": Estimate(math.nan, math.nan), "overhead": Estimate(math.nan, math.nan)}
    if len(timed) > 1:
        parts = np.stack([1.0 - 1.0 / timed.cores, 1.0 / timed.count], axis=1)
        lost = 1.0 / timed.speed - 1.0 / timed.cores
        costly = nnls(parts / lost.error[:, None], lost.value / lost.error)[0] > 0.0
        fitted = dict.fromkeys(fitted, Estimate(0.0))
        if costly.any():
            fit = weights(lost, *parts[:, costly].T)
            values = map(Estimate, fit.values, fit.errors)
            fitted |= dict(zip(compress(fitted, costly), values, strict=True))
    return {"engine": engine, "packing_fraction": gas.packing_fraction[0], **fitted}


LARGE = 10**5  # number of particles from which threads must be faster; the largest gas of each kind claims it
SMALL = 10**4  # largest number of particles for which two simultaneous runs do not compete for the caches
IDLE = "the uncertainty has what other programs took of the cores, for which runs at once waited"


def claim_cores(dataset: xr.Dataset) -> Iterator[Claim]:
    """Yield the claims that threads change no bit, and that two cores are faster."""
    runs = Table.from_prefixed(dataset, "run")
    for engine, own in runs.by("engine"):
        yield Claim(
            f"runs on several cores that differ from one core in any bit, {engine}, of {len(own)}",
            Estimate(float((own.same == 0).sum())), 0.0, 0.0,
            "digests of positions, velocities and sums over collisions at the end (exact)",
            "the order of collisions or of sums depends on threads",
        )  # fmt: skip
    two = runs[runs.cores == 2]
    where = "{engine}, {count} spheres at {packing_fraction:g}"
    for *_, gases in two[(two.copies == 1) & (two.count >= LARGE)].by("engine", "packing_fraction"):
        gas = gases.sorted_by("count")[-1]
        yield Claim.at_least(
            f"speed with two threads over one, {where.format_map(gas)}", gas.speed, 1.7, 0.1,
            f"at least 1.7 on two idle cores (this project's aim); {IDLE}",
            "too much of the work is done by one thread, or threads wait for one another",
        )  # fmt: skip
    for gas in two[(two.copies == 2) & (two.count <= SMALL) & (two.engine == "event-driven")]:
        yield Claim.at_least(
            f"speed of two runs at once over one, {where.format_map(gas)}", gas.speed, 1.85, 0.1,
            f"at least 1.85 on two idle cores (this project's aim); {IDLE}",
            "kernels hold a lock, or write to memory that they share",
        )  # fmt: skip


MOST = 8  # largest number of cores for which the model is drawn


def draw_cores(dataset: xr.Dataset) -> Figure:
    """Draw speed on two cores against the number of particles by engine, and against the number of cores."""
    figure, axes = style.new((2.6,), (2.6,), (2.6,), (2.6,))
    runs, models = Table.from_prefixed(dataset, "run"), Table.from_prefixed(dataset, "model")
    fractions = sorted(set(runs.packing_fraction.tolist()))
    two = runs[runs.cores == 2]
    for axis, name in zip(axes, ("DSMC", "time-stepped", "event-driven"), strict=False):
        own = two[[str(engine).startswith(name) for engine in two.engine]]
        _by_count(axis, own.sorted_by("count"), models, fractions)
        highest = np.nanmax([2.36, *own.speed.value])
        axis.set(xscale="log", xlim=(0.6 * runs.count.min(), 1.6 * runs.count.max()))
        axis.set_ylim(0.0, 1.1 * highest)
        style.label_axes(axis, "number of particles $N$", f"{name}: speed-up", legend="lower right")
    _by_cores(axes[-1], runs, models, dataset.cores)
    style.letters(*axes)
    return figure


def _by_count(axis: Axes, runs: Table, models: Table, fractions: list[float]) -> None:
    """Draw the runs of an engine and the model, coloured by packing fraction."""
    named: set[str] = set()  # each label occurs once in the legend

    def once(label: str) -> str:
        new = label not in named
        named.add(label)
        return label if new else ""

    for engine, fraction, copies, gas in runs.by("engine", "packing_fraction", "copies"):
        kind = fractions.index(fraction)
        label = ", ".join([*engine.split(", ")[1:], f"$\\eta={fraction:g}$"])
        if copies > 1:
            label = "two runs at once" if engine != "event-driven" else f"{label}, two runs"
        style.points(axis, gas.count, gas.speed, kind=kind, hollow=copies > 1, label=once(label))
        if copies == 1:
            count = np.geomspace(max(gas.count.min(), SLABS.get(engine, 0)), gas.count.max(), 100)
            speed = _model_speed(models, gas[0], 2.0, count)
            if np.isfinite(speed).all():
                axis.plot(count, speed, color=style.COLOURS[kind], linewidth=0.8, label=once("model"))
    style.level(axis, 1.0)
    style.level(axis, 2.0, linestyle="--")
    if not np.isfinite(runs.speed.value).any():
        axis.text(0.5, 0.6, "fewer than two cores: not timed", transform=axis.transAxes, ha="center")


def _by_cores(axis: Axes, runs: Table, models: Table, available: int) -> None:
    """Draw the gases that run on the most cores, and the model, dotted beyond the machine's cores."""
    fine = np.linspace(1.0, MOST, 100)
    axis.plot(fine, fine, "--", color=style.GREY, linewidth=0.6, label="ideal")
    for kind, widest in enumerate(runs[runs.cores == runs.cores.max()].sorted_by("copies")):
        at_once = widest.copies > 1
        columns = ("engine", "packing_fraction", "count")
        alike = [getattr(runs, name) == widest[name] for name in columns]
        gas = runs[np.all([*alike, (runs.copies > 1) == at_once], axis=0)]
        label = f"{widest.engine}, {'runs at once' if at_once else 'threads'}"
        style.points(axis, gas.cores, gas.speed, kind=kind, hollow=at_once, label=label)
        if not at_once and widest.engine not in SLABS:
            for part, dashes in ((fine <= available, "-"), (fine >= available, ":")):
                speed = _model_speed(models, widest, fine[part], widest.count)
                axis.plot(fine[part], speed, dashes, color=style.COLOURS[kind], linewidth=0.8)
    cores = f"cores (dotted: beyond the {available} of this machine)"
    limits: dict[str, Any] = {"xlim": (0.8, MOST + 0.2), "ylim": (0.0, MOST + 0.5)}
    style.label_axes(axis, cores, "speed-up", legend="upper left", **limits)


def _model_speed(models: Table, run: Row, cores: float | np.ndarray, count: float | np.ndarray) -> np.ndarray:
    """Compute the model's speed for the gas and engine of a run."""
    same = (models.engine == run.engine) & (models.packing_fraction == run.packing_fraction)
    model = models[same][0]
    return speed_up(cores, count, model.serial.value, model.overhead.value)


FIGURES = {
    "price_of_features": Parts({}, measure_price, claim_price, draw_price),
    "cores": Parts({}, measure_cores, claim_cores, draw_cores),
}
