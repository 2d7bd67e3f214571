"""Table of measured costs and errors, and interpolation between its points.

Columns: ``dimension``, ``packing_fraction``; ``engine`` is `event`, `step` (four passes and rewinding, the
standard settings), `dsmc` or `dsmc enskog` (the two models of DSMC). ``precision`` and ``time_step`` are its
settings. The time step is in diameters divided by the thermal speed (kT / m)^(1/2). For DSMC its unit is the
default step, a fifth of a mean free time; for `event` it is 0. The other columns are ``quantity``, its
``value`` and its standard ``error``. Quantities: ``seconds``, the CPU time for one exact contact of two
particles; ``bias_<observable>``, the relative error; ``noise_<observable>``, the relative variance of an
estimate multiplied by the number of contacts; ``price_<feature>``, the time per event with a feature divided
by the time without it. Observables: Z, collision_rate, D. Other errors follow from theory
(`gaspart.accuracy.tabulated`).
"""

from __future__ import annotations

import csv
import math
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import numpy as np

from gaspart import theory
from gaspart.accuracy.advisers import adviser_of, timed_as
from gaspart.analysis.observables import OBSERVABLES
from gaspart.engines import Engine
from gaspart.scene.features import FEATURES
from gaspart.scene.scene import Scene

COLUMNS = ("dimension", "packing_fraction", "engine", "precision", "time_step", "quantity", "value", "error")
PATH = Path(__file__).parent / "data" / "accuracy.csv"
PRECISIONS = {"4 passes": "float64", "4 passes, float32": "float32"}
"""Recommended settings of the time-stepped engine, by their names in figures."""
EQUILIBRATION = 30.0
"""Equilibration before the measurement, in collisions per particle."""
LEAST = 20.0
"""Minimum length of a measurement in collisions per particle; a shorter run gives no time average."""
REFERENCE, STEP = 0.1, 0.08
"""Packing fraction and time step of the gas that is timed to compare this machine with the machine of the
table.
"""
_EXACT = "event"  # the noise was measured with this engine; it is the same with all engines
_PRICE, _BIAS = "price_", "bias_"
_SAFE = 2.0  # number of standard errors added to a bias
_BEYOND = 1.05  # a packing fraction may exceed the largest in the table by this factor


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
    """Return the lowest packing fraction at which an engine was timed, reduced by 5 %."""
    timed = (row for row in read() if row["quantity"] == "seconds" and row["dimension"] == dimension)
    return min(float(row["packing_fraction"]) for row in timed) / _BEYOND


def steps(dimension: int, engine: str) -> list[tuple[str, float]]:
    """Return precision and time step of all timed settings of an engine."""
    timed = (row for row in read() if row["engine"] == engine and row["quantity"] == "seconds")
    rows = (row for row in timed if row["dimension"] == dimension)
    return list(dict.fromkeys((row["precision"], row["time_step"]) for row in rows))


def has_biases(engine: str) -> bool:
    """Return True if the errors of an engine were measured. Otherwise they are computed from theory."""
    return any(row["engine"] == engine and row["quantity"].startswith(_BIAS) for row in read())


