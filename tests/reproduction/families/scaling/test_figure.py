"""The scaling figures draw the columns of their data sets, also where the time has no minimum."""

import math

import numpy as np
import pytest
from reproduction.families.drawn import Points, draw, follows, line, lines, obeys, shows, varied
from reproduction.families.scaling.data import points, settings

from gaspart.reproduction.families.scaling import figure as scaling
from gaspart.reproduction.families.scaling import measure as measured

IDEAL = ("ideal", "ideal_low", "ideal_high")


@pytest.fixture
def measure(tmp_path):
    """Draws a figure of made-up costs. Returns its varied data set and its panels."""

    def drawn(figure, *kept):
        ds = varied(getattr(measured, figure)(points(figure, tmp_path), settings(figure)), *kept)
        return ds, draw(getattr(scaling, figure), ds).axes

    return drawn


def timed(label, x, dataset, name="seconds", scale=1.0):
    """Points of a time with its error; scale: a factor of both, which may be an array."""
    return Points(label, x, scale * dataset[name], scale * dataset[f"{name}_error"])


def test_naive_scaling(measure):
    ds, (step, test) = measure("naive_scaling")
    shows(step, "", "time per step (ms)", timed("measured", ds["count"], ds, scale=1e3))
    shows(
        test, "number of particles", "test (ns)", timed(None, ds["count"], ds, scale=1e9 / ds["pair_tests"])
    )
    each = float(ds["test_seconds"])
    obeys(line(step, "each once"), lambda n: 1e3 * each * 0.5 * n * (n - 1.0))
    obeys(line(step, "scanned 27"), lambda n: 27e3 * each * 0.5 * n * (n - 1.0))


def test_box_count(measure):
    ds, (time, work, widths, sectors) = measure("box_count", "container_side")
    boxes = ds["boxes_per_side"].astype(float) ** 3
    reached = ds["near_boxes_per_side"].astype(float) ** 3
    shows(
        time, "", "time per particle", timed("measured", boxes, ds, scale=1e9),
        timed("within reach", reached, ds, "near_seconds", 1e9),
    )  # fmt: skip
    near = (ds["seconds"] <= 3.0 * ds["seconds"].min()).values
    model = ds["particle_seconds"] + ds["test_seconds"] * ds["pair_tests"]
    model = model + ds["box_seconds"] * ds["boxes_emptied"]
    follows(line(time, "tests"), boxes[near], 1e9 * model[near])
    shows(
        work, "number of boxes", "per particle", Points("pair tests", boxes, ds["pair_tests"]),
        Points("boxes searched", boxes, ds["box_visits"]),
        Points("boxes emptied", boxes, ds["boxes_emptied"]),
        Points("within reach", reached, ds["near_box_visits"]),
    )  # fmt: skip
    for curve, name in zip(
        lines(work), ("expected_tests", "expected_visits", "in_reach", "touched"), strict=True
    ):
        follows(curve, boxes, ds[name])
    first, second = (ds.isel(container=k) for k in (0, 1))
    ratio = first["fine_seconds"] / second["fine_seconds"]
    error = ratio * np.hypot(
        first["fine_seconds_error"] / first["fine_seconds"],
        second["fine_seconds_error"] / second["fine_seconds"],
    )
    chosen = np.isin(first["fine_boxes_per_side"], ds["round_per_side"])
    places = np.arange(chosen.size)
    shows(
        widths, "boxes per side", "time, side", Points(None, places[~chosen], ratio[~chosen], error[~chosen]),
        Points("boxes of width", places[chosen], ratio[chosen], error[chosen]),
    )  # fmt: skip
    number = ds["sector_boxes_per_side"].astype(float) ** 2
    names = {"pair tests": "pair_tests", "sectors searched": "box_visits", "crossings": "crossings"}
    shows(
        sectors, "number of sectors", "per event",
        *(Points(label, number, ds[f"sector_{name}"]) for label, name in names.items()),
        timed("time", number, ds, "sector_seconds", 1e6),
    )  # fmt: skip


def test_a_scan_without_a_minimum(tmp_path):
    ds = measured.box_count(points("box_count", tmp_path), settings("box_count"))
    ds["ideal_low"], ds["ideal_high"] = 0.0, math.inf
    assert len(draw(scaling.box_count, ds).axes[0].patches) == 0


def test_ideal_boxes(measure):
    ds, (ideal, time) = measure("ideal_boxes", "radius", "series_radius", *IDEAL)
    expected = []
    for radius in ds["series_radius"].values:
        own = ds.isel(gas=(ds["radius"] == radius).values)
        count, interior = own["count"], own["ideal_interior"].astype(bool)
        best, low, high = (own[name] * count for name in ("ideal", "ideal_low", "ideal_high"))
        found = (interior & np.isfinite(high) & (low > 0.0)).values
        bars = np.array([best - low, high - best])[:, found]
        vague, rest = (interior & ~found).values, ~interior.values
        expected += [
            Points(f"ideal, $r = {radius:g}$", count[found], best[found], bars),
            Points(None, count[vague], best[vague]),
            Points(None, count[rest], best[rest], np.array([0.0 * best[rest], 0.6 * best[rest]])),
        ]
    shows(ideal, "number of particles", "ideal number", *expected)
    series = []
    for gas in (1, *ds["source_gas"].values):
        one = ds.isel(gas=int(gas))
        scale = 1.0 / float(one["seconds"].min())
        radius = float(one["radius"])
        series.append(timed(f"$r = {radius:g}$".lstrip("$"), one["boxes_per_particle"], one, scale=scale))
    shows(time, "boxes per particle", "time over", *series)


def test_linear_scaling(measure):
    ds, (step, particle, work) = measure("linear_scaling", "radius", "list_radius")
    steps, particles, counted = [timed("one box", ds["naive_count"], ds, "naive_seconds")], [], []
    for radius in sorted(set(ds["radius"].values), reverse=True):
        own = ds.isel(gas=(ds["radius"] == radius).values)
        count = own["count"]
        steps.append(timed(f"cheapest partition, $r = {radius:g}$", count, own, scale=count))
        particles.append(timed(None, count, own, scale=1e9))
        counted += [Points(None, count, own["box_visits"]), Points(None, count, own["pair_tests"])]
    for k, radius in enumerate(sorted(set(ds["list_radius"].values), reverse=True)):
        own = ds.isel(listed=(ds["list_radius"] == radius).values)
        count = own["list_count"]
        steps.append(timed(None if k else "neighbour list", count, own, "list_seconds", count))
        particles.append(timed(None, count, own, "list_seconds", 1e9))
        counted.append(Points(None, count, own["list_pair_tests"]))
    shows(step, "", "time per step", *steps)
    shows(particle, "", "time per particle", *particles)
    shows(work, "number of particles", "per particle", *counted)


def test_event_scaling(measure):
    ds, (work, time) = measure("event_scaling")
    names = {"pairs": "all pairs", "direct": "queue, all particles", "boxes": "queue and sectors"}
    tests, times = [], []
    for search, dimension in zip(ds["method_search"].values, ds["method_dimension"].values, strict=True):
        own = ds.isel(run=((ds["search"] == search) & (ds["dimension"] == dimension)).values)
        tests.append(Points(f"{names[search]}, {dimension}D", own["count"], own["pair_tests"]))
        times.append(timed(None, own["count"], own, scale=1e6))
    shows(work, "", "pair tests", *tests)
    shows(time, "number of particles", "time per event", *times)
