"""Cheapest engine for each observable, density and accuracy, with all parts of the error."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
import xarray as xr

from gaspart import theory
from gaspart.accuracy.estimates import Component
from gaspart.accuracy.option import Option
from gaspart.accuracy.table import PRECISIONS
from gaspart.analysis.estimate import Estimate
from gaspart.analysis.statistics import mean_of
from gaspart.engines.engine import AccuracyRequest, Candidate
from gaspart.reproduction.families.heat.gap import Gap, averages
from gaspart.reproduction.families.shared.runs import kurtosis, runs
from gaspart.reproduction.families.tradeoff import ENGINES, FREE_TIMES, PARTS, uniform
from gaspart.reproduction.families.tradeoff.uniform import BOUND, QUANTILE, Choice, costs, solver_of
from gaspart.reproduction.points.point import Point
from gaspart.reproduction.table import entries
from gaspart.scene.gas import Gas
from gaspart.theory.bulk import EXACT
from gaspart.theory.conditions import even_conditions

# Choices for two gases out of equilibrium: heat flux between plates, relaxation of speeds. There is no exact
# theory in a dense gas. Therefore each engine is run. The error is bounded by the difference from the
# event-driven engine plus two standard errors, or by a theoretical bound if this is lower, as in a dilute
# gas. The number of particles is about the number for which costs are stated.


FLOWS = ("heat_flux", "relaxation")
SETTLED = 5.0
"""Decay times of the slowest temperature wave between plates, before the flux is measured."""


@dataclass(frozen=True)
class Flow:
    """Measurement by one engine.

    candidate : the engine, with its bounds on the errors of model and discretisation.
    count : number of particles.
    value : flux, or relaxation time divided by the mean free time.
    variance : relative variance times the simulated time.
    contacts : contacts per time.
    decay : time in which the slowest trace of the initial state falls to 1/e; 0 if this decay itself is
    measured.
    shortest : minimum simulated time.
    """

    observable: str
    packing_fraction: float
    candidate: Candidate
    count: int
    value: Estimate
    variance: float
    contacts: float
    decay: float
    shortest: float

    @property
    def engine(self) -> str:
        """Name of the engine among `ENGINES`."""
        return solver_of(self.candidate.engine)


def flux_of(point: Point, blocks: int) -> Flow:
    """Measure the heat flux between plates, averaged over both plates and over blocks.

    Each run has `blocks` of them. The slowest wave between the plates is a temperature wave. Its decay time
    is (gap / pi)^2 n c_p / kappa, with c_p = 5/2 k_B and Enskog's kappa at the mean temperature.
    """
    scene, gap = point.scene, Gap.of(point.scene)
    flux = averages(point, gap, blocks, 1).flux()
    length = point.schedule.samples * point.schedule.sample_interval
    contacts = sum(int(np.diff(run.data["collisions"].values[[0, -1]])[0]) for run in runs(point))
    density = scene.count / (gap.length * gap.area)
    warm = 0.5 * (gap.hot + gap.cold)
    conductivity = float(theory.enskog_conductivity(scene.packing_fraction, 3, temperature=warm))
    decay = (gap.length / math.pi) ** 2 * 2.5 * density / conductivity
    return Flow(
        observable="heat_flux",
        packing_fraction=fraction_of(point),
        candidate=_candidate(point),
        count=point.scene.count,
        value=flux,
        variance=(flux.error / flux.value) ** 2 * length,
        contacts=contacts / length,
        decay=decay,
        shortest=decay,
    )


def relaxation_of(point: Point) -> Flow:
    """Return the time in which equal speeds relax to Maxwell's, in mean free times.

    The time is the integral of (K_end - K) / (K_end - 1) up to `FREE_TIMES`. Here K is the kurtosis, averaged
    over replicas. In a uniform gas, steps and cells of the DSMC engine affect only positions, if all
    particles are in one cell.
    """
    values, contacts, rate = [], 0, float(theory.collision_rate(point.scene.packing_fraction, 3))
    for run in runs(point, first=0):
        speeds = np.sqrt((run.data["velocities"].values.astype(float) ** 2).sum(axis=2))
        end = theory.kurtosis(3, run.count)
        remainder = (end - kurtosis(speeds)) / (end - 1.0)
        free_times = (run.time - run.time[0]) * rate
        fine = np.linspace(0.0, FREE_TIMES, 1 + round(FREE_TIMES / 0.01))
        values.append(float(np.trapezoid(np.interp(fine, free_times, remainder), fine)))
        contacts += int(run.data["collisions"].values[-1])
    value = mean_of(values)
    length = FREE_TIMES / rate
    candidate = _candidate(point)
    if candidate.engine.equation != EXACT:
        candidate = replace(candidate, discretisation=0.0)
    return Flow(
        observable="relaxation",
        packing_fraction=fraction_of(point),
        candidate=candidate,
        count=point.scene.count,
        value=value,
        variance=(value.error / value.value) ** 2 * len(values) * length,
        contacts=contacts / (len(values) * (run.time[-1] - run.time[0])),
        decay=0.0,
        shortest=length,
    )


def fraction_of(point: Point) -> float:
    """Compute the packing fraction, rounded to two digits."""
    return float(f"{point.scene.packing_fraction:.2g}")


def _candidate(point: Point) -> Candidate:
    """Return the engine of a point, with its bounds on the errors of a flux."""
    scene, engine = point.scene, point.engine.for_scene(point.scene, point.schedule.sample_interval)
    if engine.equation == EXACT:
        return Candidate(engine, discretisation=engine.bias(scene, "fluxes"))
    return engine.candidate(AccuracyRequest("heat_flux", 1.0, even_conditions(scene, 1.0), transported=True))


def flow_choices(flows: Sequence[Flow], count: int, speeds: Mapping[str, Estimate]) -> Iterator[Choice]:
    """Yield the choices for the engines that measured one observable of one gas.

    count : number of particles for which costs are stated.
    speeds : CPU time per simulated time by engine, for the particle number of the runs.
    """
    event = next(flow for flow in flows if flow.engine == "event")
    # The fluctuations obey one equation, so all runs together determine their variance.
    pooled = float(np.mean([flow.variance for flow in flows]))
    for flow in flows:
        if flow.engine not in speeds:
            continue
        seconds = speeds[flow.engine].value
        model, discretisation = errors_of(flow, event)
        candidate = Candidate(flow.candidate.engine, model, discretisation)
        noise = Component(
            1.0, 1.0, flow.shortest, QUANTILE**2 * pooled * flow.count / count, freedom=math.inf
        )
        settling = SETTLED * flow.decay
        limits = flow.shortest + settling, math.inf, settling, 0.0
        option = Option(candidate, candidate.bias, noise, seconds * count / flow.count, 1.0, *limits)
        yield Choice(option, flow.decay, speeds[flow.engine].error / seconds)


def errors_of(flow: Flow, event: Flow) -> tuple[float, float]:
    """Return bounds on the errors of model and discretisation.

    The theoretical bounds are used, unless the measured difference from the event-driven engine gives a
    smaller bound.
    """
    bounds = flow.candidate
    if bounds.engine.reference:
        return 0.0, 0.0
    ratio = flow.value / event.value
    seen = abs(ratio.value - 1.0) + BOUND * ratio.error
    discretisation = min(bounds.discretisation, seen)
    return min(bounds.model, seen - discretisation), discretisation


QUANTITIES = (*uniform.OBSERVABLES, *FLOWS)


def maps(points: Sequence[Point], settings: dict, timed: list[dict], compared: list[dict]) -> xr.Dataset:
    """Compute the costs of all engines in spheres of every timed density.

    The points belong to the experiments `cells`, `plates`, `plates_cost` and `relaxation` in settings, and
    others. `timed` and `compared` are explained in `uniform`. Further settings are ``counts`` of particles
    (the map uses the first), ``accuracies``, and ``blocks`` of each run between plates.

    Over (``quantity``, ``fraction``, ``accuracy``, ``solver``): ``cost`` in s of the cheapest setting, with
    its uncertainty from the timings. It is infinite if no setting is known to be as accurate, and NaN if the
    engine was not run. With the further dimension ``part``: ``error``, relative, of `PARTS`. ``model`` and
    ``discretisation`` are bounds from theory, or from runs if there is no theory. ``finite_size`` is the
    remainder after theory's correction. ``equilibration`` is a bound on the trace of the initial state.
    ``noise`` is 1.96 standard errors.

    Over (``flow_quantity``, ``fraction``, ``solver``): ``flow``, the heat flux, or the relaxation time over
    the mean free time, with its error; and ``flow_bound``, a theoretical bound on its relative difference
    from hard spheres. Over (``fraction``, ``solver``): ``each``, CPU time in s per contact of the exact gas,
    with the cheapest step, and its error. Over ``fraction``: ``cells``, the collision rate of the Enskog
    model in its default cells divided by the rate of its equation, with its error; and ``cells_bound`` on the
    difference.
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
            gas = Gas(3, eta, count, 1.0, 1.0)
            choices = list(uniform.choices(gas, QUANTITIES[q], timed, compared, cells.get(eta)))
        else:
            of = [
                flow for flow in measured if (flow.observable, flow.packing_fraction) == (QUANTITIES[q], eta)
            ]
            speeds = between.get(eta, {}) if QUANTITIES[q] == "heat_flux" else _speeds_of(timed, of)
            choices = list(flow_choices(of, count, speeds)) if of else []
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
        of = [choice for choice in choices if solver_of(choice.option.engine) == engine]
        for a, accuracy in enumerate(accuracies if of else ()):
            # the least biased choice, if no choice reaches the accuracy
            best = min(of, key=lambda choice: (choice.option.cost(accuracy), choice.option.bias))
            costs[a, e] = best.option.cost(accuracy) * np.array([1.0, best.uncertainty])
            parts[a, e] = list(best.parts(accuracy).values())


