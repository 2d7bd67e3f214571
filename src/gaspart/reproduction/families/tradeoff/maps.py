"""Cheapest engine for each observable, density and accuracy, with the parts of every error."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import xarray as xr

from gaspart.accuracy.table import PRECISIONS
from gaspart.analysis.estimate import Estimate
from gaspart.reproduction.families.shared.accuracy import costs
from gaspart.reproduction.families.tradeoff import flows, uniform
from gaspart.reproduction.families.tradeoff.choices import ENGINES, PARTS, Choice, cheapest
from gaspart.reproduction.points.point import Point
from gaspart.reproduction.table import entries

QUANTITIES = (*uniform.OBSERVABLES, *flows.FLOWS)


def maps(points: Sequence[Point], settings: dict, timed: list[dict], compared: list[dict]) -> xr.Dataset:
    """Compute the costs of all engines in spheres of every timed density.

    The points are of the experiments `cells`, `plates`, `plates_cost` and `relaxation` in settings, and
    others; `timed` and `compared` are explained in `uniform`. The settings are also ``counts`` of particles,
    of which the first is the map's, ``accuracies``, ``blocks`` of each run between plates.

    Over (``quantity``, ``fraction``, ``accuracy``, ``solver``): ``cost`` in s of the cheapest setting, with
    its uncertainty from the timings, infinite if none is known to be as accurate and NaN where the engine was
    not run. Over these and ``part``: ``error``, relative, of `PARTS`: ``model`` and ``discretisation`` bounds
    from theory, or from runs where theory has none, ``finite_size`` the remainder after theory's correction,
    ``equilibration`` a bound on the trace of the initial state, ``noise`` 1.96 standard errors.

    Over (``flow_quantity``, ``fraction``, ``solver``): ``flow``, the heat flux, or the relaxation time over
    the mean free time, with its error, and ``flow_bound`` of theory on its relative difference from hard
    spheres. Over (``fraction``, ``solver``): ``each``, CPU time in s per contact of the exact gas, with the
    cheapest step, and its error. Over ``fraction``: ``cells``, the collision rate of the Enskog model in its
    default cells over the rate of its equation, with its error and ``cells_bound`` on the difference.
    """
    fractions = sorted({timing["gas"][1] for timing in timed if timing["gas"][0] == 3})
    cells = uniform.cells_by_fraction(points, settings["cells"])
    measured, between = _flows(points, settings), _speeds_between(points, settings["plates_cost"])
    count, accuracies = settings["counts"][0], settings["accuracies"]
    shape = (len(QUANTITIES), len(fractions), len(accuracies), len(ENGINES))
    results = np.full((*shape, 2), np.nan), np.full((*shape, len(PARTS)), np.nan)
    for q, f in np.ndindex(shape[:2]):
        eta = fractions[f]
        if QUANTITIES[q] in uniform.OBSERVABLES:
            gas = uniform.Uniform(eta, count)
            choices = list(uniform.choices(gas, QUANTITIES[q], timed, compared, cells.get(eta)))
        else:
            of = [
                flow for flow in measured if (flow.observable, flow.packing_fraction) == (QUANTITIES[q], eta)
            ]
            speeds = between.get(eta, {}) if QUANTITIES[q] == "heat_flux" else _speeds_of(timed, of)
            choices = list(flows.choices(of, count, speeds)) if of else []
        _enter(results[0][q, f], results[1][q, f], choices, accuracies)
    axes = ("quantity", "fraction", "accuracy", "solver")
    dataset = xr.Dataset(
        {
            "cost": (axes, results[0][..., 0], {"units": "s"}),
            "cost_error": (axes, results[0][..., 1], {"units": "s"}),
            "error": ((*axes, "part"), results[1], {"units": "1"}),
        },
        coords={
            "quantity": list(QUANTITIES),
            "fraction": fractions,
            "accuracy": accuracies,
            "solver": list(ENGINES),
            "part": list(PARTS),
        },
    )
    parts = dataset, _compare_flows(measured, fractions), _speeds(timed, cells, fractions)
    return xr.merge(parts, join="outer", compat="no_conflicts")


def _enter(costs: np.ndarray, parts: np.ndarray, choices: list[Choice], accuracies: Sequence[float]) -> None:
    """Enter the cheapest choice of each engine into the arrays of one quantity and density.

    The arrays are costs (A, E, 2) with errors, and parts (A, E, `PARTS`).
    """
    for e, engine in enumerate(ENGINES):
        of = [choice for choice in choices if choice.engine == engine]
        for a, accuracy in enumerate(accuracies if of else ()):
            best = cheapest(of, accuracy)
            costs[a, e] = best.cost(accuracy) * np.array([1.0, best.uncertainty])
            parts[a, e] = list(best.parts(accuracy).values())


def _flows(points: Sequence[Point], settings: dict) -> list[flows.Flow]:
    """Return all flows that were measured."""
    plates = [point for point in points if point.experiment in settings["plates"]]
    relaxing = [point for point in points if point.experiment in settings["relaxation"]]
    return [
        *(flows.flux_of(point, settings["blocks"]) for point in plates),
        *(flows.relaxation_of(point) for point in relaxing),
    ]


def _speeds_between(points: Sequence[Point], experiments: Sequence[str]) -> dict[float, dict[str, Estimate]]:
    """Compute the CPU time per time of simulation between plates, by packing fraction and engine."""
    speeds: dict[float, dict[str, Estimate]] = {}
    for point in points:
        if point.experiment in experiments:
            (seconds,) = uniform.each_of(costs(point), 1.0)
            speeds.setdefault(flows.fraction_of(point), {})[flows.engine_of(point)] = seconds
    return speeds


def _speeds_of(timed: list[dict], of: list[flows.Flow]) -> dict[str, Estimate]:
    """Return the speeds of flows in a uniform gas, from the timings of other particles.

    The step is the one nearest to theirs.
    """
    if not of:
        return {}
    same = {
        _solver(timing["setting"]): timing for timing in timed if timing["gas"] == (3, of[0].packing_fraction)
    }
    rate = float(same["event"]["collisions"][0])
    contacts = next(flow.contacts for flow in of if flow.engine == "event")
    speeds = {}
    for flow in of:
        if flow.engine in same:
            steps = same[flow.engine]["time_step"]
            at = int(np.argmin(np.abs(np.log(steps / flow.time_step)))) if flow.time_step else 0
            speeds[flow.engine] = uniform.each_of(same[flow.engine], rate)[at] * contacts
    return speeds


def _solver(setting: str) -> str:
    """Return the engine of a timed setting.

    Other settings of the time-stepped engine than the default keep their names.
    """
    return "step" if PRECISIONS.get(setting) == "float64" else setting


def _compare_flows(measured: list[flows.Flow], fractions: list[float]) -> xr.Dataset:
    """Return the measurements of each engine, and theory's bounds on its error."""
    names = ("flow", "flow_error", "flow_freedom", "flow_bound")
    array = np.full((len(names), len(flows.FLOWS), len(fractions), len(ENGINES)), np.nan)
    for flow in measured:
        at = flows.FLOWS.index(flow.observable), fractions.index(flow.packing_fraction)
        numbers = flow.value.value, flow.value.error, flow.value.freedom, sum(flow.bounds)
        array[:, *at, ENGINES.index(flow.engine)] = numbers
    axes = ("flow_quantity", "fraction", "solver")
    columns = {name: (axes, values, {"units": "1"}) for name, values in zip(names, array, strict=True)}
    return xr.Dataset(columns, coords={"flow_quantity": list(flows.FLOWS)})


def _speeds(timed: list[dict], cells: dict[float, uniform.Cells], fractions: list[float]) -> xr.Dataset:
    """Return the CPU time per contact, and the collision rate in cells."""
    each = np.full((2, len(fractions), len(ENGINES)), np.nan)
    by_fraction = [cells.get(eta) for eta in fractions]
    rates = [cell.rate if cell else Estimate(np.nan, np.nan, np.nan) for cell in by_fraction]
    for f, eta in enumerate(fractions):
        same = {_solver(timing["setting"]): timing for timing in timed if timing["gas"] == (3, eta)}
        rate = float(same["event"]["collisions"][0])
        for e, engine in enumerate(ENGINES):
            if engine in same:
                seconds = uniform.each_of(same[engine], rate)
                best = seconds[np.argmin(seconds.value)]
                each[:, f, e] = best.value, best.error
    columns = entries({"cells": Estimate.stack(rates)})
    columns["cells_bound"] = np.array([cell.bound if cell else np.nan for cell in by_fraction])
    return xr.Dataset(
        {name: ("fraction", values, {"units": "1"}) for name, values in columns.items()}
        | {
            name: (("fraction", "solver"), values, {"units": "s"})
            for name, values in zip(("each", "each_error"), each, strict=True)
        }
    )
