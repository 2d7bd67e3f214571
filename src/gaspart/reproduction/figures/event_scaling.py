"""Cost of an event against the number of particles N, by search method."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

import numpy as np
import xarray as xr

from gaspart.keys import count, record
from gaspart.rendering import style
from gaspart.rendering.style import Axes, Figure
from gaspart.reproduction.claims import Claim
from gaspart.reproduction.figure import Parts
from gaspart.reproduction.figures._timings import SOURCE_C, per_event, trend
from gaspart.reproduction.figures.naive_scaling import OTHER_CAUSE, all_pairs
from gaspart.reproduction.points.point import Point
from gaspart.reproduction.table import Table, table

TITLE, CHAPTER = "Gain from space partitioning", "Speed and accuracy"
LAWS = {"pairs": (2.0, "4.2: all pairs"), "direct": (1.0, "4.3: a queue"), "boxes": (0.0, "4.4: sectors")}
"""Exponent of an event's cost in N by search method, and the section of source C that states it."""
SETTINGS = {
    "fit_from": record(
        {search: count(f"search `{search}`") for search in LAWS},
        "for each search the least number of particles in the fits",
    )
}


def measure(points: list[Point], settings: dict) -> xr.Dataset:
    """Measure the cost of an event, and its exponents in N by search method and dimension. The pair tests of
    the search "pairs" are compared with N(N-1)/2 for every event, plus one final search that finds no further
    event.
    """
    runs = sorted(
        (xr.load_dataset(point.path) for point in points),
        key=lambda run: (run.search, run.dimension, run.attrs["count"]),
    )
    costs = xr.concat(
        [per_event(run).isel(partition=0) for run in runs], "run", join="outer", compat="equals"
    )
    for name in ("search", "dimension", "count"):
        costs[name] = ("run", [run.attrs[name] for run in runs])
    gases = Table(costs, "run")
    methods = list(dict.fromkeys((run.search, run.dimension) for run in runs))
    pairs = gases[gases.search == "pairs"]
    every = 0.5 * pairs.count * (pairs.count - 1.0) * (pairs.events + 1.0) / pairs.events
    excess = np.abs(pairs.pair_tests / every - 1.0)
    exponents = table("method", methods, _exponents, gases, settings["fit_from"])
    return xr.merge([costs, exponents], join="outer", compat="no_conflicts").assign(
        pairs_excess=float(excess.max()) if excess.size else math.nan
    )


def _exponents(method: tuple[str, int], gases: Table, fit_from: dict[str, int]) -> dict[str, Any]:
    search, dimension = method
    same = (gases.search == search) & (gases.dimension == dimension)
    own = gases[same & (gases.count >= fit_from[search])]
    row = {"method_search": search, "method_dimension": dimension}
    exponents = trend(own.count, own.seconds.value), trend(own.count, own.pair_tests)
    return row | dict(zip(("exponent", "work_exponent"), exponents, strict=True))


def claims(dataset: xr.Dataset) -> Iterator[Claim]:
    """Yield the claims on the cost of an event; constant work may take longer in larger gases."""
    methods = Table(dataset, "method")
    yield all_pairs("all pairs, every event", methods.pairs_excess)
    for method in methods:
        power, section = LAWS[method.method_search]
        where = f'per event in N, search "{method.method_search}", {method.method_dimension}D'
        source = f"{SOURCE_C}, section {section}"
        yield Claim.within(
            f"exponent of the pair tests {where}", method.work_exponent, power, 0.05, source,
            "the search tests more particles than it should",
        )  # fmt: skip
        time = f"exponent of the time {where}", method.exponent
        if power > 0.0:
            yield Claim.within(*time, power, 0.2, source, OTHER_CAUSE)
        else:
            law = "constant work; caches", "the queue's cost grows with N"
            yield Claim.at_most(*time, 0.4, 0.1, *law)


NAMES = {"pairs": "all pairs", "direct": "queue, all particles", "boxes": "queue and sectors"}


def draw(dataset: xr.Dataset) -> Figure:
    """Draw pair tests and time per event against N, by search method."""
    figure, (top, bottom) = style.new((2.6,), (2.6,))
    runs = Table(dataset, "run")
    for kind, method in enumerate(Table(dataset, "method")):
        search, dimension = method.method_search, method.method_dimension
        own, power = runs[(runs.search == search) & (runs.dimension == dimension)], LAWS[search][0]
        hollow, label = dimension == 3, f"{NAMES[search]}, {dimension}D"
        style.points(top, own.count, own.pair_tests, kind=kind, hollow=hollow, label=label)
        style.points(bottom, own.count, own.seconds * 1e6, kind=kind, hollow=hollow)
        _guide(top, own.count, own.pair_tests, power, kind)
        if search != "boxes":
            _guide(bottom, own.count, own.seconds.value * 1e6, power, kind)
    for axis, label in ((top, "pair tests per event"), (bottom, "time per event (µs)")):
        axis.set(xscale="log", yscale="log", xlabel="number of particles $N$", ylabel=label)
    top.legend(loc="upper left")
    style.letters(top, bottom)
    return figure


def _guide(axis: Axes, count: np.ndarray, values: np.ndarray, power: float, kind: int) -> None:
    """Draw the expected power law through the last point."""
    axis.plot(count, values[-1] * (count / count[-1]) ** power, color=style.COLOURS[kind], lw=0.8, zorder=1)


FIGURES = {"event_scaling": Parts(SETTINGS, measure, claims, draw)}