def bias(
    dimension: int, fraction: float, precision: str, step: float, observable: str, engine: str = "step"
) -> float:
    """Return a bound on the relative error of an engine, with two standard errors. The bound is inf if no
    error was measured. Between two packing fractions of the table the larger error of the two is used,
    because errors may change sign between them.
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
    """Return the CPU time of one exact contact, on the machine of the table. The result is inf if the time
    was not measured. Outside the packing fractions of the table, an engine without time steps has the time of
    the nearest gas.
    """
    eta, value, _ = _curve(dimension, engine, precision, step, "seconds")
    if not eta.size or (step and not eta[0] / _BEYOND <= fraction <= eta[-1] * _BEYOND):
        return np.inf
    return float(np.exp(np.interp(np.log(fraction), np.log(eta), np.log(value))))


def noise(dimension: int, fraction: float, observable: str) -> float:
    """Return the relative variance of an observable multiplied by the number of contacts. The result is inf
    if the noise was not measured. In a gas more dilute than all gases of the table, the variance of Z
    decreases as the square of (Z - 1) / Z, because Z - 1 is proportional to the number of contacts. The other
    variances are equal to their values in the most dilute gas of the table.
    """
    eta, value, _ = _curve(dimension, _EXACT, "float64", 0.0, f"noise_{observable}")
    if not eta.size:
        return np.inf
    # A straight line is fitted to the logarithms, because single values come from few blocks.
    order = min(2, eta.size - 1)
    fit = np.polyfit(np.log(eta), np.log(value), order)
    variance = float(np.exp(np.polyval(fit, np.log(np.clip(fraction, eta[0], eta[-1])))))
    if observable == "Z" and fraction < eta[0]:
        virial = [
            1.0 - 1.0 / float(theory.compressibility_factor(at, dimension)) for at in (fraction, eta[0])
        ]
        variance *= (virial[0] / virial[1]) ** 2
    return variance


def prices(engine: str) -> dict[str, float]:
    """Return the time per event with each feature over that without, as `price_of_features` measures."""
    rows = (row for row in read() if row["engine"] == engine and row["quantity"].startswith(_PRICE))
    return {row["quantity"].removeprefix(_PRICE): row["value"] for row in rows}


@cache
def _curve(
    dimension: int, engine: str, precision: str, step: float, quantity: str
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return packing fractions, values and errors of one quantity."""
    selection = (dimension, engine, precision, step, quantity)
    keys = ("dimension", "engine", "precision", "time_step", "quantity")
    rows = sorted(
        (row["packing_fraction"], row["value"], row["error"])
        for row in read()
        if tuple(row[key] for key in keys) == selection
    )
    eta, value, error = np.array(rows, dtype=float).reshape(-1, 3).T
    return eta, value, error


# Cost of the features of a scene with an engine.


_NAMES = {
    "walls": "walls of the container",
    "gravity": "gravity",
    "spin": "rough particles",
    "two_masses": "unequal masses",
    "stress": "the stress tensor",
}
"""Names of the measured features."""
_MEASURED = ("gravity", "roughness")
"""Measured features that are also in `scene.features`."""


@dataclass(frozen=True)
class Price:
    """Cost of the features of a scene, in addition to its collisions.

    ratios : time per event with each measured feature, divided by the time without it.
    unknown : features of the scene whose cost was not measured.
    single : time in single precision divided by the time in double precision, None for an engine with only
        one precision.
    """

    ratios: dict[str, float]
    unknown: tuple[str, ...]
    single: float | None


def price_of(scene: Scene, engine: Engine, observable: str) -> Price:
    """Return the cost factors of an observable of a scene with an engine. The costs were measured in a gas of
    4000 spheres at a packing fraction of 0.2 (figure `price_of_features`).
    """
    has = {
        "walls": not scene.is_periodic,
        "gravity": any(scene.gravity or ()),
        "spin": scene.rough,
        "two_masses": len({kind.mass for kind in scene.kinds}) > 1,
        "stress": OBSERVABLES[observable].needs == "fluxes",
    }
    measured, present = prices(timed_as(engine)), scene.features
    ratios = {_NAMES[name]: measured[name] for name in _NAMES if has[name] and name in measured}
    unknown = [_NAMES[name] for name in _NAMES if has[name] and name not in measured]
    unknown += [FEATURES[name].meaning for name in FEATURES if name in present and name not in _MEASURED]
    return Price(ratios, tuple(unknown), _single(engine, scene.dimension))


def _single(engine: Engine, dimension: int) -> float | None:
    """Compute the time per contact in single over double precision, or None if not timed in both."""
    adviser = adviser_of(engine)
    fraction, step = adviser.timed_at
    single, double = (
        seconds(dimension, fraction, adviser.timed_as, precision, step)
        for precision in ("float32", "float64")
    )
    return single / double if math.isfinite(single / double) else None
