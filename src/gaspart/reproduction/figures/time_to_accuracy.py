"""Cheapest engine for each observable, density and accuracy, with its cost and all parts of the error.

Besides, measured costs are compared with the predictions of the model of `gaspart advise`, in gases that were
not used to fit the model.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from itertools import product

import numpy as np
import xarray as xr

from gaspart.accuracy import table
from gaspart.accuracy.of_engine import Candidate
from gaspart.accuracy.option import Option, fluid_option
from gaspart.accuracy.table import PRECISIONS, REFERENCE, STEP
from gaspart.analysis.estimate import Estimate
from gaspart.keys import COUNT, POSITIVE, count, list_of, names
from gaspart.rendering import style
from gaspart.rendering.style import Axes, Figure
from gaspart.reproduction.claims import Claim
from gaspart.reproduction.figure import Parts
from gaspart.reproduction.figures._flows import (
    FLOWS,
    claim_flows,
    compare_flows,
    flow_choices,
    flux_of,
    fraction_of,
    relaxation_of,
    speeds_of,
)
from gaspart.reproduction.figures._tradeoff import (
    ENGINES,
    NAMES,
    OBSERVABLES,
    PARTS,
    QUANTILE,
    Cells,
    Choice,
    Timing,
    Timings,
    by_engine,
    cells_by_fraction,
    choices,
    compare_steps,
    solver_of,
)
from gaspart.reproduction.points.point import Point
from gaspart.reproduction.table import Row, Table, entries
from gaspart.scene.facts import Gas
from gaspart.theory.bulk import EXACT

TITLE, CHAPTER = "Speed against accuracy", "Speed and accuracy"
COSTS = ["time_to_accuracy"]
SETTINGS = {
    "counts": list_of(COUNT, "numbers of particles; the first is that of the map"),
    "accuracies": list_of(POSITIVE, "relative accuracies of the cheapest settings"),
    "elsewhere": names("experiments of gases that the model of costs was not fitted to"),
    "cells": names("experiments of the Enskog model in its default cells"),
    "plates": names("experiments between a hot and a cold plate"),
    "plates_cost": names("timings of the experiments between plates"),
    "relaxation": names("experiments whose speeds are equal at first"),
    "blocks": count("stretches of each run between plates"),
}
QUANTITIES = (*OBSERVABLES, *FLOWS)


def measure(points: list[Point], settings: dict) -> xr.Dataset:
    """Measure the cost of a required accuracy, by engine: predictions of the model, and the map."""
    of_gases = [point for point in points if point.experiment not in settings["plates_cost"]]
    timed = Timings(of_gases)
    elsewhere = [point for point in points if point.experiment in settings["elsewhere"]]
    predicted = _predictions(compare_steps(elsewhere, timed), timed, settings)
    return predicted.merge(_map(points, settings, timed), join="outer", compat="no_conflicts")


def _predictions(rows: list[dict], timed: Timings, settings: dict) -> xr.Dataset:
    """Return the CPU time of the cheapest setting of each exact engine, measured and by the model. `regret`
    is the measured cost of the setting that the model chooses, divided by that of the best setting.
    """
    speeds = _speeds(timed)
    gases = sorted({(row["dimension"], row["packing_fraction"]) for row in rows})
    shape = (len(gases), len(OBSERVABLES), len(settings["counts"]), len(settings["accuracies"]))
    costs, regret = np.full((2, *shape, 2), np.nan), np.full((2, *shape), np.nan)
    for g, o, c in np.ndindex(shape[:3]):
        gas, observable = Gas(*gases[g], settings["counts"][c], 1.0, 1.0), OBSERVABLES[o]
        every = choices(gas, observable, timed, rows, None)
        exact = [choice for choice in every if choice.option.engine.equation == EXACT]
        steps = np.array([not choice.option.engine.reference for choice in exact])
        options = [(choice.option, _by_table(gas, choice, observable, speeds)) for choice in exact]
        for a, accuracy in enumerate(settings["accuracies"]):
            both = np.array([[option.cost(accuracy) for option in pair] for pair in options])
            for e, of in enumerate((both[~steps], both[steps])):
                if of.size:
                    costs[:, g, o, c, a, e] = of.min(axis=0)
            picked = int(np.argmin(both[:, 1]))
            if np.isfinite(both[picked, 1]):
                ratio = both[picked, 0] / both[:, 0].min()
                regret[:, g, o, c, a] = ratio, exact[picked].uncertainty * ratio
    axes = ("gas", "observable", "count", "accuracy")
    measured, model = np.where(np.isfinite(costs), costs, np.nan)
    return xr.Dataset(
        {
            "measured": ((*axes, "engine"), measured, {"units": "s"}),
            "model": ((*axes, "engine"), model, {"units": "s"}),
            "regret": (axes, regret[0]),
            "regret_error": (axes, regret[1]),
            "gas_dimension": ("gas", [dimension for dimension, _ in gases]),
            "gas_packing_fraction": ("gas", [fraction for _, fraction in gases]),
        },
        coords={
            "observable": list(OBSERVABLES),
            "count": settings["counts"],
            "accuracy": settings["accuracies"],
            "engine": ["event", "step"],
        },
    )


def _speeds(timed: Timings) -> dict[tuple[str, str], float]:
    """Compute this machine's time over the table's, in the reference gas, by engine and precision."""
    speeds = {}
    for timing in timed.of(3, REFERENCE):
        if timing.setting in ("event", *PRECISIONS):
            engine = "event" if timing.setting == "event" else "step"
            precision = PRECISIONS.get(timing.setting, "float64")
            at = 0 if engine == "event" else int(np.argmin(np.abs(timing.time_step - STEP)))
            here = timing.seconds.value[at] / timed.event(3, REFERENCE).contacts
            step = STEP * (engine == "step")
            speeds[engine, precision] = here / table.seconds(3, REFERENCE, engine, precision, step)
    return speeds


def _by_table(gas: Gas, choice: Choice, observable: str, speeds: dict) -> Option:
    """Return the option of a choice, but with errors and times from the table, on this machine."""
    engine, row = choice.option.engine, (gas.dimension, gas.packing_fraction)
    step = engine.quantum or 0.0  # in units with v_th = sigma = 1
    each = table.seconds(*row, engine.name, engine.precision, step) * speeds[engine.name, engine.precision]
    bias = 0.0 if engine.reference else table.bias(*row, engine.precision, step, observable)
    noise = QUANTILE**2 * table.noise(*row, observable)
    return fluid_option(gas, Candidate(engine, discretisation=bias), each, noise, 1.0, discarded=0.0)


def _map(points: Sequence[Point], settings: dict, timed: Timings) -> xr.Dataset:
    """Compute the costs of all engines in spheres of every timed density, and the parts of their errors. A
    cost is infinite if no setting is known to be as accurate, and NaN if the engine was not run. The errors
    of model and discretisation are bounds from theory, or from runs if there is no theory. `finite_size` is
    the remainder after theory's correction, `equilibration` a bound on the trace of the initial state, and
    `noise` 1.96 standard errors.
    """
    fractions = sorted({timing.gas[1] for timing in timed if timing.gas[0] == 3})
    cells, compared = cells_by_fraction(points, settings["cells"]), compare_steps(points, timed)
    flows = [flux_of(point, settings["blocks"]) for point in points if point.experiment in settings["plates"]]
    flows += [relaxation_of(point) for point in points if point.experiment in settings["relaxation"]]
    between: dict[float, dict[str, Estimate]] = {}  # CPU time per simulated time
    for point in points:
        if point.experiment in settings["plates_cost"]:
            (seconds,) = Timing(point).seconds
            between.setdefault(fraction_of(point), {})[solver_of(point.engine)] = seconds
    number, accuracies = settings["counts"][0], settings["accuracies"]
    shape = (len(QUANTITIES), len(fractions), len(accuracies), len(ENGINES))
    costs, parts = np.full((*shape, 2), np.nan), np.full((*shape, len(PARTS)), np.nan)
    for (q, quantity), (f, eta) in product(enumerate(QUANTITIES), enumerate(fractions)):
        if quantity in OBSERVABLES:
            gas = Gas(3, eta, number, 1.0, 1.0)
            of = list(choices(gas, quantity, timed, compared, cells.get(eta)))
        else:
            own = [flow for flow in flows if (flow.observable, flow.packing_fraction) == (quantity, eta)]
            of = []
            if own:
                speeds = between.get(eta, {}) if quantity == "heat_flux" else speeds_of(timed, own)
                of = list(flow_choices(own, number, speeds))
        enter(costs[q, f], parts[q, f], of, accuracies)
    axes = ("quantity", "fraction", "accuracy", "solver")
    dataset = xr.Dataset(
        {
            "cost": (axes, costs[..., 0], {"units": "s"}),
            "cost_error": (axes, costs[..., 1], {"units": "s"}),
            "error": ((*axes, "part"), parts, {"units": "1"}),
        },
        coords={
            "quantity": list(QUANTITIES),
            "fraction": fractions,
            "accuracy": accuracies,
            "solver": list(ENGINES),
            "part": list(PARTS),
        },
    )
    merged = dataset, compare_flows(flows, fractions), _by_fraction(timed, cells, fractions)
    return xr.merge(merged, join="outer", compat="no_conflicts")


def enter(costs: np.ndarray, parts: np.ndarray, of: list[Choice], accuracies: Sequence[float]) -> None:
    """Enter the cheapest choice of each engine into costs (A, E, 2), with errors, and parts (A, E, P)."""
    for e, engine in enumerate(ENGINES):
        own = [choice for choice in of if solver_of(choice.option.engine) == engine]
        for a, accuracy in enumerate(accuracies if own else ()):
            # the least biased choice, if no choice reaches the accuracy
            best = min(own, key=lambda choice: (choice.option.cost(accuracy), choice.option.bias))
            costs[a, e] = best.option.cost(accuracy) * np.array([1.0, best.uncertainty])
            parts[a, e] = list(best.parts(accuracy).values())


def _by_fraction(timed: Timings, cells: dict[float, Cells], fractions: list[float]) -> xr.Dataset:
    """Return the CPU time per contact with the cheapest step, and the effect of the Enskog model's cells."""
    each = np.full((2, len(fractions), len(ENGINES)), np.nan)
    for f, eta in enumerate(fractions):
        same = {timing.solver: timing for timing in timed.of(3, eta)}
        for e, engine in enumerate(ENGINES):
            if engine in same:
                seconds = same[engine].seconds / timed.event(3, eta).contacts
                best = seconds[np.argmin(seconds.value)]
                each[:, f, e] = best.value, best.error
    own = [cells.get(eta) for eta in fractions]
    unknown = Estimate(np.nan, np.nan, np.nan)
    columns = entries({"cells": Estimate.stack([cell.rate if cell else unknown for cell in own])})
    columns["cells_bound"] = np.array([cell.bound if cell else np.nan for cell in own])
    times = dict(zip(("each", "each_error"), each, strict=True))
    return xr.Dataset(
        {name: ("fraction", values, {"units": "1"}) for name, values in columns.items()}
        | {name: (("fraction", "solver"), values, {"units": "s"}) for name, values in times.items()}
    )


