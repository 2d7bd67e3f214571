"""Errors and costs of every engine in a gas in equilibrium: its collision rate, Z, and D.

Errors of time steps come from the job `compare`, costs from `measure_cost`, for equal gases and settings. The
event-driven engine has only a statistical error. Errors of the DSMC engine follow from theory: its model does
not include the contact value, the virial or the memory of collisions, and its steps change D by a law that
`dsmc_convergence` confirms. Its only measured error is the effect of the few particles per cell on the
collisions of the Enskog model.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import xarray as xr

from gaspart import theory
from gaspart.accuracy import table
from gaspart.accuracy.of_engine import Candidate
from gaspart.accuracy.option import Option, fluid_option
from gaspart.accuracy.table import PRECISIONS
from gaspart.accuracy.tabulated import model_error
from gaspart.analysis.estimate import Estimate
from gaspart.analysis.expected.equilibrium import expect
from gaspart.analysis.observables import OBSERVABLES as declared
from gaspart.analysis.statistics import jackknife, mean_of
from gaspart.engines import DSMC, Engine, EventDriven, TimeStepped
from gaspart.reproduction.figure import runs, series_of
from gaspart.reproduction.figures._timings import median
from gaspart.reproduction.points.point import Point
from gaspart.reproduction.table import Row
from gaspart.scene.container import Container
from gaspart.scene.facts import Gas
from gaspart.scene.scene import Scene
from gaspart.scene.species import Species
from gaspart.theory import bulk

ENGINES = ("event", "step", "boltzmann", "enskog")
"""Engines that are compared; the last two are the models of the DSMC engine."""
NAMES = dict(zip(ENGINES, ("event-driven", "time-stepped", "DSMC, Boltzmann", "DSMC, Enskog"), strict=True))
OBSERVABLES = ("collision_rate", "Z", "D")
BOUND = 2.0  # standard errors that are added to a measured error, so that it becomes a bound
QUANTILE = 1.96  # half width of a 95 % interval: engines are compared at an accuracy that 95 % of runs have
VISCOSITY_UNCERTAINTY = 0.05  # of Enskog's, used to correct D for the size of the container [Yeh 2004]


def setting_name(run: dict) -> str:
    """Return the name of a time-stepped setting in figures and claims."""
    passes = run.get("passes", 4)
    name = f"{passes} passes" if passes > 1 else "1 pass"
    rewound, short = run.get("rewind", True), run.get("precision", "float64") == "float32"
    return name + ("" if rewound else ", no rewinding") + (", float32" if short else "")


class Timing:
    """CPU times and counts of a `measure_cost` point per simulated time, by time step."""

    def __init__(self, point: Point) -> None:
        run = xr.load_dataset(point.path)
        seconds, error = median(run.seconds.values)
        own, duration = point.settings, run.duration.values
        names = {"step": setting_name(own), "dsmc": own.get("model", "boltzmann")}
        self.setting = names.get(run.attrs["engine"], run.attrs["engine"])
        self.gas = (run.attrs["dimension"], round(run.attrs["packing_fraction"], 12))
        self.time_step = (run.duration / np.maximum(run.steps, 1)).values
        self.step_parts = np.array(own.get("scan_step_parts", []))  # over the engine's default step
        self.seconds = Estimate(seconds / duration, error / duration)
        self.contacts = float(run.collisions[0] / run.duration[0])
        self.pair_tests = (run.pair_tests / run.duration).values

    @property
    def solver(self) -> str:
        """Engine among `ENGINES`; other settings of the time-stepped engine keep their names."""
        return "step" if PRECISIONS.get(self.setting) == "float64" else self.setting


class Timings:
    """All timings, by gas (dimension, packing fraction)."""

    def __init__(self, points: Iterable[Point]) -> None:
        self._all = [Timing(point) for point in points if point.job == "measure_cost"]

    def __iter__(self) -> Iterator[Timing]:
        return iter(self._all)

    def of(self, *gas: float) -> list[Timing]:
        """Return the timings of a gas."""
        return [timing for timing in self._all if timing.gas == gas]

    def event(self, *gas: float) -> Timing:
        """Return the timing of the event-driven engine, whose contacts are those of the exact gas."""
        return next(timing for timing in self.of(*gas) if timing.setting == "event")


def compare_steps(points: Iterable[Point], timed: Timings) -> list[dict]:
    """Return errors and costs, NaN if not timed, of each `compare` point's steps, the longest first."""
    return [_costs(_errors(point), timed) for point in points if point.job == "compare"]