def _flows(points: Sequence[Point], settings: dict) -> list[Flow]:
    """Return all measured flows."""
    plates = [point for point in points if point.experiment in settings["plates"]]
    relaxing = [point for point in points if point.experiment in settings["relaxation"]]
    return [
        *(flux_of(point, settings["blocks"]) for point in plates),
        *(relaxation_of(point) for point in relaxing),
    ]


def _speeds_between(points: Sequence[Point], experiments: Sequence[str]) -> dict[float, dict[str, Estimate]]:
    """Compute the CPU time per simulated time between plates, by packing fraction and engine."""
    speeds: dict[float, dict[str, Estimate]] = {}
    for point in points:
        if point.experiment in experiments:
            (seconds,) = uniform.each_of(costs(point), 1.0)
            speeds.setdefault(fraction_of(point), {})[solver_of(point.engine)] = seconds
    return speeds


def _speeds_of(timed: list[dict], of: list[Flow]) -> dict[str, Estimate]:
    """Return the speeds of flows in a uniform gas, from timings with other particle numbers.

    The step nearest to the flow's step is used.
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
            step = flow.candidate.engine.quantum
            at = int(np.argmin(np.abs(np.log(steps / step)))) if step else 0
            speeds[flow.engine] = uniform.each_of(same[flow.engine], rate)[at] * contacts
    return speeds


def _solver(setting: str) -> str:
    """Return the engine of a timed setting.

    Non-default settings of the time-stepped engine keep their names.
    """
    return "step" if PRECISIONS.get(setting) == "float64" else setting


def _compare_flows(measured: list[Flow], fractions: list[float]) -> xr.Dataset:
    """Return the measurements of each engine, and theoretical bounds on its error."""
    names = ("flow", "flow_error", "flow_freedom", "flow_bound")
    array = np.full((len(names), len(FLOWS), len(fractions), len(ENGINES)), np.nan)
    for flow in measured:
        at = FLOWS.index(flow.observable), fractions.index(flow.packing_fraction)
        numbers = flow.value.value, flow.value.error, flow.value.freedom, flow.candidate.bias
        array[:, *at, ENGINES.index(flow.engine)] = numbers
    axes = ("flow_quantity", "fraction", "solver")
    columns = {name: (axes, values, {"units": "1"}) for name, values in zip(names, array, strict=True)}
    return xr.Dataset(columns, coords={"flow_quantity": list(FLOWS)})


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