# Packing fractions: a gas is dilute or dense; the loss of collisions in cells is known (docs/dsmc.md).
THIN, THICK, KNOWN = 0.0011, 0.29, 0.4
FLOOR = 1e-3  # least accuracy for which costs are predicted: below it, measured errors hide those of steps


def claims(dataset: xr.Dataset) -> Iterator[Claim]:
    """Yield the claims on the map, on predicted costs, and on the settings that the model chooses."""
    yield from _dilute(Table(dataset.sel(quantity="collision_rate"), "fraction"))
    yield from _dense(Table(dataset, "fraction"))
    yield from claim_flows(dataset)
    gases = Table(dataset, "fraction")
    known = np.isfinite(gases.cells.value) & (gases.cells_bound > 0.0)  # a single cell loses no collisions
    for gas in gases[known & (gases.fraction <= KNOWN)]:
        yield Claim.within(
            "collision rate of the Enskog model in default cells over that of its equation, packing fraction "
            f"{gas.fraction:g}", gas.cells, 1.0, gas.cells_bound,
            "docs/dsmc.md: at most 0.5 over the particles in a cell",
            "pairs that approach become rarer in a cell than they are",
        )  # fmt: skip
    for engine in Table(dataset, "engine"):
        ratio = np.log(engine.model / engine.measured)  # gas, observable, count, accuracy
        ratio, independent = ratio[..., engine.accuracy >= FLOOR], ratio.shape[0] * ratio.shape[1]
        ratio = ratio[np.isfinite(ratio)]
        mean = Estimate(np.nan, np.nan)
        if ratio.size:
            mean = Estimate(ratio.mean(), ratio.std() / independent**0.5)
        yield Claim.within(
            f"ln of the model's cost over that measured, mean for {FLOOR:g} and more, {engine.engine} engine",
            mean, 0.0, 0.5, "gaspart.accuracy, fitted to other gases",
            "cost or errors do not lie between those of the neighbouring gases",
        )  # fmt: skip
    worst = dataset.regret.where(np.isfinite(dataset.regret)).argmax(...)
    yield Claim.at_most(
        "measured cost of the setting that the model chooses over the best one's, the worst of all",
        Row(dataset.isel(worst)).regret, 1.5, 0.3, "what `gaspart advise` promises",
        "the model chooses the wrong engine or time step",
    )  # fmt: skip


