"""Made-up comparisons and timings of the engines, with known orders of convergence and costs."""

import numpy as np
import xarray as xr

from gaspart import theory
from gaspart.reproduction.families.tradeoff import choices, maps
from gaspart.reproduction.families.tradeoff import measure as tradeoff
from gaspart.reproduction.families.tradeoff.choices import ENGINES, PARTS
from gaspart.reproduction.families.tradeoff.maps import QUANTITIES
from gaspart.reproduction.points.point import Point

STEPS = np.array([0.32, 0.16, 0.08, 0.04])
SETTINGS = {"order_up_to": 0.2, "accuracies": [0.01, 0.001, 0.0001], "cells": []}
FRACTIONS = (0.0001, 0.001, 0.01, 0.1, 0.3)
SNAPSHOTS, CONTACTS, Z, SECONDS = 6, 1e5, 1.5, 1e-6


def comparison(rate_order, z_order, refuse_longest, **attributes):
    """What `compare` gives if errors of the rate are 2/3 dt^2 or alike, and those of Z of another order."""
    rng = np.random.default_rng(3)
    shape = (STEPS.size, SNAPSHOTS)
    noise = 2e-6 * rng.standard_normal((2, *shape))
    step = STEPS[:, None]
    exact = np.full(shape, CONTACTS)
    values = {
        "exact_collisions": exact,
        "collisions": exact * (1.0 - 2.0 / 3.0 * step**rate_order + noise[0]),
        "exact_virial": exact,
        "virial": exact * (1.0 - step**z_order + noise[1]),
        "exact_z": np.full(shape, Z),
        "exact_memory": np.full(shape, 0.5),
        "memory": 0.5 ** (1.0 / (1.0 + 0.1 * step**2 + noise[0])),
        "energy_drift": np.zeros(shape),
        "deepest_overlap": np.minimum(1.0, 3.0 * step) + np.zeros(shape),
        "pair_tests": 10.0 * exact,
        "missed": 0.01 * exact,
        "made_up": np.zeros(shape),
        "listed": exact,
    }
    refused = np.zeros(STEPS.size, dtype=int)
    refused[0] = refuse_longest
    return xr.Dataset(
        {name: (("setting", "snapshot"), value) for name, value in values.items()},
        attrs={"dimension": 3, "packing_fraction": 0.01, "precision": "float64", "rewind": 1, "passes": 4}
        | attributes,
    ).assign(time_step=("setting", STEPS), steps=("setting", [8] * 4), refused=("setting", refused))


def timing(engine, seconds, **attributes):
    """What `measure_cost` gives of `CONTACTS` contacts, if each setting needs so many seconds for them."""
    n = len(seconds)
    steps = np.round(16.0 / STEPS[:n]).astype(int) if engine == "step" else np.zeros(n, dtype=int)
    ones = np.ones(n)
    return xr.Dataset(
        {
            "seconds": (("partition", "repeat"), np.outer(seconds, [0.98, 1.0, 1.02])),
            "collisions": ("partition", CONTACTS * ones),
            "duration": ("partition", 16.0 * ones),
            "steps": ("partition", steps),
            "pair_tests": ("partition", 5.0 * CONTACTS * ones),
        },
        attrs={"dimension": 3, "packing_fraction": 0.01, "engine": engine} | attributes,
    )


def speed_accuracy_measurement(folder):
    """What `measure.speed_accuracy` makes of two settings of a dilute gas, and of both models of DSMC; of
    discs that of Boltzmann."""
    made = [
        ("compare", {"passes": 4}, comparison(2.0, 3.0, 0)),
        ("compare", {"passes": 1, "rewind": False}, comparison(1.0, 1.0, 1, rewind=0, passes=1)),
        ("measure_cost", {"passes": 4}, timing("step", 2.0 * SECONDS * CONTACTS * (1.0 + 0.01 / STEPS))),
        ("measure_cost", {"engine": "event"}, timing("event", [SECONDS * CONTACTS])),
    ]
    return tradeoff.speed_accuracy(written(folder, made), SETTINGS).assign(
        dsmc_model=("dsmc", ["boltzmann", "enskog", "boltzmann"]),
        dsmc_dimension=("dsmc", [3, 3, 2]),
        dsmc_packing_fraction=("dsmc", [0.01, 0.01, 0.01]),
        dsmc_seconds=("dsmc", [1e-7, 9e-7, 2e-7]),
        dsmc_seconds_error=("dsmc", [1e-9, 1e-8, 1e-9]),
        dsmc_bias=("dsmc", [0.04, 0.002, 0.02]),
    )