def _errors(point: Point) -> dict:
    """Return the errors of the accepted time steps: at least one contact, from the scatter of snapshots."""
    run = xr.load_dataset(point.path)
    run = run.isel(setting=np.flatnonzero(run.refused == 0)).sortby("time_step", ascending=False)
    contacts = run.exact_collisions.sum("snapshot").values
    z = run.exact_z.mean("snapshot").values
    pressure_bias = _difference(run, "virial", 1.0 / contacts) * ((z - 1.0) / z)
    # D by Enskog's theory is kT / m over the rate at which a particle loses the memory of its velocity.
    memory = np.array([
        jackknife(lambda own, exact: exact / own - 1.0, np.log(own), np.log(exact))
        for own, exact in zip(run.memory.values, run.exact_memory.values, strict=True)
    ]).T  # fmt: skip
    memory[1] = np.maximum(memory[1], 1.0 / contacts)
    both = np.stack([_difference(run, "collisions", 1.0 / contacts), pressure_bias, memory])
    listed = run.listed.sum("snapshot", skipna=False).values
    return {
        "dimension": run.attrs["dimension"],
        "packing_fraction": round(run.attrs["packing_fraction"], 12),
        "setting": setting_name(run.attrs),
        "contacts": int(contacts.max()),
        "time_step": run.time_step.values,
        "bias": both[:, 0],
        "bias_error": both[:, 1],
        "bias_freedom": np.full(both[:, 1].shape, run.sizes["snapshot"] - 1.0),
        "missed": run.missed.sum("snapshot", skipna=False).values / listed,
        "made_up": run.made_up.sum("snapshot", skipna=False).values / listed,
        "energy_drift": np.abs(run.energy_drift).max("snapshot").values,
        "deepest_overlap": run.deepest_overlap.max("snapshot").values,
    }


def _difference(run: xr.Dataset, name: str, least: np.ndarray) -> np.ndarray:
    """Compute the relative difference from the sum of the exact runs, and its error, (2, setting)."""
    exact = run[f"exact_{name}"].values
    apart = run[name].values - exact
    error = apart.std(axis=1, ddof=1) * np.sqrt(apart.shape[1]) / exact.sum(axis=1)
    return np.stack([apart.sum(axis=1) / exact.sum(axis=1), np.maximum(error, least)])


def _costs(row: dict, timed: Timings) -> dict:
    gas = row["dimension"], row["packing_fraction"]
    event = timed.event(*gas)
    each = event.seconds[0] / event.contacts
    costs = np.full((3, len(row["time_step"])), np.nan)
    for timing in timed.of(*gas):
        if timing.setting == row["setting"]:
            for n, step in enumerate(row["time_step"]):
                for at in np.flatnonzero(np.isclose(timing.time_step, step))[:1]:
                    parts = timing.seconds.value[at], timing.seconds.error[at], timing.pair_tests[at]
                    costs[:, n] = np.array(parts) / event.contacts
    names = "seconds", "seconds_error", "pair_tests"
    return {
        **row, "event_seconds": each.value, "event_error": each.error,
        **dict(zip(names, costs, strict=True)),
    }  # fmt: skip


PARTS = ("model", "discretisation", "noise", "equilibration", "finite_size")
"""Parts of an error, from the bottom of a stacked bar; the parts that add up to the accuracy come first."""


@dataclass(frozen=True)
class Choice:
    """Option of `gaspart.accuracy`, with the errors that advice does not add.

    option : option whose noise is half of a 95 % interval.
    decay : time in which the initial state's slowest trace falls to 1/e; 0 if this decay is measured.
    uncertainty : relative uncertainty of CPU times, from the timings.
    finite_size : error that remains after theory's correction, equal for all engines and runs.
    trace : maximum relative change of the observable by this trace, initially.
    """

    option: Option
    decay: float
    uncertainty: float
    finite_size: float = 0.0
    trace: float = 1.0

    def parts(self, accuracy: float) -> dict[str, float]:
        """Compute the relative error by `PARTS` of a run for an accuracy. If the accuracy is out of reach,
        the run is infinitely long. The trace of the initial state decays during the measurement. Its mean is
        the decay time divided by the time of the measurement, times the trace that remains after
        equilibration.
        """
        option = replace(self.option, accuracy=accuracy)
        length, remainder = option.measured, 0.0
        if self.decay and math.isfinite(length):
            remainder = self.trace * math.exp(-option.settling / self.decay) * self.decay / length
        bounds = option.candidate.model, option.candidate.discretisation
        values = *bounds, option.noise.reaches(length), remainder, self.finite_size
        return dict(zip(PARTS, values, strict=True))


def by_engine(at: Row, name: str) -> dict[str, Any]:
    """Return a column of a row over the engines."""
    return dict(zip(at.solver.tolist(), at[name], strict=True))


def solver_of(engine: Engine) -> str:
    """Return the name of an engine among `ENGINES`."""
    return engine.name if engine.equation == bulk.EXACT else engine.equation


