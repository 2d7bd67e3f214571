"""Table of measured costs and errors, and interpolation between its points.

Columns: ``dimension``, ``packing_fraction``; ``engine`` (event; step, with its standard four passes and
rewinding; dsmc and dsmc enskog, by its model), ``precision``, ``time_step`` in diameters divided by the
thermal speed (kT / m)^(1/2), for DSMC in its own step, a fifth of a mean free time, 0 for event;
``quantity``, its ``value`` and standard ``error``. Quantities: ``seconds`` of CPU time for one exact contact
of two particles; ``bias_<observable>``, relative error; ``noise_<observable>``, the relative variance of an
estimate times the number of its contacts; ``price_<feature>``, the time per event with a feature divided by
the time without it. Observables: Z, collision_rate, D. Other errors follow from theory
(`gaspart.accuracy.tabulated`).
"""

from __future__ import annotations

import csv
import math
import statistics
import sys
import time
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import numpy as np
import xarray as xr

from gaspart import theory
from gaspart.analysis.observables import OBSERVABLES
from gaspart.engines import DSMC, Engine, offered
from gaspart.scene.container import Container
from gaspart.scene.features import FEATURES
from gaspart.scene.scene import Scene
from gaspart.scene.species import Species
from gaspart.simulation import Simulation
from gaspart.trajectory import provenance

COLUMNS = ("dimension", "packing_fraction", "engine", "precision", "time_step", "quantity", "value", "error")
PATH = Path(__file__).parent / "data" / "accuracy.csv"
PRECISIONS = {"4 passes": "float64", "4 passes, float32": "float32"}
"""The settings of the time-stepped engine that are worth advising, by their names in figures."""
EQUILIBRATION = 30.0
"""Collisions per particle before anything is measured."""
LEAST = 20.0
"""Collisions per particle that are measured at least: a shorter run is no average over time."""
REFERENCE, STEP = 0.1, 0.08
"""Packing fraction of the gas by which times are carried over, and the time step with which it is timed."""
_EXACT = "event"  # the engine by which noise, which is that of a gas with any engine, was measured
_PRICE, _BIAS = "price_", "bias_"
_SAFE = 2.0  # standard errors added to a bias
_BEYOND = 1.05  # a packing fraction may exceed those of the table by this factor


@cache
def read() -> tuple[dict, ...]:
    """Read all rows, and convert numbers."""
    with PATH.open(encoding="utf-8") as file:
        lines = [line for line in file if not line.startswith("#")]
    kinds = (int, float, str, str, float, str, float, float)
    return tuple(
        {key: kind(row[key]) for key, kind in zip(COLUMNS, kinds, strict=True)}
        for row in csv.DictReader(lines)
    )


def lowest(dimension: int) -> float:
    """Return the lowest packing fraction at which an engine was timed, minus 5 %."""
    timed = (row for row in read() if row["quantity"] == "seconds" and row["dimension"] == dimension)
    return min(float(row["packing_fraction"]) for row in timed) / _BEYOND


def steps(dimension: int, engine: str) -> list[tuple[str, float]]:
    """Return precision and time step of all timed settings of an engine."""
    timed = (row for row in read() if row["engine"] == engine and row["quantity"] == "seconds")
    found = (row for row in timed if row["dimension"] == dimension)
    return list(dict.fromkeys((row["precision"], row["time_step"]) for row in found))


def has_biases(engine: str) -> bool:
    """Return True if errors of an engine were measured; otherwise they follow from theory."""
    return any(row["engine"] == engine and row["quantity"].startswith(_BIAS) for row in read())


def bias(
    dimension: int, fraction: float, precision: str, step: float, observable: str, engine: str = "step"
) -> float:
    """Return a bound on the relative error of an engine, with two standard errors.

    The default engine is the one with time steps. The bound is inf where no error was measured. Between
    packing fractions the larger error of both neighbours is taken: errors change their sign between them.
    """
    eta, value, error = _curve(dimension, engine, precision, step, f"{_BIAS}{observable}")
    if not eta.size or not eta[0] / _BEYOND <= fraction <= eta[-1] * _BEYOND:
        return np.inf
    bound = np.abs(value) + _SAFE * error
    at = int(np.clip(np.searchsorted(eta, fraction * 0.999), 0, eta.size - 1))
    near = {at, max(0, at - 1)} if not np.isclose(eta[at], fraction, rtol=1e-3) else {at}
    return float(max(bound[n] for n in near))


