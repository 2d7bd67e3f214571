"""Choices for a gas in equilibrium: its collision rate, compressibility factor Z, and D.

The event-driven engine has only a statistical error. Errors of time steps are measured; see `errors`. Errors
of the DSMC engine follow from theory. Its model does not include the contact value, the virial or the memory
of collisions. Its steps change D by a law that `dsmc_convergence` confirms. Its only measured error is the
effect of the few particles per cell on the collisions of the Enskog model.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np
import xarray as xr

from gaspart import theory
from gaspart.accuracy import table
from gaspart.accuracy.option import Option, fluid_option
from gaspart.accuracy.table import PRECISIONS
from gaspart.accuracy.tabulated import model_error
from gaspart.analysis import statistics
from gaspart.analysis.estimate import Estimate
from gaspart.analysis.expected.equilibrium import expect
from gaspart.analysis.observables import OBSERVABLES as declared
from gaspart.analysis.statistics import mean_of
from gaspart.engines import DSMC, Engine, EventDriven, TimeStepped
from gaspart.engines.engine import Candidate
from gaspart.reproduction.families.shared.runs import runs, series_of
from gaspart.reproduction.families.shared.timings import median
from gaspart.reproduction.families.tradeoff import PARTS
from gaspart.reproduction.points.point import Point
from gaspart.scene.container import Container
from gaspart.scene.gas import Gas
from gaspart.scene.scene import Scene
from gaspart.scene.species import Species
from gaspart.theory import bulk

# Errors of time-stepped settings, and costs of all engines, from `compare` and `measure_cost` jobs.


def setting_name(rewind: bool, passes: int, precision: str) -> str:
    """Return the name of a time-stepped setting in figures and claims."""
    name = f"{passes} passes" if passes > 1 else "1 pass"
    return name + ("" if rewind else ", no rewinding") + (", float32" if precision == "float32" else "")


def errors(point: Point) -> dict:
    """Return the errors of the accepted time steps of a `compare` point, the longest first."""
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
    """Compute the relative difference from the sum of the exact runs, and its error.

    The shape is (2, setting). The error is computed from the snapshots.
    """
    exact = run[f"exact_{name}"].values
    apart = run[name].values - exact
    error = apart.std(axis=1, ddof=1) * np.sqrt(apart.shape[1]) / exact.sum(axis=1)
    return np.stack([apart.sum(axis=1) / exact.sum(axis=1), np.maximum(error, least)])


def costs(point: Point) -> dict:
    """Return the costs of a `measure_cost` point, per simulated time.

    setting : "event", the name of a time-stepped setting, or the model of the DSMC engine.
    step_parts : steps of the DSMC engine divided by its default step.
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
    """Add the costs of a row's steps, if they were timed, and of the event-driven engine.

    All are for the same gas.
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


OBSERVABLES = ("collision_rate", "Z", "D")
BOUND = 2.0
"""Number of standard errors that are added to a measured error, so that it becomes a bound."""
_VISCOSITY_UNCERTAINTY = 0.05
"""Relative uncertainty of Enskog's viscosity, used to correct D for the size of the container [Yeh 2004]."""


QUANTILE = 1.96
"""Half width of a 95 % interval, in standard errors. Figures compare engines at an accuracy that 95 % of all
runs have."""


@dataclass(frozen=True)
class Choice:
    """Option of `gaspart.accuracy`, with the errors that advice does not add.

    option : option whose noise is half of a 95 % interval.
    decay : time in which the initial state's slowest trace falls to 1/e; 0 if this decay is measured.
    uncertainty : relative uncertainty of CPU times, from the timings.
    finite_size : error that remains after theory's correction for finite size, equal for all engines and
        runs.
    trace : maximum relative change of the observable by this trace, initially.
    """

    option: Option
    decay: float
    uncertainty: float
    finite_size: float = 0.0
    trace: float = 1.0

    def parts(self, accuracy: float) -> dict[str, float]:
        """Compute the relative error by `PARTS` of a run for an accuracy.

        If the accuracy is out of reach, the run is infinitely long. The trace of the initial state decays
        during the measurement. Its mean is the decay time divided by the time of the measurement, times the
        trace that remains after equilibration.
        """
        option = replace(self.option, accuracy=accuracy)
        length, remainder = option.measured, 0.0
        if self.decay and math.isfinite(length):
            remainder = self.trace * math.exp(-option.settling / self.decay) * self.decay / length
        bounds = option.candidate.model, option.candidate.discretisation
        values = *bounds, option.noise.reaches(length), remainder, self.finite_size
        return dict(zip(PARTS, values, strict=True))


def solver_of(engine: Engine) -> str:
    """Return the name of an engine among `ENGINES`."""
    return engine.name if engine.equation == bulk.EXACT else engine.equation


def choice_of(gas: Gas, observable: str, candidate: Candidate, each: Estimate, noise: float) -> Choice:
    """Return the choice of an engine for an observable of a fluid.

    each : CPU time per contact.
    noise : relative variance times contacts.
    """
    option = fluid_option(gas, candidate, each.value, QUANTILE**2 * noise, 1.0, discarded=0.0)
    decay, trace = decay_of(gas, observable)
    return Choice(option, decay, each.error / each.value, finite_size(gas, observable), trace)


def finite_size(gas: Gas, observable: str) -> float:
    """Compute the relative error that remains after theory's correction for finite size.

    This error is the square of a correction of first order in 1/N. For D it is the uncertainty of the
    viscosity, and the next order of hydrodynamics; see `displacement`.
    """
    correction = abs(getattr(bulk, f"finite_{declared[observable].bulk}")(gas)[0])
    if observable != "D":
        return float(correction**2)
    order = (2.0 * math.pi * float(theory.mean_free_path(gas.packing_fraction, 3)) / _side(gas)) ** 2
    return float(correction * min(1.0, math.hypot(_VISCOSITY_UNCERTAINTY, order)))


