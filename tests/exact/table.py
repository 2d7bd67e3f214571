"""The table of exact values: each observable in each kind of scene, under each engine that serves it.

A cell is a value from a source that shares no code with gaspart, or a refusal by a rule of `rules`, which
gaspart must make too, or it states why no exact value is known. `PYTHONPATH=tests python -m exact.table`
writes the table for the page of the site.
"""

import csv
import math
import warnings
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import numpy as np
from exact import closed, runs
from exact.balances import BALANCES
from exact.kinds import kinds
from exact.known import Short, known
from exact.rules import LONG, undefined, unknown
from exact.values import stored
from scipy import stats

import gaspart as gp
from gaspart.analysis.observables import OBSERVABLES, require_modelled
from gaspart.errors import SceneError

FILE = Path(__file__).parents[2] / "results/docs/exact_values.csv"
COLUMNS = ("scene", "engine", "observable", "state", "deviation", "parts", "text")
LIMIT = 4.0
"""Largest deviation of a value, as a normal deviate."""
SPREAD = 1.6
"""Largest root mean square of the deviations of the points of a curve."""
POINTS = 8
"""Points of a curve from which their spread is tested."""
SAMPLER_FREEDOM, RUN_FREEDOM = 19.0, 15.0
FREEDOM = 6.0
"""Degrees of freedom of an error, below which it is too uncertain to be compared with."""
LEAST = 0.25
"""Part of the places with a value that must have an error."""
FAINT = 1e-3
"""Part of the largest force that a few hits give."""
EQUAL = 1e-6
"""Relative difference of values without an error."""
STATED = {
    **dict.fromkeys(("collision_rate", "pair_rates", "contact_values", "Z", "pressure_tensor"), "error"),
    **dict.fromkeys(("pressure", "force"), "error_of_wall_pressures"),
    "density": "error_of_the_density_at_walls",
}
"""Observable -> prediction of an engine that bounds its relative error."""


@dataclass(frozen=True)
class Cell:
    """State of a cell: "value" (the deviation is that of its worst part), "wrong" (`text` states how), or
    "refused", "not modelled" and "unknown" for the reason `text`."""

    observable: str
    scene: str
    engine: str
    state: str
    text: str = ""
    deviation: float = 0.0
    parts: int = 0


def right_parts(observable, kind):
    """Return part -> right value of an observable: a closed form if there is one, else the sampled one."""
    found = known(observable, kind)
    if not found and (kind.equation == "exact" or kind.points):
        found = stored().get(kind.name, {"values": {}})["values"].get(observable, {})
    return found


@cache
def cells(name, engine="event", seed=runs.SEED, longer=1.0, finer=1):
    """Return the cells of a run: one for each observable, and the balances."""
    run = engine, seed, longer, finer
    return [cell_of(observable, kinds()[name], *run) for observable in (*OBSERVABLES, *BALANCES)]


def cell_of(observable, kind, engine="event", seed=runs.SEED, longer=1.0, finer=1):
    """Return the cell of an observable of a run."""
    run = kind.name, engine, seed, longer, finer
    place = observable, kind.name, engine
    kind = kind.under(runs.engines(kind.name)[engine].equation)
    if why := runs.refusal(*run):
        return Cell(*place, "not modelled", why)
    if observable in BALANCES:
        return _balance(place, BALANCES[observable](kind, runs.recorded(*run)))
    if why := undefined(observable, kind):
        try:
            measured(observable, runs.recorded(*run))
        except SceneError:
            return Cell(*place, "refused", why)
        return Cell(*place, "wrong", f"accepted, though {why}")
    if why := unmeasured(observable, kind, engine):
        return Cell(*place, "unknown", why)
    if why := unknown(observable, kind):
        worst = _beside_theory(observable, kind, runs.recorded(*run))
        return Cell(*place, "wrong", *worst) if worst else Cell(*place, "unknown", why)
    parts = right_parts(observable, kind)
    if not parts:
        return Cell(*place, "wrong", "has no right value")
    data, bound = runs.recorded(*run), stated_error(observable, kind, engine)
    deviations, results = {}, {}
    for part, right in parts.items():
        selection = selection_in(part)
        try:
            key = str(selection)
            results[key] = results[key] if key in results else measured(observable, data, **selection)
        except SceneError as error:
            return Cell(*place, "wrong", f"{part}: refused: {error.rule}")
        if not is_hardly_hit(observable, results[key], part):
            deviations[part] = deviation_of(observable, kind, results[key], part, right, bound)
    worst = max(deviations, key=lambda part: deviations[part][0])
    deviation, text = deviations[worst]
    if deviation <= LIMIT and (beside := _beside_theory(observable, kind, data)):
        return Cell(*place, "wrong", *beside)
    state = "value" if deviation <= LIMIT else "wrong"
    return Cell(*place, state, f"{worst}: {text}", deviation, len(parts))


