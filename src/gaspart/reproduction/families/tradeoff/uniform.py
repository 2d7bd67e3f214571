"""Choices for a gas in equilibrium: its collision rate, compressibility factor Z, and D.

The event-driven engine has only a statistical error. Errors of time steps are measured; see `errors`. Errors
of the DSMC engine follow from theory. Its model lacks the contact value, the virial or the memory of
collisions. Its steps change D by a law that `dsmc_convergence` confirms. Only one of its errors is measured:
the effect of the few particles per cell on the collisions of the Enskog model.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np
import xarray as xr

from gaspart import theory
from gaspart.accuracy import table
from gaspart.accuracy.table import EQUILIBRATION, LEAST, PRECISIONS
from gaspart.accuracy.tabulated import model_error, step_error
from gaspart.analysis import statistics
from gaspart.analysis.estimate import Estimate
from gaspart.analysis.statistics import mean_of
from gaspart.reproduction.families.shared.runs import runs, series_of
from gaspart.reproduction.families.shared.timings import median
from gaspart.reproduction.families.tradeoff.choices import Choice
from gaspart.reproduction.points.point import Point
from gaspart.theory.enskog import approach_factor

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


@dataclass(frozen=True)
class Uniform:
    """Spheres of a packing fraction in a periodic cube.

    There are `count` of them.
    """

    packing_fraction: float
    count: int

    def finite_size(self, observable: str) -> float:
        """Compute the relative error that remains after theory's correction for finite size.

        It is the square of a correction of first order in 1/N. For D it is the uncertainty of the viscosity,
        and the next order of hydrodynamics; see `displacement`.
        """
        eta, count = self.packing_fraction, self.count
        if observable == "collision_rate":
            return float(theory.collision_rate_finite_size_factor(eta, 3, count) - 1.0) ** 2
        if observable == "Z":
            shift = theory.finite_size_correction(eta, 3, count, ensemble="canonical")
            return float(shift / theory.compressibility_factor(eta, 3)) ** 2
        order = (2.0 * math.pi * float(theory.mean_free_path(eta, 3)) / self._side) ** 2
        return self._lost * min(1.0, math.hypot(_VISCOSITY_UNCERTAINTY, order))

    def decay(self, observable: str) -> tuple[float, float]:
        """Return the decay of the slowest trace of the initial state, and its initial size.

        The decay time to 1/e is in collisions per particle. The size is a maximum, relative to the
        observable. For most observables the trace is in the speeds, and its size is 1. For D the trace is the
        longest shear wave, which carries the part of D that is missing in a finite container.
        """
        speeds = 1.0 / theory.KURTOSIS_RELAXATION_RATE[3]
        wave = (self._side / (2.0 * math.pi)) ** 2 / self._spreading
        wave *= float(theory.collision_rate(self.packing_fraction, 3))
        return (wave, self._lost) if observable == "D" and wave > speeds else (speeds, 1.0)

    def choice(
        self, engine: str, observable: str, errors: tuple[float, float], each: Estimate, noise: float
    ) -> Choice:
        """Return the choice of an engine for an observable.

        errors : errors of model and discretisation.
        each : CPU time per contact.
        noise : relative variance times contacts.
        """
        particle = 0.5 * self.count * each.value  # per collision of every particle
        decay, trace = self.decay(observable)
        return Choice(
            engine=engine,
            model=errors[0],
            discretisation=errors[1],
            finite_size=self.finite_size(observable),
            unit=noise * each.value,
            least=LEAST * particle,
            equilibration=EQUILIBRATION * particle,
            decay=decay * particle,
            trace=trace,
            uncertainty=each.error / each.value,
        )

    @property
    def _lost(self) -> float:
        """Fraction of D that is missing due to the finite container, without correction [Yeh 2004]."""
        diffusion = float(theory.enskog_diffusion(self.packing_fraction, 3))
        return float(theory.yeh_hummer(self._side, self._spreading * self._density)) / diffusion

    @property
    def _density(self) -> float:
        return float(theory.number_density(self.packing_fraction, 3))

    @property
    def _side(self) -> float:
        return (self.count / self._density) ** (1.0 / 3.0)

    @property
    def _spreading(self) -> float:
        """Decay coefficient of shear waves, including a particle's own diffusion."""
        viscosity = float(theory.enskog_viscosity(self.packing_fraction, 3))
        return viscosity / self._density + float(theory.enskog_diffusion(self.packing_fraction, 3))


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
    """Return the effect of default cells in a run of the Enskog model.

    The collision rate is relative to the Enskog equation.
    """
    (replica,) = (series_of(run) for run in runs(point))
    fraction, count = point.scene.packing_fraction, point.scene.count
    contact = (float(theory.carnahan_starling(fraction)) - 1.0) / (4.0 * fraction)
    expected = float(theory.collision_rate(fraction, 3) / theory.contact_value(fraction, 3)) * contact
    expected *= (1.0 - 1.0 / count) * approach_factor(3, count)
    contacts = 0.5 * count * expected * replica.interval
    variances = {
        name: float(series.var(ddof=1) / series.mean() ** 2) * contacts
        for name, series in (("collision_rate", replica.rate), ("Z", replica.z))
    }
    return Cells(mean_of(replica.rate) / expected, point.engine.bias(point.scene, "rates"), variances)


def cells_by_fraction(points: Iterable[Point], experiments: Sequence[str]) -> dict[float, Cells]:
    """Return the effect of cells at the points of some experiments, by packing fraction.

    The packing fraction is in the points' settings.
    """
    of = (point for point in points if point.experiment in experiments)
    return {float(point.settings["packing_fraction"]): cells_of(point) for point in of}


def choices(
    gas: Uniform, observable: str, timed: list[dict], compared: list[dict], cells: Cells | None
) -> Iterator[Choice]:
    """Yield all settings of all engines that were timed in a gas.

    `cells` is the effect of cells in the Enskog model, or None if it is unknown.
    """
    same = [timing for timing in timed if timing["gas"] == (3, gas.packing_fraction)]
    event = next(timing for timing in same if timing["setting"] == "event")
    rate = float(event["collisions"][0])
    variance = table.noise(3, gas.packing_fraction, observable)
    yield gas.choice("event", observable, (0.0, 0.0), each_of(event, rate)[0], variance)
    at = OBSERVABLES.index(observable)
    for row in compared:
        if (row["dimension"], row["packing_fraction"]) != (3, gas.packing_fraction):
            continue
        if row["setting"] not in PRECISIONS:
            continue
        bound = np.abs(row["bias"][at]) + BOUND * row["bias_error"][at]
        for error, *each in zip(bound, row["seconds"], row["seconds_error"], strict=True):
            if np.isfinite(error) and np.isfinite(each[0]):
                yield gas.choice("step", observable, (0.0, float(error)), Estimate(*each), variance)
    for timing in same:
        model = timing["setting"]
        if model not in ("boltzmann", "enskog") or (model == "enskog" and cells is None):
            continue
        for step, each in zip(timing["time_step"], each_of(timing, rate), strict=True):
            error = step_error(gas.packing_fraction, step) if observable == "D" else 0.0
            of_cells = cells.error if cells and model == "enskog" else 0.0
            own = cells.noise.get(observable, variance) if cells and model == "enskog" else variance
            if model == "boltzmann" and observable == "Z":
                own = 0.0  # it is 1 in any case
            both = model_error(gas.packing_fraction, 3, model, observable), error + of_cells
            yield gas.choice(model, observable, both, each, own)


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
