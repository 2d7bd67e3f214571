"""Cost of a step with one box against the number of particles N: all pairs are tested."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import xarray as xr

from gaspart.rendering import style
from gaspart.rendering.style import Figure
from gaspart.reproduction.claims import Claim, Estimate
from gaspart.reproduction.figure import Parts
from gaspart.reproduction.figures._timings import SOURCE_A, median, trend, weights
from gaspart.reproduction.points.point import Point
from gaspart.reproduction.table import Table, entries

TITLE, CHAPTER = "Gain from space partitioning", "Speed and accuracy"
SCAN = 27  # source A's program scans its single box once for each of the surrounding boxes
SOURCE_COLOUR = style.COLOURS[4]


def measure(points: list[Point], settings: dict) -> xr.Dataset:
    """Measure pair tests and time of a step, and fit time = a N + b tests."""
    dataset = one_box([xr.load_dataset(point.path) for point in points])
    gases = Table(dataset, "count")
    count, tests = gases.count.astype(float), gases.pair_tests
    parts = weights(gases.seconds, count, tests)
    exponent, test = trend(count, gases.seconds.value), (parts.values[1], parts.errors[1])
    excess = np.abs(tests / (0.5 * count * (count - 1.0)) - 1.0).max()
    return dataset.assign(**entries({"exponent": exponent, "test_seconds": test}), tests_excess=excess)


def one_box(runs: list[xr.Dataset]) -> xr.Dataset:
    """Return pair tests and time of one step with one box, over `count`."""
    runs = sorted(runs, key=lambda run: run.attrs["count"])
    steps = np.array([int(run.steps[0]) for run in runs])
    times = np.array([median(run.seconds.values[0]) for run in runs]).reshape(-1, 2) / steps[:, None]
    tests = np.array([int(run.pair_tests[0]) for run in runs]) / steps
    return xr.Dataset(
        {
            "pair_tests": ("count", tests, {"units": "1"}),
            "seconds": ("count", times[:, 0], {"units": "s"}),
            "seconds_error": ("count", times[:, 1], {"units": "s"}),
        },
        coords={"count": [run.attrs["count"] for run in runs]},
    )


OTHER_CAUSE = "something other than the pair tests takes the time"


def claims(dataset: xr.Dataset) -> Iterator[Claim]:
    """Yield the claims on quadratic cost: exact for pair tests, approximate for time (by caches)."""
    gases = Table(dataset, "count")
    yield all_pairs("one box, every step", gases.tests_excess)
    yield Claim.within(
        "exponent of the time per step in N, one box", gases.exponent, 2.0, 0.15, f"{SOURCE_A}, figure 3",
        OTHER_CAUSE,
    )  # fmt: skip


def all_pairs(subject: str, excess: float) -> Claim:
    """Return the claim that counted pair tests are N(N-1)/2."""
    return Claim(
        f"{subject}: largest relative difference of the pair tests from N(N-1)/2", Estimate(excess), 0.0,
        1e-12, "each pair once", "a pair is tested twice, or not at all", kind="identity",
    )  # fmt: skip


def draw(dataset: xr.Dataset) -> Figure:
    """Draw the time of a step against N, and the time per pair test."""
    figure, (top, bottom) = style.new((2.4, 1.3))
    gases = Table(dataset, "count")
    count, test = gases.count, gases.test_seconds.value
    line = np.geomspace(count.min(), count.max(), 50)
    law = 0.5 * line * (line - 1.0) * test
    scans = "scanned 27 times (Frederickx & Meerts)"
    top.plot(line, SCAN * law * 1e3, color=SOURCE_COLOUR, linestyle="--", label=scans)
    top.plot(line, law * 1e3, color=style.REFERENCE, label=r"$\frac{1}{2}N(N-1)$ tests, each once")
    style.points(top, count, gases.seconds * 1e3, color=style.DATA, label="measured")
    top.set(xscale="log", yscale="log")
    style.label_axes(top, y="time per step (ms)", legend="upper left")
    each = gases.seconds * (1e9 / gases.pair_tests)
    style.level(bottom, test * 1e9)
    style.points(bottom, count, each, color=style.DATA)
    limits = (0.0, 1.6 * each.value.max())
    style.label_axes(bottom, "number of particles $N$", "time per test (ns)", ylim=limits)
    style.letters(top, bottom)
    return figure


FIGURES = {"naive_scaling": Parts({}, measure, claims, draw)}