def written(folder, made):
    """Points of (job, settings, dataset), with their results in a folder."""
    points = []
    for n, (job, settings, dataset) in enumerate(made):
        points.append(Point("gas", f"n={n}", job, settings, str(folder), 1))
        (folder / "gas").mkdir(exist_ok=True)
        dataset.to_netcdf(points[-1].path)
    return points


def time_to_accuracy_measurement(more_expensive=1.0):
    """What `measure.time_to_accuracy` gives if the model is right but for a factor of the steps' cost."""
    accuracy = np.array([0.1, 0.01, 0.001, 0.0001])
    axes = ("gas", "observable", "count", "accuracy")
    shape = (2, 3, 2, 4)
    event = 1.0 / accuracy**2 + np.zeros(shape)
    step = 0.5 / accuracy**2 * (1.0 + 0.005 / accuracy) + np.zeros(shape)
    measured = np.stack([event, step], axis=-1)
    model = np.stack([event, more_expensive * step], axis=-1)
    picked = np.where(model[..., 0] < model[..., 1], event, step)
    return xr.Dataset(
        {
            "measured": ((*axes, "engine"), measured),
            "model": ((*axes, "engine"), model),
            "regret": (axes, picked / measured.min(axis=-1)),
            "regret_error": (axes, np.full(shape, 0.02)),
            "gas_dimension": ("gas", [3, 3]),
            "gas_packing_fraction": ("gas", [0.05, 0.2]),
        },
        coords={
            "observable": list(tradeoff.OBSERVABLES),
            "count": [1000, 10000],
            "accuracy": accuracy,
            "engine": ["event", "step"],
        },
    ).merge(map_measurement(accuracy))


def map_measurement(accuracy):
    """What `maps.maps` gives of engines whose errors are those of theory, or half of their bounds."""
    each = {
        "event": [2e-5, 5e-6, 1.3e-6, 5e-7, 3e-7],
        "step": [4e-5, 1e-5, 2e-6, 7e-7, 4e-7],
        "boltzmann": [2e-7, 1.5e-7, 1e-7, 1e-7, 1e-7],
        "enskog": [1e-6] * 5,
    }
    bias = np.array([[0.0] * 5, [1e-4] * 5, [3e-4, 3e-3, 3e-2, 0.3, 1.0], [2e-3, 2e-3, 2e-3, 0.05, 0.25]])
    seconds = np.array([each[name] for name in ENGINES])
    room = accuracy[:, None] - bias.T[:, None, :]  # fraction, accuracy, solver
    with np.errstate(divide="ignore"):
        cost = np.where(room > 0.0, seconds.T[:, None, :] * (1.0 / room**2 + 1e4), np.inf)
    error = np.stack(
        [np.broadcast_to(bias.T[:, None, :], cost.shape), *[np.full(cost.shape, 1e-4)] * 4], axis=-1
    )
    every = np.ones((5, 1, 1, 1))
    bound = np.full((2, 5, 4), np.nan)
    bound[:, :, 1:] = np.array([0.03, 0.04, 0.05])
    slow = [choices.relaxation_time(float(theory.contact_value(eta, 3))) for eta in FRACTIONS]
    relaxing = np.full((5, 4), choices.relaxation_time(1.0))
    relaxing[:, 2] = slow
    bound[1, :, 2] = 0.5
    flow = np.stack([np.full((5, 4), 2.0) * np.array([1.0, 0.99, 1.02, 1.03]), relaxing])
    axes = ("quantity", "fraction", "accuracy", "solver")
    flow_axes = ("flow_quantity", "fraction", "solver")
    return xr.Dataset(
        {
            "cost": (axes, every * cost),
            "cost_error": (axes, 0.01 * every * cost),
            "error": ((*axes, "part"), every[..., None] * error),
            "flow": (flow_axes, flow),
            "flow_error": (flow_axes, 0.003 * flow),
            "flow_freedom": (flow_axes, np.full((2, 5, 4), 20.0)),
            "flow_bound": (flow_axes, bound),
            "each": (("fraction", "solver"), seconds.T),
            "each_error": (("fraction", "solver"), 0.01 * seconds.T),
            "cells": ("fraction", [1.0, 1.0, 1.0, 0.999, 0.997]),
            "cells_error": ("fraction", np.full(5, 4e-4)),
            "cells_freedom": ("fraction", np.full(5, 99.0)),
            "cells_bound": ("fraction", np.full(5, 0.004)),
        },
        coords={
            "quantity": list(QUANTITIES),
            "fraction": list(FRACTIONS),
            "solver": list(ENGINES),
            "part": list(PARTS),
            "flow_quantity": list(maps.FLOWS),
        },
    )