def _dilute(gases: Table) -> Iterator[Claim]:
    """Yield the claims that DSMC is cheaper in a dilute gas, and the more so the lower the density."""
    for at in gases[gases.fraction <= THIN]:
        accuracies = Table(at.dataset, "accuracy")
        for row in accuracies[np.isclose(accuracies.accuracy, 0.01)]:
            cost = by_engine(row, "cost")
            if np.isfinite(cost["event"].value):
                yield Claim.at_most(
                    "time of DSMC over that of events for 1 % of the collision rate, packing fraction "
                    f"{at.fraction:g}", cost["boltzmann"] / cost["event"], 0.1, 0.03,
                    "between two collisions a particle crosses many boxes by events, and none by DSMC",
                    "a collision of DSMC costs as much as tens of box crossings",
                )  # fmt: skip
    thin, other = (gases[np.isclose(gases.fraction, eta)] for eta in (1e-4, 1e-2))
    if thin and other:
        each = (by_engine(of[0], "each") for of in (thin, other))
        ratio = [costs["event"] / costs["boltzmann"] for costs in each]
        yield Claim.at_least(
            "time of a collision by events over that by DSMC, at packing fraction 0.0001 over 0.01",
            ratio[0] / ratio[1], 3.0, 1.0,
            "box crossings in a free path grow as the packing fraction to the power -2/3, by 22",
            "a particle's flight is followed through few boxes",
        )  # fmt: skip