def finite_size(gas: Gas, observable: str) -> float:
    """Compute the relative error that remains after theory's correction for finite size. This error is the
    square of a correction of first order in 1/N. For D it is the uncertainty of the viscosity, and the next
    order of hydrodynamics.
    """
    correction = abs(getattr(bulk, f"finite_{declared[observable].bulk}")(gas)[0])
    if observable != "D":
        return float(correction**2)
    order = (2.0 * math.pi * float(theory.mean_free_path(gas.packing_fraction, 3)) / _side(gas)) ** 2
    return float(correction * min(1.0, math.hypot(VISCOSITY_UNCERTAINTY, order)))


def decay_of(gas: Gas, observable: str) -> tuple[float, float]:
    """Return the decay time of the slowest trace of the initial state, and its maximum initial size. For most
    observables the trace is in the speeds, and its size is 1. For D the trace is the longest shear wave,
    which carries the part of D that is missing in a finite container.
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


class Cells:
    """Effect of the cells of the Enskog model in a run, relative to its equation.

    rate : collision rate divided by that of the equation.
    bound : bound on the fraction of lost collisions, from docs/dsmc.md.
    noise : relative variance times contacts, by observable.
    """

    def __init__(self, point: Point) -> None:
        ((replica, expected),) = ((series_of(run), expect("collision_rate", run)) for run in runs(point))
        assert expected is not None
        contacts = 0.5 * point.scene.count * expected.value * replica.interval
        series = {"collision_rate": replica.rate, "Z": replica.z}
        self.rate = mean_of(replica.rate) / expected.value
        self.bound = expected.error / expected.value
        self.noise = {
            name: float(values.var(ddof=1) / values.mean() ** 2) * contacts for name, values in series.items()
        }

    @property
    def error(self) -> float:
        """Bound on the relative error of the collision rate, and of all results derived from it."""
        return float(abs(self.rate.value - 1.0) + BOUND * self.rate.error)


def cells_by_fraction(points: Iterable[Point], experiments: Sequence[str]) -> dict[float, Cells]:
    """Return the effect of cells at the points of some experiments, by packing fraction."""
    of = (point for point in points if point.experiment in experiments)
    return {float(point.settings["packing_fraction"]): Cells(point) for point in of}


def choices(
    gas: Gas, observable: str, timed: Timings, compared: list[dict], cells: Cells | None
) -> Iterator[Choice]:
    """Yield all settings of all engines that were timed in a gas of spheres. `cells` is the effect of cells
    in the Enskog model, or None if it is unknown.
    """
    own = 3, gas.packing_fraction
    contacts = timed.event(*own).contacts
    variance = table.noise(*own, observable)
    decay, trace = decay_of(gas, observable)

    def choice(candidate: Candidate, each: Estimate, noise: float = variance) -> Choice:
        option = fluid_option(gas, candidate, each.value, QUANTILE**2 * noise, 1.0, discarded=0.0)
        return Choice(option, decay, each.error / each.value, finite_size(gas, observable), trace)

    yield choice(Candidate(EventDriven()), (timed.event(*own).seconds / contacts)[0])
    at = OBSERVABLES.index(observable)
    for row in compared:
        if (row["dimension"], row["packing_fraction"]) != own or row["setting"] not in PRECISIONS:
            continue
        bound = np.abs(row["bias"][at]) + BOUND * row["bias_error"][at]
        seconds = Estimate(row["seconds"], row["seconds_error"])
        for n in np.flatnonzero(np.isfinite(bound) & np.isfinite(seconds.value)):
            stepped = TimeStepped(float(row["time_step"][n]), precision=PRECISIONS[row["setting"]])
            yield choice(Candidate(stepped, discretisation=float(bound[n])), seconds[n])
    for timing in timed.of(*own):
        model = timing.setting
        if model not in ("boltzmann", "enskog") or (model == "enskog" and cells is None):
            continue
        error, of_cells, noise = model_error(gas.packing_fraction, 3, model, observable), 0.0, variance
        if cells and model == "enskog":
            of_cells, noise = cells.error, cells.noise.get(observable, variance)
        elif observable == "Z":
            noise = 0.0  # it is 1 in any case
        for step, each in zip(timing.time_step, timing.seconds / contacts, strict=True):
            dsmc = DSMC(float(step), model=model)
            steps = error_of_steps(dsmc, gas) if observable == "D" else 0.0
            yield choice(Candidate(dsmc, error, steps + of_cells), each, noise)


def error_of_steps(engine: DSMC, gas: Gas) -> float:
    """Return the relative error of D due to time steps alone, as the engine estimates it."""
    species = Species(gas.count, 0.5 * gas.diameter, temperature=gas.temperature)
    scene = Scene(Container((_side(gas),) * 3, boundary="periodic"), species=(species,))
    return engine.errors(scene).path
