"""Errors of engines in two gases out of equilibrium: heat flux between plates, relaxation of speeds.

There is no exact theory in a dense gas. Therefore each engine is run. The error is bounded by the difference
from the event-driven engine plus two standard errors, or by a theoretical bound if this is lower, as in a
dilute gas. The number of particles is about the number for which costs are stated.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
import xarray as xr

from gaspart import theory
from gaspart.accuracy.advisers import adviser_of
from gaspart.accuracy.estimates import Component
from gaspart.accuracy.of_engine import AccuracyRequest, Candidate
from gaspart.accuracy.option import Option
from gaspart.analysis.estimate import Estimate
from gaspart.analysis.statistics import mean_of
from gaspart.reproduction.claims import Claim
from gaspart.reproduction.figure import kurtosis, runs
from gaspart.reproduction.figures._gap import Gap, averages
from gaspart.reproduction.figures._tradeoff import (
    BOUND,
    ENGINES,
    QUANTILE,
    Choice,
    Timings,
    by_engine,
    solver_of,
)
from gaspart.reproduction.points.point import Point
from gaspart.reproduction.table import Table
from gaspart.theory.bulk import EXACT
from gaspart.theory.conditions import even_conditions

FLOWS = ("heat_flux", "relaxation")
SETTLED = 5.0  # decay times of the slowest temperature wave between plates, before the flux is measured
FREE_TIMES = 2.5  # duration of the relaxation of speeds over which it is integrated, in mean free times


@dataclass(frozen=True)
class Flow:
    """Measurement by one engine.

    candidate : the engine, with its bounds on the errors of model and discretisation.
    count : number of particles.
    value : flux, or relaxation time divided by the mean free time.
    variance : relative variance times the simulated time.
    contacts : contacts per time.
    decay : time in which the slowest trace of the initial state falls to 1/e; 0 if this is measured.
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
    """Measure the heat flux between plates, averaged over both plates and the blocks of each run. The slowest
    wave between the plates is a temperature wave. Its decay time is (gap / pi)^2 n c_p / kappa, with c_p =
    5/2 k_B and Enskog's kappa at the mean temperature.
    """
    scene, gap = point.scene, Gap.of(point.scene)
    flux = averages(point, gap, blocks, 1).flux()
    length = point.schedule.samples * point.schedule.sample_interval
    contacts = sum(int(np.diff(run.data["collisions"].values[[0, -1]])[0]) for run in runs(point))
    density, warm = scene.count / (gap.length * gap.area), 0.5 * (gap.hot + gap.cold)
    conductivity = float(theory.enskog_conductivity(scene.packing_fraction, 3, temperature=warm))
    decay = (gap.length / math.pi) ** 2 * 2.5 * density / conductivity
    return _flow(point, "heat_flux", flux, (flux.error / flux.value) ** 2 * length, contacts / length, decay)