def _dense(gases: Table) -> Iterator[Claim]:
    """Yield the claims that the Enskog model costs more than events, and errs in D."""
    for at in gases[gases.fraction >= THICK]:
        where, seconds = f"packing fraction {at.fraction:g}", by_engine(at, "each")
        yield Claim.at_least(
            f"time of a collision by the Enskog model over that by events, {where}",
            seconds["enskog"] / seconds["event"], 1.0, 0.2,
            "the model tries several pairs for one that collides; by events few are tested",
            "a search for contacts costs more than random trials",
        )  # fmt: skip
        if at.fraction <= 0.35:  # above, D divided by Enskog's D decreases again, and passes through 1
            error = at.dataset.error.sel(quantity="D", solver="enskog", part="model").isel(accuracy=0)
            yield Claim.at_least(
                f"error of the Enskog model in D, {where}", Estimate(float(error), 0.0), 0.01, 0.001,
                "[Erpenbeck 1991]", "the map offers the model for 1 % of D", kind="identity",
            )  # fmt: skip


TITLES = {
    "collision_rate": "collision rate",
    "Z": "compressibility factor $Z$",
    "D": "diffusion coefficient $D$",
    "heat_flux": "heat flux between plates",
    "relaxation": "relaxation of speeds",
}
PART_NAMES = ("model", "step, cells", "noise", "equilibration", "finite size")
# Colour of each engine, and the fraction of white in it, so that numbers on it are legible.
TINTS = {"event": (0, 0.65), "step": (1, 0.5), "boltzmann": (2, 0.6), "enskog": (2, 0.25)}
# Observable, packing fraction and accuracy of the errors that are drawn, or the nearest measured values.
PLACES = (("D", 0.01, 0.01), ("D", 0.3, 0.01))
HIGHEST = 1.6  # largest error that is drawn, divided by the accuracy