def decay_of(gas: Gas, observable: str) -> tuple[float, float]:
    """Return the decay time of the slowest trace of the initial state, and its initial size.

    The size is a maximum, relative to the observable. For most observables the trace is in the speeds, and
    its size is 1. For D the trace is the longest shear wave, which carries the part of D that is missing in a
    finite container.
    """
    eta = gas.packing_fraction
    speeds = 1.0 / (theory.KURTOSIS_RELAXATION_RATE[3] * float(theory.collision_rate(eta, 3)))
    viscosity = float(theory.enskog_viscosity(eta, 3) / theory.number_density(eta, 3))
    wave = (_side(gas) / (2.0 * math.pi)) ** 2 / (viscosity + float(theory.enskog_diffusion(eta, 3)))
    if observable == "D" and wave > speeds:
        return wave, -bulk.finite_diffusion(gas)[0]
    return speeds, 1.0


def _side(gas: Gas) -> float:
    """Return the side of the periodic cube."""
    return float(gas.count / theory.number_density(gas.packing_fraction, 3)) ** (1.0 / 3.0)


@dataclass(frozen=True)
class Cells:
    """Effect of the cells of the Enskog model at one packing fraction.

    rate : collision rate divided by the rate of the Enskog equation.
    bound : bound on the fraction of lost collisions, from docs/dsmc.md.
    noise : relative variance times contacts, by observable.
    """

    rate: Estimate
    bound: float
    noise: dict[str, float]

    @property
    def error(self) -> float:
        """Bound on the relative error of the collision rate, and of all results derived from it."""
        return abs(self.rate.value - 1.0) + BOUND * self.rate.error


def cells_of(point: Point) -> Cells:
    """Return the effect of cells in a run of the Enskog model, relative to its equation."""
    ((replica, expected),) = ((series_of(run), expect("collision_rate", run)) for run in runs(point))
    assert expected is not None
    rate, uncertainty = expected.value, expected.error
    contacts = 0.5 * point.scene.count * rate * replica.interval
    variances = {
        name: float(series.var(ddof=1) / series.mean() ** 2) * contacts
        for name, series in (("collision_rate", replica.rate), ("Z", replica.z))
    }
    return Cells(mean_of(replica.rate) / rate, uncertainty / rate, variances)


def cells_by_fraction(points: Iterable[Point], experiments: Sequence[str]) -> dict[float, Cells]:
    """Return the effect of cells at the points of some experiments, by packing fraction.

    The packing fraction is in the points' settings.
    """
    of = (point for point in points if point.experiment in experiments)
    return {float(point.settings["packing_fraction"]): cells_of(point) for point in of}


def choices(
    gas: Gas, observable: str, timed: list[dict], compared: list[dict], cells: Cells | None
) -> Iterator[Choice]:
    """Yield all settings of all engines that were timed in a gas of spheres.

    `cells` is the effect of cells in the Enskog model, or None if it is unknown.
    """
    same = [timing for timing in timed if timing["gas"] == (3, gas.packing_fraction)]
    event = next(timing for timing in same if timing["setting"] == "event")
    rate = float(event["collisions"][0])
    variance = table.noise(3, gas.packing_fraction, observable)
    yield choice_of(gas, observable, Candidate(EventDriven()), each_of(event, rate)[0], variance)
    at = OBSERVABLES.index(observable)
    for row in compared:
        if (row["dimension"], row["packing_fraction"]) != (3, gas.packing_fraction):
            continue
        if row["setting"] not in PRECISIONS:
            continue
        bound = np.abs(row["bias"][at]) + BOUND * row["bias_error"][at]
        seconds = Estimate(row["seconds"], row["seconds_error"])
        for n in np.flatnonzero(np.isfinite(bound) & np.isfinite(seconds.value)):
            engine = TimeStepped(float(row["time_step"][n]), precision=PRECISIONS[row["setting"]])
            candidate = Candidate(engine, discretisation=float(bound[n]))
            yield choice_of(gas, observable, candidate, seconds[n], variance)
    for timing in same:
        model = timing["setting"]
        if model not in ("boltzmann", "enskog") or (model == "enskog" and cells is None):
            continue
        error = model_error(gas.packing_fraction, 3, model, observable)
        of_cells = cells.error if cells and model == "enskog" else 0.0
        own = cells.noise.get(observable, variance) if cells and model == "enskog" else variance
        if model == "boltzmann" and observable == "Z":
            own = 0.0  # it is 1 in any case
        for step, each in zip(timing["time_step"], each_of(timing, rate), strict=True):
            engine = DSMC(float(step), model=model)
            steps = _error_of_steps(engine, gas) if observable == "D" else 0.0
            yield choice_of(gas, observable, Candidate(engine, error, steps + of_cells), each, own)


def _error_of_steps(engine: DSMC, gas: Gas) -> float:
    """Return the relative error of D due to time steps alone, as the engine estimates it."""
    species = Species(gas.count, 0.5 * gas.diameter, temperature=gas.temperature)
    scene = Scene(Container((_side(gas),) * 3, boundary="periodic"), species=(species,))
    return engine.errors(scene).path


def each_of(timed: dict, rate: float) -> Estimate:
    """Compute the CPU time per contact with each time step of a timing, (T,).

    `rate` is the number of contacts per simulated time.
    """
    return Estimate(timed["seconds"], timed["error"]) / rate


def compare_steps(points: list[Point], timed: list[dict]) -> list[dict]:
    """Return the errors of time steps with their costs; see `errors` and `add_costs`."""
    rows = [errors(point) for point in points if point.job == "compare"]
    for row in rows:
        add_costs(row, timed)
    return rows
