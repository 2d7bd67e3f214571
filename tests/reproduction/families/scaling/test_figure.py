"""The scaling figures draw the columns of their data sets, also where the time has no minimum."""

import math

import numpy as np
import pytest
from reproduction.families.drawn import Points, draw, shows, varied

from gaspart.reproduction.families.scaling import figure as scaling

IDEAL = ("ideal", "ideal_low", "ideal_high")


@pytest.fixture
def measure(dataset):
    """Draws a figure of made-up costs. Returns its varied data set and its panels."""

    def drawn(figure, *kept):
        ds = varied(dataset(figure), *kept)
        return ds, draw(getattr(scaling, figure), ds).axes

    return drawn


def timed(x, dataset, name="seconds", scale=1.0):
    """Points of a time with its error; scale: a factor of both, which may be an array."""
    return Points(x, scale * dataset[name], scale * dataset[f"{name}_error"])


def test_naive_scaling(measure):
    ds, (step, test) = measure("naive_scaling")
    shows(step, timed(ds["count"], ds, scale=1e3))
    shows(test, timed(ds["count"], ds, scale=1e9 / ds["pair_tests"]))


def test_box_count(measure):
    ds, (time, work, widths, sectors) = measure("box_count", "container_side")
    boxes = ds["boxes_per_side"].astype(float) ** 3
    reached = ds["near_boxes_per_side"].astype(float) ** 3
    shows(time, timed(boxes, ds, scale=1e9), timed(reached, ds, "near_seconds", 1e9))
    counted = [Points(boxes, ds[name]) for name in ("pair_tests", "box_visits", "boxes_emptied")]
    shows(work, *counted, Points(reached, ds["near_box_visits"]))
    first, second = (ds.isel(container=k) for k in (0, 1))
    ratio = first["fine_seconds"] / second["fine_seconds"]
    relative = [one["fine_seconds_error"] / one["fine_seconds"] for one in (first, second)]
    error = ratio * np.hypot(*relative)
    chosen = np.isin(first["fine_boxes_per_side"], ds["round_per_side"])
    places = np.arange(chosen.size)
    shows(
        widths,
        Points(places[~chosen], ratio[~chosen], error[~chosen]),
        Points(places[chosen], ratio[chosen], error[chosen]),
    )
    number = ds["sector_boxes_per_side"].astype(float) ** 2
    counted = [Points(number, ds[f"sector_{name}"]) for name in ("pair_tests", "box_visits", "crossings")]
    shows(sectors, *counted, timed(number, ds, "sector_seconds", 1e6))
    ds["ideal_low"], ds["ideal_high"] = 0.0, math.inf  # a scan without a minimum
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
            Points(count[found], best[found], bars),
            Points(count[vague], best[vague]),
            Points(count[rest], best[rest], np.array([0.0 * best[rest], 0.6 * best[rest]])),
        ]
    shows(ideal, *expected)
    series = []
    for gas in (1, *ds["source_gas"].values):
        one = ds.isel(gas=int(gas))
        scale = 1.0 / float(one["seconds"].min())
        series.append(timed(one["boxes_per_particle"], one, scale=scale))
    shows(time, *series)


def test_linear_scaling(measure):
    ds, (step, particle, work) = measure("linear_scaling", "radius", "list_radius")
    steps, particles, counted = [timed(ds["naive_count"], ds, "naive_seconds")], [], []
    for radius in sorted(set(ds["radius"].values), reverse=True):
        own = ds.isel(gas=(ds["radius"] == radius).values)
        count = own["count"]
        steps.append(timed(count, own, scale=count))
        particles.append(timed(count, own, scale=1e9))
        counted += [Points(count, own["box_visits"]), Points(count, own["pair_tests"])]
    for radius in sorted(set(ds["list_radius"].values), reverse=True):
        own = ds.isel(listed=(ds["list_radius"] == radius).values)
        count = own["list_count"]
        steps.append(timed(count, own, "list_seconds", count))
        particles.append(timed(count, own, "list_seconds", 1e9))
        counted.append(Points(count, own["list_pair_tests"]))
    shows(step, *steps)
    shows(particle, *particles)
    shows(work, *counted)


def test_event_scaling(measure):
    ds, (work, time) = measure("event_scaling")
    tests, times = [], []
    for search, dimension in zip(ds["method_search"].values, ds["method_dimension"].values, strict=True):
        own = ds.isel(run=((ds["search"] == search) & (ds["dimension"] == dimension)).values)
        tests.append(Points(own["count"], own["pair_tests"]))
        times.append(timed(own["count"], own, scale=1e6))
    shows(work, *tests)
    shows(time, *times)