def _balance(place, balance):
    """Return the cell of a balance."""
    if isinstance(balance, str):
        return Cell(*place, "unknown", balance)
    apart, error = balance
    deviation = float(np.max(np.abs(apart) / error))
    state = "value" if deviation <= 1.0 else "wrong"
    return Cell(*place, state, f"off by {deviation:.2g} times the rounding", deviation, apart.size)


def _beside_theory(observable, kind, data):
    """Return how a run deviates from its own theory, as a text and a number; None if they agree.

    A theory without an uncertainty is an approximation, which is not compared.
    """
    if "short" in kind.run and observable in LONG:
        return None  # after the first lags only
    try:
        result = measured(observable, data)
    except SceneError:
        return None
    key = result.attrs["quantity"]
    if result.theory is None:
        return None
    value, error = result[key], result[f"{key}_error"]
    freedom = result.get(f"{key}_freedom", result.attrs.get("freedom", RUN_FREEDOM))
    theory, unsure = result[f"{key}_theory"].values, result[f"{key}_theory_error"].values
    value, error, freedom = (
        np.broadcast_to(np.asarray(one, float), theory.shape) for one in (value, error, freedom)
    )
    stated = np.isfinite(theory) & np.isfinite(unsure) & np.isfinite(value) & np.isfinite(error)
    stated &= (error == 0.0) | (freedom >= FREEDOM)
    if not stated.any():
        return None
    value, error, freedom, theory, unsure = (one[stated] for one in (value, error, freedom, theory, unsure))
    deviation, text = compared(value, error, freedom, theory, unsure, independent=False)
    return None if deviation <= LIMIT else (f"theory: {text}", deviation)


def unmeasured(observable, kind, engine):
    """Return why a run of an engine says nothing of an observable, None if it does."""
    scene, settings = gp.Scene.from_dict(kind.scene), runs.engines(kind.name)[engine]
    try:
        require_modelled(observable, scene, settings)
    except SceneError as error:
        return f"{error.key}: {error.rule}"
    if kind.wide and "structure" in observable:
        return "waves down to a diameter are too many in so wide a container"
    if kind.wide and observable == "chemical_potential":
        return "a body that is inserted in so wide a container hardly ever overlaps"
    needs = OBSERVABLES[observable].needs
    if needs == "fluxes" and "correlations" not in runs.options(kind, scene, settings, kind.run["interval"]):
        return "the engine does not tally the stress of such a scene"
    return None


def measured(observable, data, **selection):
    """Return an observable of a run."""
    one = OBSERVABLES[observable]
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        return getattr(gp.analysis, one.function)(data, **one.arguments, **selection)


def selection_in(part):
    """Return the keyword arguments that the name of a part states: "axis=x,species=0"."""
    found = {}
    for key, _, value in (word.partition("=") for word in part.split(",") if "=" in word):
        found[key] = value if value.isalpha() else int(value) if value.isdigit() else float(value)
    return found


def is_hardly_hit(observable, result, part):
    """Return True for a face that is hit so rarely that a run states no error of its small force."""
    if observable not in ("force", "pressure"):
        return False
    value, error = (float(_at(part.split(","), one)) for one in (result.estimate, result.error))
    return math.isnan(error) and abs(value) < FAINT * float(abs(result.estimate).max())