def draw(dataset: xr.Dataset) -> Figure:
    """Draw the cheapest engine and its cost, and the parts of the errors of each engine."""
    from matplotlib.patches import Patch

    figure, (*maps, errors) = style.new(*((2.0,),) * len(TITLES), (2.4,))
    for axis, letter, (quantity, title) in zip(maps, "abcde", TITLES.items(), strict=True):
        _draw_map(axis, dataset.sel(quantity=quantity))
        style.letter(axis, f"({letter}) {title}")
    _draw_parts(errors, dataset)
    style.letter(errors, "(f) parts of the error")
    figure.legend(
        handles=[Patch(facecolor=tint(engine), label=name) for engine, name in NAMES.items()],
        loc="outside upper center", ncols=4 if style.width() > style.COLUMN else 2,
        title=f"cheapest engine; time of a run of {dataset['count'].values[0]} spheres",
    )  # fmt: skip
    return figure


def tint(engine: str) -> tuple[float, float, float]:
    """Return the colour of an engine."""
    from matplotlib.colors import to_rgb

    kind, white = TINTS[engine]
    red, green, blue = (white + (1.0 - white) * part for part in to_rgb(style.COLOURS[kind]))
    return red, green, blue


def duration(seconds: float) -> str:
    """Format a time with one or two digits, in a unit that makes its number short."""
    units = (("ms", 1.0), ("s", 1e3), ("min", 6e4), ("h", 3.6e6), ("d", 8.64e7), ("y", 3.156e10))
    milliseconds = 1e3 * seconds
    unit, size = [step for step in units if step[1] <= max(milliseconds, 1.0) * 1.0001][-1]
    value = milliseconds / size
    return f"{float(f'{value:.{1 if value < 9.5 else 2}g}'):g} {unit}"


def cheapest_engine(dataset: xr.Dataset) -> Iterator[tuple[int, int, str, float]]:
    """Yield (fraction, accuracy, engine, cost) of one quantity where any engine was measured. The first two
    are indices. If no engine reaches the accuracy, the engine is "" and the cost infinite.
    """
    cost = Row(dataset).cost.value  # indices: fraction, accuracy, solver
    for f, a in np.ndindex(*cost.shape[:2]):
        if not np.isnan(cost[f, a]).all():
            best = int(np.nanargmin(cost[f, a]))
            least = float(cost[f, a, best])
            yield f, a, ENGINES[best] if np.isfinite(least) else "", least


