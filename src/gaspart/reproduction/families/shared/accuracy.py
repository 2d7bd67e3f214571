"""Errors of time-stepped settings, and costs of all engines, from `compare` and `measure_cost` jobs."""

from __future__ import annotations

import numpy as np
import xarray as xr

from gaspart.analysis import statistics
from gaspart.reproduction.families.shared.timings import median
from gaspart.reproduction.points.point import Point


def setting_name(rewind: bool, passes: int, precision: str) -> str:
    """Return the name of a setting of the time-stepped engine in figures and claims."""
    name = f"{passes} passes" if passes > 1 else "1 pass"
    return name + ("" if rewind else ", no rewinding") + (", float32" if precision == "float32" else "")


def errors(point: Point) -> dict:
    """Return the errors over the accepted time steps of a `compare` point, the longest first."""
    run = xr.load_dataset(point.path)
    run = run.isel(setting=np.flatnonzero(run.refused == 0)).sortby("time_step", ascending=False)
    contacts = run.exact_collisions.sum("snapshot").values
    z = run.exact_z.mean("snapshot").values
    rate = _difference(run, "collisions", 1.0 / contacts)
    share = (z - 1.0) / z
    pressure_bias = _difference(run, "virial", 1.0 / contacts) * share
    memory = [
        statistics.jackknife(lambda own, exact: exact / own - 1.0, np.log(own), np.log(exact))
        for own, exact in zip(run.memory.values, run.exact_memory.values, strict=True)
    ]
    memory = np.array(
        [
            [float(value), max(float(error), 1.0 / n)]
            for (value, error), n in zip(memory, contacts, strict=True)
        ]
    )
    both = np.stack([rate, pressure_bias, memory.T])
    listed = run.listed.sum("snapshot", skipna=False).values
    return {
        "dimension": run.attrs["dimension"],
        "packing_fraction": round(run.attrs["packing_fraction"], 12),
        "setting": setting_name(bool(run.attrs["rewind"]), run.attrs["passes"], run.attrs["precision"]),
        "contacts": int(contacts.max()),
        "time_step": run.time_step.values,
        "bias": both[:, 0],
        "bias_error": both[:, 1],
        "missed": run.missed.sum("snapshot", skipna=False).values / listed,
        "made_up": run.made_up.sum("snapshot", skipna=False).values / listed,
        "energy_drift": np.abs(run.energy_drift).max("snapshot").values,
        "deepest_overlap": run.deepest_overlap.max("snapshot").values,
        "pair_tests": run.pair_tests.sum("snapshot").values / contacts,
    }


def _difference(run: xr.Dataset, name: str, least: np.ndarray) -> np.ndarray:
    """Compute the relative difference from the exact runs' sum, and its error.

    The shape is (2, setting); the error is from the snapshots.
    """
    exact = run[f"exact_{name}"].values
    apart = run[name].values - exact
    error = apart.std(axis=1, ddof=1) * np.sqrt(apart.shape[1]) / exact.sum(axis=1)
    return np.stack([apart.sum(axis=1) / exact.sum(axis=1), np.maximum(error, least)])


def costs(point: Point) -> dict:
    """Return the costs of a `measure_cost` point, per time simulated.

    setting : "event", the name of the time-stepped engine's, or the model of the DSMC engine.
    step_parts : steps of the latter, in its own.
    """
    run = xr.load_dataset(point.path)
    seconds, error = median(run.seconds.values)
    own = point.settings
    name = run.attrs["engine"]
    if name == "step":
        name = setting_name(own.get("rewind", True), own.get("passes", 4), own.get("precision", "float64"))
    elif name == "dsmc":
        name = own.get("model", "boltzmann")
    return {
        "gas": (run.attrs["dimension"], round(run.attrs["packing_fraction"], 12)),
        "setting": name,
        "time_step": (run.duration / np.maximum(run.steps, 1)).values,
        "step_parts": np.array(own.get("scan_step_parts", [])),
        "seconds": seconds / run.duration.values,
        "error": error / run.duration.values,
        "collisions": (run.collisions / run.duration).values,
        "pair_tests": (run.pair_tests / run.duration).values,
    }


def add_costs(row: dict, timed: list[dict]) -> None:
    """Add the costs of a row's steps, where they were timed, and of the event-driven engine.

    The latter are in the same gas.
    """
    same = [timing for timing in timed if timing["gas"] == (row["dimension"], row["packing_fraction"])]
    event = next(timing for timing in same if timing["setting"] == "event")
    rate = float(event["collisions"][0])
    row["event_seconds"], row["event_error"] = (
        float(event["seconds"][0]) / rate,
        float(event["error"][0]) / rate,
    )
    row["seconds"], row["seconds_error"] = (np.full(len(row["time_step"]), np.nan) for _ in range(2))
    row["pair_tests"] = row["seconds"].copy()
    for timing in same:
        if timing["setting"] == row["setting"]:
            for n, step in enumerate(row["time_step"]):
                at = np.flatnonzero(np.isclose(timing["time_step"], step))
                if at.size:
                    row["seconds"][n] = timing["seconds"][at[0]] / rate
                    row["seconds_error"][n] = timing["error"][at[0]] / rate
                    row["pair_tests"][n] = timing["pair_tests"][at[0]] / rate