def seconds(
    dimension: int, fraction: float, engine: str, precision: str = "float64", step: float = 0.0
) -> float:
    """Return the CPU time of one exact contact, on the machine of the table.

    It is inf where it was not measured. Outside the gases of the table an engine without steps has the time
    of the nearest gas.
    """
    eta, value, _ = _curve(dimension, engine, precision, step, "seconds")
    if not eta.size or (step and not eta[0] / _BEYOND <= fraction <= eta[-1] * _BEYOND):
        return np.inf
    return float(np.exp(np.interp(np.log(fraction), np.log(eta), np.log(value))))


def noise(dimension: int, fraction: float, observable: str) -> float:
    """Return the relative variance of an observable times the number of its contacts.

    It is inf if it was not measured. In a gas more dilute than the gases of the table the variance of Z falls
    with the square of (Z - 1) / Z, since Z - 1 is in proportion to the contacts, and the others are those in
    the most dilute gas.
    """
    eta, value, _ = _curve(dimension, _EXACT, "float64", 0.0, f"noise_{observable}")
    if not eta.size:
        return np.inf
    # A line through the logarithms: single values come from few blocks.
    order = min(2, eta.size - 1)
    fit = np.polyfit(np.log(eta), np.log(value), order)
    found = float(np.exp(np.polyval(fit, np.log(np.clip(fraction, eta[0], eta[-1])))))
    if observable == "Z" and fraction < eta[0]:
        virial = [
            1.0 - 1.0 / float(theory.compressibility_factor(at, dimension)) for at in (fraction, eta[0])
        ]
        found *= (virial[0] / virial[1]) ** 2
    return found


def prices(engine: str) -> dict[str, float]:
    """Return the time per event with each measured feature, divided by the time without it.

    The features are measured by `price_of_features`.
    """
    rows = (row for row in read() if row["engine"] == engine and row["quantity"].startswith(_PRICE))
    return {row["quantity"].removeprefix(_PRICE): row["value"] for row in rows}


