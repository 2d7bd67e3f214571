"""Cost of accuracy: errors and costs of time stepping relative to event-driven runs.

Errors come from the job `compare`, and costs from the job `measure_cost`, for equal gases and settings. The
diffusion coefficient follows from Enskog's theory: it is kT / m divided by the rate at which a particle loses
the memory of its velocity. The memory is measured after about one collision per particle.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import xarray as xr

from gaspart import theory
from gaspart.accuracy import table
from gaspart.accuracy.option import Option, fluid_option
from gaspart.accuracy.table import PRECISIONS, REFERENCE, STEP
from gaspart.accuracy.tabulated import model_error
from gaspart.analysis import statistics
from gaspart.analysis.estimate import Estimate
from gaspart.engines.engine import Candidate
from gaspart.reproduction import table as tables
from gaspart.reproduction.families.shared.runs import pressure
from gaspart.reproduction.families.tradeoff import uniform
from gaspart.reproduction.families.tradeoff.maps import maps
from gaspart.reproduction.families.tradeoff.uniform import (
    OBSERVABLES,
    Cells,
    cells_by_fraction,
    compare_steps,
    costs,
    each_of,
    setting_name,
)
from gaspart.reproduction.points.point import Point
from gaspart.scene.gas import Gas
from gaspart.theory.bulk import EXACT

SEEN = 3.5
"""Smallest significant error, in standard errors."""
FITTED = 3
"""Minimum number of errors in a fit of their order. Two errors always have an order, even if the error
changes its sign."""


def speed_accuracy(points: list[Point], settings: dict) -> xr.Dataset:
    """Measure errors and costs over the time steps of each gas and setting.

    The points are `compare` jobs, `measure_cost` jobs of both engines, and runs of the time-stepped engine
    that are long enough for the error in the steady state. The setting is ``order_up_to``, the largest
    error in the fits of the order.

    Over (``row``, ``step``), with NaN beyond the steps of a row: ``time_step``; ``bias`` and ``bias_error``
    (also over ``observable``), relative to the exact run; ``missed`` and ``made_up``, as fractions of all
    contacts; ``energy_drift`` and ``deepest_overlap`` (worst values); ``seconds`` (CPU time per exact
    collision, with ``seconds_error``) and ``pair_tests`` (per exact collision), NaN if not timed.
    `bias_error` is computed from the scatter of snapshots; it corresponds to at least one contact.

    Over ``row``: ``dimension``, ``packing_fraction``, ``setting``, ``contacts`` (of the exact runs),
    ``event_seconds`` with its error. Over (``row``, ``observable``): ``order`` of the error in the time step,
    with ``order_error`` (NaN without `FITTED` errors of equal sign).

    Over ``steady``: gas and setting of long runs, and ``build_up`` with error. It is the relative error of
    their Z minus the error of the paired runs. Over ``timed``, all gases with timings of the event-driven
    engine: ``timed_dimension``, ``timed_packing_fraction``, ``timed_seconds`` (per collision) with its error.
    Over ``dsmc``, the models of the DSMC engine: ``dsmc_model``, ``dsmc_dimension``,
    ``dsmc_packing_fraction``, ``dsmc_seconds`` per exact collision with its error, and ``dsmc_bias``, a bound
    on the bias of Z. With the further dimension ``part``: ``dsmc_step``, each step divided by the engine's
    default step, and the time with this step, ``dsmc_step_seconds`` with its error.
    """
    timed = [costs(point) for point in points if point.job == "measure_cost"]
    rows = compare_steps(points, timed)
    rows = sorted(rows, key=lambda row: (-row["dimension"], row["packing_fraction"]))
    inner = {name: ("observable", "step")[2 - np.ndim(value) :] for name, value in rows[0].items()}
    dataset = tables.from_rows("row", rows, inner).assign_coords(observable=list(OBSERVABLES))
    orders = np.array([_orders(row, settings["order_up_to"]) for row in rows])
    dataset["order"] = (("row", "observable"), orders[..., 0])
    dataset["order_error"] = (("row", "observable"), orders[..., 1])
    long = [
        point for point in points if point.job == "simulate" and point.experiment not in settings["cells"]
    ]
    dataset = dataset.assign(tables.table("steady", long, _steady, rows))
    events = [timing for timing in timed if timing["setting"] == "event"]
    dataset = dataset.assign(tables.table("timed", events, _time_per_collision))
    cells = cells_by_fraction(points, settings["cells"])
    models = _models(events, timed, cells)
    steps = dict.fromkeys(("dsmc_step", "dsmc_step_seconds"), ("part",))
    return dataset.assign(tables.table("dsmc", models, _model, cells, inner=steps))


def time_to_accuracy(points: list[Point], settings: dict) -> xr.Dataset:
    """Measure the cost of a required accuracy, by engine.

    The first part is for all gases; see `maps`. The second part compares measured costs with the model's
    predictions, in gases that were not used to fit the model.

    The points are the same as for `speed_accuracy`. The gases outside the model's table are the experiments
    ``elsewhere`` in settings. Timings of the model's reference gas scale the table's times to this machine.
    The settings are ``counts`` of particles, ``accuracies``, and the settings of `maps`.

    Over (``gas``, ``observable``, ``count``, ``accuracy``, ``engine``): ``measured`` and ``model``, CPU time
    in s of the cheapest setting (see `gaspart.accuracy.plan`), NaN without a setting. Without ``engine``:
    ``regret``, the measured cost of the setting that the model chooses divided by the cost of the measured
    best setting, with ``regret_error`` from the timings.
    """
    of_gases = (point for point in points if point.experiment not in settings["plates_cost"])
    timed = [costs(point) for point in of_gases if point.job == "measure_cost"]
    every = compare_steps(points, timed)
    rows = compare_steps([point for point in points if point.experiment in settings["elsewhere"]], timed)
    speeds = _speeds(timed)
    gases = sorted({(row["dimension"], row["packing_fraction"]) for row in rows})
    shape = (len(gases), len(OBSERVABLES), len(settings["counts"]), len(settings["accuracies"]))
    measured, model = np.full((*shape, 2), np.nan), np.full((*shape, 2), np.nan)
    regret, error = np.full(shape, np.nan), np.full(shape, np.nan)
    for g, o, c in np.ndindex(shape[:3]):
        gas = Gas(*gases[g], settings["counts"][c], 1.0, 1.0)
        exact = [
            choice
            for choice in uniform.choices(gas, OBSERVABLES[o], timed, rows, None)
            if choice.option.engine.equation == EXACT
        ]
        steps = np.array([not choice.option.engine.reference for choice in exact])
        options = [(choice.option, _by_table(gas, choice, OBSERVABLES[o], speeds)) for choice in exact]
        for a, accuracy in enumerate(settings["accuracies"]):
            both = np.array([[option.cost(accuracy) for option in pair] for pair in options])
            for e, of in enumerate((both[~steps], both[steps])):
                if of.size:
                    measured[g, o, c, a, e], model[g, o, c, a, e] = of.min(axis=0)
            picked = int(np.argmin(both[:, 1]))
            if np.isfinite(both[picked, 1]):
                regret[g, o, c, a] = both[picked, 0] / both[:, 0].min()
                error[g, o, c, a] = exact[picked].uncertainty * regret[g, o, c, a]
    axes = ("gas", "observable", "count", "accuracy")
    return xr.Dataset(
        {
            "measured": (
                (*axes, "engine"),
                np.where(np.isfinite(measured), measured, np.nan),
                {"units": "s"},
            ),
            "model": ((*axes, "engine"), np.where(np.isfinite(model), model, np.nan), {"units": "s"}),
            "regret": (axes, regret),
            "regret_error": (axes, error),
            "gas_dimension": ("gas", [dimension for dimension, _ in gases]),
            "gas_packing_fraction": ("gas", [fraction for _, fraction in gases]),
        },
        coords={
            "observable": list(OBSERVABLES),
            "count": settings["counts"],
            "accuracy": settings["accuracies"],
            "engine": ["event", "step"],
        },
    ).merge(maps(points, settings, timed, every), join="outer", compat="no_conflicts")


def _speeds(timed: list[dict]) -> dict[tuple[str, str], float]:
    """Compute this machine's time over the table's time in the reference gas.

    The result is for each engine and precision.
    """
    speeds = {}
    for timing in timed:
        if timing["gas"] != (3, REFERENCE) or timing["setting"] not in ("event", *PRECISIONS):
            continue
        engine = "event" if timing["setting"] == "event" else "step"
        precision = PRECISIONS.get(timing["setting"], "float64")
        at = 0 if engine == "event" else int(np.argmin(np.abs(timing["time_step"] - STEP)))
        event = next(
            other for other in timed if other["gas"] == timing["gas"] and other["setting"] == "event"
        )
        here = timing["seconds"][at] / event["collisions"][0]
        speeds[engine, precision] = here / table.seconds(
            3, REFERENCE, engine, precision, STEP * (engine == "step")
        )
    return speeds


def _by_table(gas: Gas, choice: uniform.Choice, observable: str, speeds: dict) -> Option:
    """Return the option of a choice, but with errors and times from the table.

    Times are converted to this machine.
    """
    engine, row = choice.option.engine, (gas.dimension, gas.packing_fraction)
    step = engine.quantum or 0.0  # in units with v_th = sigma = 1
    each = table.seconds(*row, engine.name, engine.precision, step) * speeds[engine.name, engine.precision]
    bias = 0.0 if engine.reference else table.bias(*row, engine.precision, step, observable)
    noise = uniform.QUANTILE**2 * table.noise(*row, observable)
    return fluid_option(gas, Candidate(engine, discretisation=bias), each, noise, 1.0, discarded=0.0)


def _orders(row: dict, largest: float) -> list[tuple[float, float]]:
    """Fit the order of each observable's error in the time step, with its error.

    The error of the order is scaled by the scatter.
    """
    orders = []
    for bias, error in zip(row["bias"], row["bias_error"], strict=True):
        size = np.abs(bias)
        seen = (size > SEEN * error) & (size < largest)
        if seen.sum() < FITTED or np.unique(np.sign(bias[seen])).size > 1:
            orders.append((np.nan, np.nan))
            continue
        law = statistics.fit_power_law(row["time_step"][seen], size[seen], error[seen])
        scatter = max(1.0, law.chi_square / max(1, law.degrees_of_freedom)) ** 0.5
        orders.append((law.exponent, law.exponent_error * scatter))
    return orders


def _models(events: list[dict], timed: list[dict], cells: dict[float, Cells]) -> list[tuple[dict, dict]]:
    """Pair the timings of the event-driven engine and of a DSMC model in one gas.

    For the Enskog model, the error due to cells must have been measured, in spheres.
    """
    return [
        (event, timing)
        for event in events
        for timing in timed
        if timing["gas"] == event["gas"]
        and (timing["setting"] == "boltzmann" or (timing["setting"] == "enskog" and _cells(timing, cells)))
    ]


def _cells(timed: dict, cells: dict[float, Cells]) -> Cells | None:
    """Return the measured cells of the Enskog model in the gas of a timing, or None."""
    dimension, fraction = timed["gas"]
    return cells.get(fraction) if dimension == 3 else None


def _model(timings: tuple[dict, dict], cells: dict[float, Cells]) -> dict[str, Any]:
    """Return the cost of a DSMC model, and its error of Z.

    The cheapest step is used, because Z does not depend on the step.
    """
    event, timing = timings
    (dimension, fraction), model, own_cells = timing["gas"], timing["setting"], _cells(timing, cells)
    seconds = each_of(timing, float(event["collisions"][0]))
    cheapest = seconds[np.argmin(seconds.value)]
    of_cells = own_cells.error if own_cells and model == "enskog" else 0.0
    return {
        "dsmc_model": model,
        "dsmc_dimension": dimension,
        "dsmc_packing_fraction": fraction,
        "dsmc_seconds": (cheapest.value, cheapest.error),
        "dsmc_step": timing["step_parts"],
        "dsmc_step_seconds": (seconds.value, seconds.error),
        "dsmc_bias": model_error(fraction, dimension, model, "Z") + of_cells,
    }


def _time_per_collision(run: dict) -> dict[str, Any]:
    """Return the event-driven engine's time per collision in the gas of a timing."""
    dimension, fraction = run["gas"]
    return {
        "timed_dimension": dimension,
        "timed_packing_fraction": fraction,
        "timed_seconds": float(run["seconds"][0] / run["collisions"][0]),
        "timed_error": float(run["error"][0] / run["collisions"][0]),
    }


def _steady(point: Point, rows: list[dict]) -> dict[str, Any]:
    """Return the error of Z in a long run of the time-stepped engine.

    The error of the paired runs of the same gas is subtracted.
    """
    own = point.settings
    long, fraction, dimension = pressure(point).z, own["packing_fraction"], own["dimension"]
    name = setting_name(own.get("rewind", True), own.get("passes", 4), own.get("precision", "float64"))
    gas = (dimension, fraction, name)
    row = next(row for row in rows if (row["dimension"], row["packing_fraction"], row["setting"]) == gas)
    at = int(np.argmin(np.abs(row["time_step"] - own["time_step"])))
    paired = Estimate(row["bias"][OBSERVABLES.index("Z"), at], row["bias_error"][OBSERVABLES.index("Z"), at])
    exact = float(theory.compressibility_factor(fraction, dimension))
    exact += float(theory.finite_size_correction(fraction, dimension, point.extents[0], ensemble="canonical"))
    return {
        "steady_dimension": dimension,
        "steady_packing_fraction": fraction,
        "steady_setting": name,
        "steady_step": own["time_step"],
        "build_up": long / exact - (1.0 + paired),
    }