def relaxation_of(point: Point) -> Flow:
    """Return the time in which equal speeds relax to Maxwell's, in mean free times. The time is the integral
    of (K_end - K) / (K_end - 1) up to `FREE_TIMES`. Here K is the kurtosis, averaged over replicas.
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
    value, length = mean_of(values), FREE_TIMES / rate
    variance = (value.error / value.value) ** 2 * len(values) * length
    per_time = contacts / (len(values) * (run.time[-1] - run.time[0]))
    flow = _flow(point, "relaxation", value, variance, per_time, 0.0)
    candidate = flow.candidate
    if candidate.engine.equation != EXACT:  # steps and cells affect only positions, all in one cell
        candidate = replace(candidate, discretisation=0.0)
    return replace(flow, candidate=candidate, shortest=length)


def _flow(
    point: Point, observable: str, value: Estimate, variance: float, contacts: float, decay: float
) -> Flow:
    scene, engine = point.scene, point.engine.for_scene(point.scene, point.schedule.sample_interval)
    if engine.equation == EXACT:
        candidate = Candidate(engine, discretisation=engine.bias(scene, "fluxes"))
    else:
        request = AccuracyRequest("heat_flux", 1.0, even_conditions(scene, 1.0), transported=True)
        candidate = adviser_of(engine).candidate(request)
    numbers = value, variance, contacts, decay, decay
    return Flow(observable, fraction_of(point), candidate, scene.count, *numbers)


def fraction_of(point: Point) -> float:
    """Compute the packing fraction, rounded to two digits."""
    return float(f"{point.scene.packing_fraction:.2g}")


def speeds_of(timed: Timings, of: Sequence[Flow]) -> dict[str, Estimate]:
    """Return CPU time per simulated time of flows, by engine, from timings of other numbers at the nearest
    step.
    """
    gas = 3, of[0].packing_fraction
    same = {timing.solver: timing for timing in timed.of(*gas)}
    contacts = next(flow.contacts for flow in of if flow.engine == "event")
    speeds = {}
    for flow in of:
        if flow.engine in same:
            step, steps = flow.candidate.engine.quantum, same[flow.engine].time_step
            at = int(np.argmin(np.abs(np.log(steps / step)))) if step else 0
            each = same[flow.engine].seconds / timed.event(*gas).contacts
            speeds[flow.engine] = each[at] * contacts
    return speeds


def flow_choices(flows: Sequence[Flow], count: int, speeds: Mapping[str, Estimate]) -> Iterator[Choice]:
    """Yield the choices for the engines that measured one observable of one gas. `count` is the number of
    particles for which costs are stated. `speeds` has the CPU time per simulated time by engine, for the
    particle number of the runs.
    """
    event = next(flow for flow in flows if flow.engine == "event")
    # The fluctuations obey one equation, so all runs together determine their variance.
    pooled = float(np.mean([flow.variance for flow in flows]))
    for flow in flows:
        if flow.engine not in speeds:
            continue
        seconds, settling = speeds[flow.engine].value, SETTLED * flow.decay
        candidate = Candidate(flow.candidate.engine, *errors_of(flow, event))
        variance = QUANTILE**2 * pooled * flow.count / count
        noise = Component(1.0, 1.0, flow.shortest, variance, freedom=math.inf)
        limits = flow.shortest + settling, math.inf, settling, 0.0
        option = Option(candidate, candidate.bias, noise, seconds * count / flow.count, 1.0, *limits)
        yield Choice(option, flow.decay, speeds[flow.engine].error / seconds)


def errors_of(flow: Flow, event: Flow) -> tuple[float, float]:
    """Return bounds on errors of model and discretisation, theoretical or smaller measured ones."""
    bounds = flow.candidate
    if bounds.engine.reference:
        return 0.0, 0.0
    ratio = flow.value / event.value
    seen = abs(ratio.value - 1.0) + BOUND * ratio.error
    discretisation = min(bounds.discretisation, seen)
    return min(bounds.model, seen - discretisation), discretisation


def compare_flows(flows: list[Flow], fractions: list[float]) -> xr.Dataset:
    """Return the measurements of each engine, and theoretical bounds on the difference from spheres."""
    array = np.full((4, len(FLOWS), len(fractions), len(ENGINES)), np.nan)
    for flow in flows:
        at = FLOWS.index(flow.observable), fractions.index(flow.packing_fraction)
        numbers = flow.value.value, flow.value.error, flow.value.freedom, flow.candidate.bias
        array[:, *at, ENGINES.index(flow.engine)] = numbers
    axes = ("flow_quantity", "fraction", "solver")
    columns = ("flow", "flow_error", "flow_freedom", "flow_bound")
    return xr.Dataset(
        {name: (axes, values, {"units": "1"}) for name, values in zip(columns, array, strict=True)},
        coords={"flow_quantity": list(FLOWS)},
    )


TESTED = 0.02  # smallest bound that runs of a few seconds can test
FLOW_NAMES = {"heat_flux": "heat flux between plates", "relaxation": "relaxation time of speeds"}
SOLVERS = {"step": "time steps", "boltzmann": "the Boltzmann model", "enskog": "the Enskog model"}


def claim_flows(dataset: xr.Dataset) -> Iterator[Claim]:
    """Yield the claims that flows are within the bounds of `gaspart advise`, and relax as Enskog states."""
    for quantity in dataset.flow_quantity.values:
        for at in Table(dataset.sel(flow_quantity=quantity), "fraction"):
            flow, bounds = by_engine(at, "flow"), by_engine(at, "flow_bound")
            for solver, name in SOLVERS.items():
                if TESTED <= bounds[solver] < 1.0:
                    yield Claim.within(
                        f"{FLOW_NAMES[quantity]} by {name} over that by events, packing fraction "
                        f"{at.fraction:g}", flow[solver] / flow["event"], 1.0, bounds[solver],
                        "gaspart.accuracy.option: excluded volume, memory, cells, steps",
                        "a bound leaves out what makes an error",
                    )  # fmt: skip
    for at in Table(dataset.sel(flow_quantity="relaxation"), "fraction"):
        flow, eta = by_engine(at, "flow"), at.fraction
        if eta < 0.05 or not np.isfinite(flow["boltzmann"].value + flow["enskog"].value):
            continue
        exact, later = (relaxation_time(factor) for factor in (1.0, float(theory.contact_value(eta, 3))))
        yield Claim(
            "relaxation time of speeds by the Boltzmann model over that by the Enskog model, "
            f"packing fraction {eta:g}", flow["boltzmann"] / flow["enskog"], later / exact, 0.01,
            "Enskog's equation of a uniform gas is Boltzmann's with the contact value as a factor",
            "few in a cell meet again and again; a wrong contact value", alternative=1.0,
        )  # fmt: skip


def relaxation_time(slower: float) -> float:
    """Compute the relaxation time of a gas with collisions rarer by a factor. The speeds of this gas follow
    the homogeneous Boltzmann equation.
    """
    times = np.linspace(0.0, FREE_TIMES / slower, 251)
    curve, end = theory.relaxation(3), theory.kurtosis(3)
    remainder = (end - curve.kurtosis(curve.collisions(times))) / (end - 1.0)
    return float(np.trapezoid(remainder, times) * slower)