def stated_error(observable, kind, engine):
    """Return the relative error of rates, and at walls, that an engine states before a run: a bound."""
    scene = gp.Scene.from_dict(kind.scene)
    return runs.engines(kind.name)[engine].predictions(scene).get(STATED.get(observable), 0.0)


def deviation_of(observable, kind, result, part, right, bound=0.0):
    """Return by how much a part of a result deviates, as a normal deviate, and the numbers as a text.

    bound: relative error that the engine states, of which `LIMIT` deviations are made
    """
    key = result.attrs["quantity"]
    value, error = result[key], result[f"{key}_error"]
    freedom = RUN_FREEDOM
    if f"{key}_freedom" in result:
        freedom = result[f"{key}_freedom"]
    elif "freedom" in result.attrs:
        freedom = float(result.attrs["freedom"])
    special = SPECIAL.get((observable, part)) or SPECIAL.get((observable, None))
    if special:
        at, known_error = special(kind, result, value)
    elif isinstance(right, dict):
        at, known_error = (np.array(right[name], float) for name in ("values", "errors"))
    else:
        at, known_error = right
    known_error = np.hypot(known_error, bound / LIMIT * np.abs(at))
    names_in = [word for word in part.split(",") if "=" not in word]
    if names_in and not special and part != "level":
        value, error, freedom = (_at(names_in, one) for one in (value, error, freedom))
    if part == "lag 0" or part.startswith("first "):
        at_lag = int(part.split()[1])
        chosen = slice(at_lag, at_lag + 1)
        value, error = value[chosen], error[chosen]
        freedom = freedom[chosen] if np.ndim(freedom) else freedom
    value, error = np.asarray(value, float), np.asarray(error, float)
    freedom = np.broadcast_to(np.asarray(freedom, float), value.shape)
    right, known_error = (np.broadcast_to(one, value.shape) for one in (at, known_error))
    independent = not (kind.points or kind.solid)  # neighbouring bins then hold the same bodies
    return compared(value, error, freedom, right, known_error, independent)


def _at(names_in, values):
    """Return the values at the names of a part, such as "x low", "0-1" or "y low" and "x"."""
    if not hasattr(values, "dims"):
        return values
    for name in names_in:
        for dim in values.dims:
            if name in [str(one) for one in values[dim].values]:
                index = [str(one) for one in values[dim].values].index(name)
                values = values.isel({dim: index})
                break
    return values


def compared(value, error, freedom, right, known_error, independent=True):
    """Return the deviation of values from right ones, each with errors, and the worst of them as a text.

    independent: False for places of a curve that may deviate together
    """
    total = np.hypot(error, known_error)
    exact = (total == 0.0) | ((known_error == 0.0) & (right == 0.0) & (value == 0.0))
    if exact.all():
        apart = np.abs(value - right).max() / max(np.abs(right).max(), EQUAL)
        return (0.0 if apart <= EQUAL else math.inf), f"{value.ravel()[0]:.6g}, right {right.ravel()[0]:.6g}"
    use = np.isfinite(value) & np.isfinite(right) & np.isfinite(total) & ~exact & ~(freedom < FREEDOM)
    filled = np.isfinite(value) & np.isfinite(right) & ((right != 0.0) | (known_error > 0.0))
    if use.sum() < max(1.0, LEAST * filled.sum()):
        return math.inf, "no value or no error in most places"
    with np.errstate(all="ignore"):
        ratio = np.where(use, (value - right) / total, 0.0)
        joint = total**4 / (error**4 / freedom + known_error**4 / SAMPLER_FREEDOM)
    chance = 2.0 * stats.t.sf(np.abs(ratio), np.nan_to_num(joint, nan=1.0))
    normal = stats.norm.isf(np.minimum(1.0, 0.5 * chance))
    at = np.unravel_index(np.argmax(np.where(use, normal, -1.0)), value.shape)
    worst = float(stats.norm.isf(0.5 * min(1.0, float(chance[at]) * use.sum())))
    spread = math.sqrt((np.minimum(normal[use], 40.0) ** 2).mean())
    if independent and use.sum() >= POINTS:
        worst = max(worst, LIMIT * spread / SPREAD)
    numbers = f"{value[at]:.5g} +- {error[at]:.2g}, right {right[at]:.5g} +- {known_error[at]:.2g}"
    return worst, f"{numbers} (worst of {use.sum()})"