@cache
def _curve(
    dimension: int, engine: str, precision: str, step: float, quantity: str
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return packing fractions, values and errors of one quantity."""
    wanted = (dimension, engine, precision, step, quantity)
    keys = ("dimension", "engine", "precision", "time_step", "quantity")
    found = sorted(
        (row["packing_fraction"], row["value"], row["error"])
        for row in read()
        if tuple(row[key] for key in keys) == wanted
    )
    eta, value, error = np.array(found, dtype=float).reshape(-1, 3).T
    return eta, value, error


# The model's table from the workflow's measurements.
#
#     python -m gaspart.accuracy.cost_table results/measurements > src/gaspart/accuracy/data/accuracy.csv
#
# takes speed_accuracy.nc (errors and times of the engines), virial_spheres.nc and virial_discs.nc (noise
# of Z and of the collision rate), msd_spheres.nc (noise of D) and price_of_features.nc from the folder it
# is given.


def rows(folder: Path) -> list[dict]:
    """Return all rows of the table; their meaning is in `gaspart.accuracy.cost_table`."""
    accuracy = xr.load_dataset(folder / "speed_accuracy.nc")
    found = [
        *_events(accuracy),
        *_steps(accuracy),
        *_models(accuracy),
        *_noise(xr.load_dataset(folder / "virial_spheres.nc"), 3),
        *_noise(xr.load_dataset(folder / "virial_discs.nc"), 2),
        *_diffusion(xr.load_dataset(folder / "msd_spheres.nc")),
        *_prices(xr.load_dataset(folder / "price_of_features.nc")),
    ]
    return [{**row, "value": f"{row['value']:.4g}", "error": f"{row['error']:.2g}"} for row in found]


def _row(
    dimension: int,
    fraction: float,
    engine: str,
    precision: str,
    step: float,
    quantity: str,
    value: float,
    error: float,
) -> dict:
    values = (int(dimension), f"{float(fraction):g}", engine, precision, f"{step:g}", quantity, float(value))
    return dict(zip(COLUMNS, (*values, float(error)), strict=True))


def _events(accuracy: xr.Dataset) -> Iterator[dict]:
    """Yield times of the event-driven engine, in denser gases than the time-stepped engine too."""
    for n in range(accuracy.sizes["timed"]):
        run = accuracy.isel(timed=n)
        gas = run.timed_dimension, run.timed_packing_fraction
        yield _row(*gas, "event", "float64", 0.0, "seconds", run.timed_seconds, run.timed_error)


def _steps(accuracy: xr.Dataset) -> Iterator[dict]:
    """Yield errors and times of the time-stepped engine."""
    for n in range(accuracy.sizes["row"]):
        row = accuracy.isel(row=n)
        gas = row.dimension, row.packing_fraction
        setting = str(row.setting.values)
        if setting not in PRECISIONS:
            continue
        for k in np.flatnonzero(np.isfinite(row.time_step.values)):
            step = float(row.time_step[k])
            of = (*gas, "step", PRECISIONS[setting], step)
            for observable in row.observable.values:
                at = row.sel(observable=observable).isel(step=k)
                if np.isfinite(at.bias):
                    yield _row(*of, f"bias_{observable}", at.bias, at.bias_error)
            if np.isfinite(row.seconds[k]):
                yield _row(*of, "seconds", row.seconds[k], row.seconds_error[k])


def _models(accuracy: xr.Dataset) -> Iterator[dict]:
    """Yield times of the models of the DSMC engine, with its own step and longer ones."""
    names = {engine.equation: engine.timed_as for engine in DSMC.offered()}
    for n in range(accuracy.sizes["dsmc"]):
        run = accuracy.isel(dsmc=n)
        gas = run.dsmc_dimension, run.dsmc_packing_fraction
        model = names[str(run.dsmc_model.values)]
        for k in np.flatnonzero(run.dsmc_step.values >= 1.0):
            step, of = float(run.dsmc_step[k]), run.isel(part=k)
            seconds = of.dsmc_step_seconds, of.dsmc_step_seconds_error
            yield _row(*gas, model, "float64", step, "seconds", *seconds)


def _noise(virial: xr.Dataset, dimension: int) -> Iterator[dict]:
    """Yield relative variances of Z and of the collision rate, times their numbers of contacts."""
    for n, fraction in enumerate(virial.packing_fraction.values):
        contacts = float(virial.collisions[n])
        for name, quantity in (("Z", "Z"), ("collision_rate", "collision_rate")):
            relative = float(virial[f"{name}_error"][n] / virial[name][n])
            value = relative**2 * contacts
            yield _row(dimension, fraction, "event", "float64", 0.0, f"noise_{quantity}", value, 0.3 * value)


def _diffusion(msd: xr.Dataset) -> Iterator[dict]:
    """Yield the relative variance of D of spheres, times its number of contacts.

    It is one number, the median of all gases (each has few replicas).
    """
    length = msd.time.max("lag") * 2.0 * msd.collision_rate  # lags reach to half a run
    contacts = 0.5 * msd["count"] * length * msd.replicas
    values = ((msd.diffusion_error / msd.diffusion) ** 2 * contacts).values
    values = values[np.isfinite(values)]
    yield _row(
        3, 0.1, "event", "float64", 0.0, "noise_D", np.median(values), values.std() / len(values) ** 0.5
    )


def _prices(price: xr.Dataset) -> Iterator[dict]:
    """Yield the cost of each feature, for 4000 spheres at a packing fraction of 0.2."""
    for n in np.flatnonzero(price.feature.values != "plain"):
        at = price.isel(point=n)
        name = f"price_{str(at.feature.values).replace(' ', '_')}"
        yield _row(3, 0.2, str(at.engine.values), "float64", 0.0, name, at.ratio, at.ratio_error)


def main(folder: str) -> None:
    """Write the table to the standard output."""
    revision = provenance.git_revision()
    print(
        "# What accuracy costs; columns in gaspart/accuracy/cost_table.py. "
        "Made by python -m gaspart.accuracy.cost_table"
    )
    print(f"# from the full reproduction, revision {revision}. Times are of the machine that it ran on.")
    writer = csv.DictWriter(sys.stdout, COLUMNS, lineterminator="\n")
    writer.writeheader()
    writer.writerows(rows(Path(folder)))


if __name__ == "__main__":
    main(sys.argv[1])


# What the features of a scene cost with an engine.


_NAMES = {
    "walls": "walls of the container",
    "gravity": "gravity",
    "spin": "rough particles",
    "two_masses": "unequal masses",
    "stress": "the stress tensor",
}
"""Names of the measured features."""
_MEASURED = ("gravity", "roughness")
"""Features of `scene.features` among them."""


@dataclass(frozen=True)
class Price:
    """Cost of the features of a scene, in addition to its collisions.

    ratios : time per event with each measured feature, divided by the time without it.
    unknown : features of the scene whose cost was not measured.
    single : time in single precision divided by the time in double precision, None for an engine that has one
        precision only.
    """

    ratios: dict[str, float]
    unknown: tuple[str, ...]
    single: float | None


def price_of(scene: Scene, engine: Engine, observable: str) -> Price:
    """Return the price of an observable of a scene with an engine.

    It was measured in a gas of 4000 spheres at a packing fraction of 0.2 (figure `price_of_features`), where
    a feature that is absent costs nothing.
    """
    has = {
        "walls": not scene.is_periodic,
        "gravity": any(scene.gravity or ()),
        "spin": scene.rough,
        "two_masses": len({kind.mass for kind in scene.kinds}) > 1,
        "stress": OBSERVABLES[observable].needs == "fluxes",
    }
    known, present = prices(engine.timed_as), scene.features
    ratios = {_NAMES[name]: known[name] for name in _NAMES if has[name] and name in known}
    unknown = [_NAMES[name] for name in _NAMES if has[name] and name not in known]
    unknown += [FEATURES[name].meaning for name in FEATURES if name in present and name not in _MEASURED]
    return Price(ratios, tuple(unknown), _single(engine, scene.dimension))


def _single(engine: Engine, dimension: int) -> float | None:
    """Compute the time per contact in single precision divided by the time in double precision.

    The gas is the one at which the engine is timed; None for an engine that was not timed in both.
    """
    fraction, step = engine.timed_at
    single, double = (
        seconds(dimension, fraction, engine.timed_as, precision, step) for precision in ("float32", "float64")
    )
    return single / double if math.isfinite(single / double) else None


# Speed of this machine relative to that of the table, measured by a run of a tenth of a second.


_LEAST, _MOST = 500, 100_000  # particles in a timed run
_GROWTH = 0.15  # exponent of the time per contact with the number of particles beyond, which exceed the cache
_CONTACTS = 2e4


@cache
def factor(dimension: int, engine: str, precision: str, count: int) -> float:
    """Measure the CPU time of a contact here, divided by the time in the table.

    The gas at which the engine is `timed_at` is timed three times, with `count` particles, after a short run
    from a lattice. `engine` is its name in the table.
    """
    growth = max(1.0, count / _MOST) ** _GROWTH
    count = min(max(count, _LEAST), _MOST)
    timed = _named(engine)
    fraction, step = timed.timed_at
    side = (count * theory.particle_volume(dimension) / fraction) ** (1.0 / dimension)
    particles = Species(count, 0.5, temperature=1.0, arrangement="lattice")
    gas = Scene(Container((side,) * dimension, boundary="periodic"), species=(particles,))
    rate = float(theory.collision_rate(fraction, dimension))
    run = Simulation(gas, timed.at_step(gas, step, precision), seed=1)
    run.advance(duration=1.0 / rate)
    stretch = 2.0 * max(_CONTACTS, 0.5 * count) / (count * rate)
    taken = []
    for _ in range(3):
        before, start = run.time, time.process_time()
        run.advance(duration=stretch)
        taken.append((time.process_time() - start) / (0.5 * count * rate * (run.time - before)))
    known = seconds(dimension, fraction, engine, precision, step)
    return growth * statistics.median(taken) / known if math.isfinite(known) else math.inf


def _named(name: str) -> Engine:
    """Return an engine by its name in the table."""
    return next(one for one in offered() if one.timed_as == name)
