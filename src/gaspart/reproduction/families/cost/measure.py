"""Measurements of the cost of features, and of the gain from several cores.

The first part measures the relative cost of each feature of a scene, and of absent features.

Each job times the scene with and without the feature alternately, A B B A, so that disturbances of the
machine affect both. Several jobs of one feature differ in their equilibration. Their scatter is the
uncertainty.

The second part measures the gain from several cores, by threads of one run and by equal simultaneous runs.

Each job times these alternately with one run on one core, in wall-clock time. Simultaneous runs wait for
nothing except a core. Their waiting time is therefore the time that other programs used. For p cores, p times
the fraction of waiting time is part of the uncertainty of each speed.
"""

from __future__ import annotations

import math
from itertools import compress

import numpy as np
import xarray as xr
from scipy.optimize import nnls

from gaspart.analysis.estimate import Estimate
from gaspart.reproduction.families.shared.timings import (
    SLABS,
    SYSTEMATIC,
    log_ratios,
    median,
    per_event,
    ratio_of_jobs,
    weights,
)
from gaspart.reproduction.points.point import Point
from gaspart.reproduction.table import Table, merge_with_prefixes, table
from gaspart.scene.scene import Scene

PLAIN = "plain"
FEATURES = {"gravity": "gravity", "roughness": "spin"}
"""Features in `scene.features` that are timed, and their names in the figure."""
WORK = ("pair_tests", "box_visits", "crossings")


def price_of_features(points: list[Point], settings: dict) -> xr.Dataset:
    """Measure absolute and relative costs per event (collision or wall hit).

    Relative costs are divided by the costs of the scene without the feature, timed in the same job.

    Variables over point (a feature with an engine):

    engine : name of the engine
    feature : feature that the other scene does not have
    seconds : time per event
    ratio : time divided by the time of the other scene in the same jobs, with error and degrees of freedom
    pair_tests, box_visits, crossings : counts per event

    The error of the ratio is the scatter of the jobs. A plain scene compared with itself has the ratio 1. If
    a point counts instructions, there are variables over kernel: the name of the engine, `instructions`, and
    `stripped`. The last variable is the number of instructions of a kernel whose source does not have the
    features.
    """
    groups: dict[tuple, list[dict]] = {}
    for job in (_job(point) for point in points if point.job == "measure_cost"):
        groups.setdefault((job["engine"], job["feature"]), []).append(job)
    dataset = table("point", list(groups.values()), _row)
    for point in points:
        if point.job == "count_instructions":
            dataset = dataset.merge(
                xr.load_dataset(point.path).rename(engine="kernel"), join="outer", compat="no_conflicts"
            )
    return dataset


def _row(jobs: list[dict]) -> dict:
    """Return the row of several jobs of a feature; errors of a single job are NaN."""
    return {
        "engine": jobs[0]["engine"],
        "feature": jobs[0]["feature"],
        **{name: float(np.mean([job[name] for job in jobs])) for name in ("seconds", *WORK)},
        "ratio": ratio_of_jobs([job["log_ratio"] for job in jobs]),
    }


def _job(point: Point) -> dict:
    """Return the costs per event of one job, and its log ratio of times.

    The log ratio is ln of the time per event divided by the time without the feature, both timed in
    succession. It is averaged over the repeats.
    """
    with xr.open_dataset(point.path) as run:
        costs = per_event(run)
        engine, extras = run.attrs["engine"], run.attrs["extras"].split()
        log_ratio = float(log_ratios(run, costs["events"].values)[0])
    own = costs.isel(partition=0)
    return {
        "engine": engine,
        "feature": _feature(point.scene, extras),
        "log_ratio": log_ratio,
        **{name: float(own[name]) for name in ("seconds", *WORK)},
    }


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


ENGINES = {"event": "event-driven", "step": "time-stepped", "dsmc": "DSMC"}
"""Names of engines in the figure."""
_KNOWN = 0.15  # speeds are fitted only if their relative uncertainty is smaller


def cores(points: list[Point], settings: dict) -> xr.Dataset:
    """Measure the speed-up by several cores, and fit a model of the speed-up by threads.

    Variables over run:

    engine, packing_fraction, count : engine and gas, with `count` particles
    copies : number of simultaneous runs; 1 for threads
    cores : number of cores in use
    speed : work per time, divided by the speed of one run on one core; NaN if the machine has too few cores
    same : 1 if all bits equal the bits on one core

    Variables over model, for each gas and engine with threads, are engine, packing_fraction, and `serial` and
    `overhead` of `speed_up`. The attribute `cores` is the number of cores of the machine. The attribute
    `waiting` is the fraction of time for which simultaneous runs waited for a core; NaN if no such runs were
    timed.
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
    threads = threads[threads.copies == 1]
    gases = [gas for _, same in threads.by("engine") for _, gas in same.by("packing_fraction")]
    models = table("model", gases, _model, units={"overhead": "particles"})
    return merge_with_prefixes(run=runs, model=models).assign_attrs(cores=available, waiting=waiting)


def _cores_job(point: Point) -> dict:
    """Return the row of one job, with its uncertainty from its repeats.

    The uncertainty includes disturbances of entire runs.
    """
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


def _model(gas: Table) -> dict:
    """Fit the speed-ups for all numbers of particles and cores (except `SLABS`).

    The model is 1 / speed - 1 / p = s (1 - 1 / p) + N_0 / N for p cores and N particles. Both parameters s
    and N_0 are bounded by 0. A parameter at this bound has the uncertainty 0. The result is NaN if fewer than
    two speeds are known.
    """
    engine = gas.engine[0]
    used = gas.speed.error < _KNOWN * gas.speed.value  # excluded if there is none: NaN
    if engine in SLABS:
        used &= (gas.count >= SLABS[engine]) & (gas.cores == 2)
    timed = gas[used]
    coefficients = {"serial": Estimate(math.nan, math.nan), "overhead": Estimate(math.nan, math.nan)}
    if len(timed) > 1:
        parts = np.stack([1.0 - 1.0 / timed.cores, 1.0 / timed.count], axis=1)
        lost = 1.0 / timed.speed - 1.0 / timed.cores
        costly = nnls(parts / lost.error[:, None], lost.value / lost.error)[0] > 0.0
        coefficients = dict.fromkeys(coefficients, Estimate(0.0))
        if costly.any():
            fit = weights(lost, *parts[:, costly].T)
            values = map(Estimate, fit.values, fit.errors)
            coefficients |= dict(zip(compress(coefficients, costly), values, strict=True))
    return {"engine": engine, "packing_fraction": gas.packing_fraction[0], **coefficients}