def _draw_map(axis: Axes, dataset: xr.Dataset) -> None:
    """Draw a field for each density and accuracy, in the colour of the cheapest engine, with its cost."""
    gas, fields = Row(dataset), list(cheapest_engine(dataset))
    columns = sorted({f for f, *_ in fields})
    colours = np.ones((len(gas.accuracy), max(1, len(columns)), 3))
    for f, y, engine, seconds in fields:
        x = columns.index(f)
        colours[y, x] = tint(engine) if engine else (1.0, 1.0, 1.0)
        text = duration(seconds) if engine else "–"
        axis.text(x + 0.5, y + 0.5, text, ha="center", va="center", fontsize=5.6)
    edges = map(np.arange, np.add(colours.shape[1::-1], 1))
    axis.pcolormesh(*edges, colours, edgecolor="white", linewidth=0.5)
    axis.set_xticks(np.arange(len(columns)) + 0.5, [_fraction(gas.fraction[f]) for f in columns])
    percent = [f"{100.0 * value:g}" for value in gas.accuracy]
    axis.set_yticks(np.arange(len(percent)) + 0.5, percent)
    axis.tick_params(length=0)
    style.label_axes(axis, r"packing fraction $\eta$", "accuracy (%)")


def _fraction(value: float) -> str:
    """Return a packing fraction as text, a small one as a power of ten."""
    return rf"$10^{{{round(math.log10(value))}}}$" if value < 0.005 else f"{value:g}"


def places(dataset: xr.Dataset) -> list[Row]:
    """Return the distinct `PLACES`, or the measured values nearest to them."""
    rows: dict[tuple[str, float, float], Row] = {}
    for quantity, fraction, accuracy in PLACES:
        of = dataset.sel(quantity=quantity)
        of = of.isel(fraction=np.isfinite(of.cost).any(("accuracy", "solver")).values)
        if of.sizes["fraction"]:
            of = of.isel(fraction=_nearest(of.fraction, fraction))
            at = Row(of.isel(accuracy=_nearest(of.accuracy, accuracy)))
            rows.setdefault((quantity, float(at.fraction), float(at.accuracy)), at)
    return list(rows.values())


def _nearest(values: xr.DataArray, target: float) -> int:
    return int(np.argmin(np.abs(np.log(values.values / target))))


def _draw_parts(axis: Axes, dataset: xr.Dataset) -> None:
    """Draw errors divided by the required accuracy at the `PLACES`, by engine and cause."""
    from matplotlib.patches import Patch

    rows: list[tuple[float, str]] = []
    for p, at in enumerate(places(dataset)):
        top = -(len(ENGINES) + 1.5) * p
        title = rf"${at.quantity}$ to {100 * at.accuracy:g} % at $\eta={at.fraction:g}$"
        axis.text(0.03, top, title, va="center")
        for e, (engine, parts) in enumerate(zip(at.solver, at.error, strict=True)):
            rows.append((top - 1.0 - e, NAMES[engine]))
            _stack(axis, rows[-1][0], list(parts / at.accuracy))
    line = axis.axvline(1.0, color="black", linewidth=0.8, label="required")
    patches = [Patch(facecolor=style.COLOURS[kind], label=name) for kind, name in enumerate(PART_NAMES)]
    axis.legend(handles=[*patches, line], loc="center right", fontsize=7)
    axis.set_yticks(*zip(*rows, strict=True) if rows else ([], []))
    axis.set_ylim(rows[-1][0] - 0.7 if rows else -1.0, 0.7)
    axis.set_xticks([0.0, 0.5, 1.0, 1.5])
    axis.set_xlim(0.0, 2.4 * HIGHEST)  # with space for the legend
    axis.tick_params(axis="y", length=0)
    axis.set_xlabel("error / required accuracy")


def _stack(axis: Axes, y: float, parts: list[float]) -> None:
    """Draw a stacked bar of parts, truncated at `HIGHEST` and then labelled with its length."""
    low = 0.0
    for kind, part in enumerate(parts):
        if math.isfinite(part) and low < HIGHEST:
            end = min(low + part, HIGHEST)
            axis.barh(y, end - low, left=low, color=style.COLOURS[kind], height=0.8)
            low = end
    total = float(np.nansum(parts))
    if total > HIGHEST:
        axis.text(HIGHEST + 0.04, y, f"{float(f'{total:.2g}'):g}", ha="left", va="center", fontsize=6.5)


FIGURES = {"time_to_accuracy": Parts(SETTINGS, measure, claims, draw)}