def _speeds(kind, result, value):
    """Return the exact density of speeds in the bins of a result."""
    middle = result["speed"].values
    width = middle[1] - middle[0]
    edges = np.append(middle - 0.5 * width, middle[-1] + 0.5 * width)
    scale, case, f = 1.0, kind.case, kind.freedoms
    if f is None:  # bins up to four thermal speeds of the temperature of the run
        scale = edges[-1] / 4.0 * math.sqrt(min(group.mass for group in case.groups) / kind.temperature)
    edges = edges / scale
    x = np.linspace(0.0, 1.0, 33)[None] * np.diff(edges)[:, None] + edges[:-1, None]
    each = [
        group.count * closed.speed_density(kind.dimension, x, group.mass, kind.temperature, f)
        for group in case.groups
    ]
    density = np.trapezoid(sum(each), x, axis=1) / np.diff(edges) / case.count / scale
    return density, 0.0


def _of_a_particle(kind):
    """Return the D of a run of two equal species and its error: their mutual coefficient, exactly."""
    engine = {"exact": "event", "boltzmann": "dsmc"}.get(kind.equation, kind.equation)
    one = measured("D", runs.recorded(kind.name, engine))
    return float(one[one.attrs["quantity"]]), float(one[f"{one.attrs['quantity']}_error"])


def _lags(result):
    return np.asarray(result["lag"].values, float)


def _free(kind, lags):
    """Return the displacement squared and the velocity correlation over d of points at lags."""
    t, d, (one,) = kind.temperature, kind.dimension, kind.case.groups
    if kind.case.periodic.all():
        return d * t / one.mass * lags**2, np.full(len(lags), t / one.mass)
    moved, correlated = np.zeros(len(lags)), np.zeros(len(lags))
    for length in kind.case.box.lengths:
        places, speeds = closed.free_correlation(lags, length, one.mass, t, kind.freedoms)
        start = length**2 / 12.0
        moved, correlated = moved + 2.0 * (start - places), correlated + speeds / d
    return moved, correlated


SPECIAL = {
    ("speeds", None): _speeds,
    ("msd", "first 1"): lambda kind, result, value: (Short(kind).displacement(_lags(result)[1]), 0.0),
    ("vacf", "first 1"): lambda kind, result, value: (Short(kind).correlation(_lags(result)[1]), 0.0),
    ("mutual_diffusion", "D"): lambda kind, result, value: _of_a_particle(kind),
    ("msd", "curve"): lambda kind, result, value: (_free(kind, _lags(result))[0], 0.0),
    ("vacf", "curve"): lambda kind, result, value: (_free(kind, _lags(result))[1], 0.0),
}
"""Observables and parts whose right values depend on the places of the result."""


def names():
    """Return (kind of scene, engine) of all runs."""
    return [(name, engine) for name in kinds() for engine in runs.engines(name)]


def row_of(cell):
    """Return the row of the table of a cell; the text is the reason, if it is not a value."""
    valued = cell.state in ("value", "wrong")
    texts = {"deviation": f"{cell.deviation:.1f}" if valued else "", "text": "" if valued else cell.text}
    return {key: str(getattr(cell, key)) for key in COLUMNS} | texts


def write():
    """Write the file."""
    found = [row_of(cell) for run in names() for cell in cells(*run)]
    for name in kinds():
        not_modelled = runs.refusals(name).items()
        found += [row_of(Cell("(all)", name, engine, "not modelled", why)) for engine, why in not_modelled]
    FILE.parent.mkdir(parents=True, exist_ok=True)
    with FILE.open("w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, COLUMNS, lineterminator="\n")
        writer.writeheader()
        writer.writerows(found)


if __name__ == "__main__":
    write()
