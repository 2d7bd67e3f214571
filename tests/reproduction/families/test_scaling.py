"""Jobs of a machine whose every cost is known, for the tests of the scaling figures."""

from __future__ import annotations

import math
from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from reproduction.claims.data import judged
from reproduction.families.drawn import Points, draw, shows, varied

from gaspart.reproduction import claims as core
from gaspart.reproduction.claims import judge
from gaspart.reproduction.config import merged_with_default
from gaspart.reproduction.families.scaling import claims as claims_of_scaling
from gaspart.reproduction.families.scaling import figure as draw_scaling
from gaspart.reproduction.families.scaling import measure as measure_scaling
from gaspart.reproduction.families.scaling.claims import ideal_boxes, remarks
from gaspart.reproduction.points.points import all_points, figure_points
from gaspart.theory import partition

ROOT = Path(__file__).parents[3]
PARTICLE, TEST, BOX, LIST = (
    30e-9,
    12e-9,
    0.3e-9,
    2e-9,
)  # s per particle and step (with a list), pair test, box
NEAR, CONTACTS = 20e-9, 10  # s per particle and step to leave out boxes; contacts in a timing
CONFIG, _ = merged_with_default(ROOT / "config/config.yaml")
SCALING = ("naive_scaling", "box_count", "ideal_boxes", "linear_scaling", "event_scaling")


def settings(figure):
    return {key: value for key, value in CONFIG["figures"][figure].items() if key != "experiments"}


def points(figure, folder):
    """The figure's points, with their files written below `folder`."""
    config = {**CONFIG, "points": str(folder)}
    made = figure_points(config, figure, all_points(config))
    for point in made:
        path = Path(point.path)
        path.parent.mkdir(parents=True, exist_ok=True)
        job(point).to_netcdf(path)
    return made


def job(point):
    """What `measure_cost` would write, with 1 % noise of the clock."""
    if "without" in point.settings:
        return _in_turn(point)
    count, radius, lengths = point.extents
    dimension, side = len(lengths), lengths[0]
    chosen = point.engines
    sides = np.array([_side(engine) for engine in chosen])
    gas = {"dimension": dimension, "side": side, "radius": radius}
    if point.settings["engine"] == "step":
        counted = _steps(count, tuple(np.maximum(sides, 1).tolist()), **gas)
        particle = PARTICLE
        if not sides.any():  # a list of one pair a particle
            particle, counted = LIST, {**counted, "pair_tests": np.array([10 * count])}
        seconds = 10 * (particle * count + BOX * sides**dimension) + TEST * counted["pair_tests"]
    else:
        counted = _events(count, sides, getattr(chosen[0], "search", ""), gas)
        seconds = TEST * counted["pair_tests"] + 4e-7 * counted["collisions"]
    rng = np.random.default_rng((count, *point.name.encode()))
    noise = 1.0 + 0.01 * rng.standard_normal((sides.size, 5))
    return xr.Dataset(
        {
            "seconds": (("partition", "repeat"), seconds[:, None] * noise),
            "boxes": ("partition", sides**dimension),
            "boxes_per_side": ("partition", sides),
            **{name: ("partition", values) for name, values in counted.items()},
        },
        attrs={
            "count": count,
            "dimension": dimension,
            "radius": radius,
            "side": side,
            "packing_fraction": 0.1,
            "engine": point.settings["engine"],
            "search": getattr(chosen[0], "search", ""),
            "time_step": 0.01,
        },
    )


def _in_turn(point):
    """A gas and, in turn, the same one: with a search of near boxes only, or without a huge sphere."""
    alone = {key: value for key, value in point.settings.items() if key != "without"}
    own, beside = (job(replace(point, settings=alone, name=name)) for name in (point.name, "beside"))
    count = own.attrs["count"]
    if "near_boxes" in point.settings:
        reached = partition.boxes_in_reach(own.side / own.boxes_per_side, 2.0 * own.radius, own.dimension)
        own["box_visits"] = np.round(5 * count * (1.0 + reached))
        own["seconds"] = own["seconds"] + 10 * NEAR * count
    else:
        beside["pair_tests"] = beside["pair_tests"] + 10 * count
        beside["seconds"] = beside["seconds"] + 10 * TEST * count
    return xr.concat([own, beside], "partition", combine_attrs="override")


def _side(engine):
    given = engine.boxes_per_side or (0 if engine.name == "step" else 1)
    return given[0] if isinstance(given, tuple) else given


@cache
def _steps(count, sides, dimension, side, radius):
    tests = [partition.expected_pair_tests(count, n, dimension, side, radius)[0] for n in sides]
    visits = [count * partition.expected_box_visits(n, dimension, side, radius) for n in sides]
    zeros = np.zeros(len(sides), dtype=int)
    return {
        "steps": zeros + 10,
        "collisions": zeros + CONTACTS,
        "wall_hits": zeros,
        "crossings": zeros,
        "pair_tests": np.round(10 * np.array(tests)).astype(int),
        "box_visits": np.round(10 * np.array(visits)).astype(int),
    }


def _events(count, sides, search, gas):
    near = (count - 1.0) * partition.neighbour_share(sides, **gas)
    crossings = 10.0 * (sides - 1.0)
    events = 1000
    tests = {
        "pairs": (events + 1) * count * (count - 1) / 2 + 0.0 * near,
        "direct": 2.0 * events * near,
        "boxes": near * (2.0 * events + crossings / 3.0) if sides.max() > 1 else 20.0 * events + 0.0 * near,
    }["boxes" if search == "automatic" else search]
    whole = np.ones(sides.size, dtype=int)
    return {
        "steps": 0 * whole,
        "collisions": (events - 10) * whole,
        "wall_hits": 10 * whole,
        "crossings": np.round(crossings).astype(int),
        "pair_tests": np.round(tests).astype(int),
        "box_visits": 20 * events * whole,
    }


# The scaling figures' measurements, on jobs whose costs are known.


@pytest.fixture(scope="session")
def dataset(tmp_path_factory):
    """Returns a copy of a figure's data set, which is measured once."""
    made = {}

    def of(figure):
        if figure not in made:
            folder = tmp_path_factory.mktemp(figure)
            made[figure] = getattr(measure_scaling, figure)(points(figure, folder), settings(figure))
        return made[figure].copy(deep=True)

    return of


def test_naive_scaling(dataset):
    ds = dataset("naive_scaling")
    assert float(ds.tests_excess) == 0.0
    assert float(ds.exponent) == pytest.approx(2.0, abs=0.02)
    assert float(ds.test_seconds) == pytest.approx(TEST, rel=0.03)


def test_box_count(dataset):
    ds = dataset("box_count")
    ideal = math.sqrt(13.5 * TEST / BOX)
    assert float(ds.ideal) == pytest.approx(ideal, rel=0.3)
    assert float(ds.model) == pytest.approx(ideal, rel=0.1)
    assert (ds.pair_tests / ds.expected_tests).values == pytest.approx(1.0, rel=1e-3)
    assert (np.abs(ds.advantage) < 4.0 * ds.advantage_error).all()
    assert float(ds.event_searches) == pytest.approx(2.0, rel=0.01)
    assert float(ds.crossing_searches) == pytest.approx(1.0 / 3.0, rel=0.01)
    assert float(ds.crossing_exponent) == pytest.approx(1.0, rel=1e-3)


def test_linear_scaling(dataset):
    ds = dataset("linear_scaling")
    assert float(ds.work_exponent) == pytest.approx(1.0, abs=0.02)
    assert ds.exponent.values == pytest.approx(1.0, abs=0.06)
    assert ds.list_pair_tests.values == pytest.approx(1.0)
    assert ds.list_seconds.values == pytest.approx(LIST + TEST, rel=0.03)
    assert (ds.list_share.values < 0.5).all()  # boxes cost PARTICLE at least, and some tests
    count = float(ds.extrapolated_count)
    assert float(ds.extrapolated_seconds) == pytest.approx(TEST * count * (count - 1) / 2, rel=0.03)


def test_event_scaling(dataset):
    ds = dataset("event_scaling")
    work = dict(zip(ds.method_search.values.tolist(), ds.work_exponent.values.tolist(), strict=True))
    assert work["pairs"] == pytest.approx(2.0, abs=0.01)
    assert work["direct"] == pytest.approx(1.0, abs=0.01)
    assert work["boxes"] == pytest.approx(0.0, abs=0.01)
    assert float(ds.pairs_excess) < 1e-12


def test_remarks(dataset):
    """On a machine on which it costs more to leave out boxes than to look into them."""
    ds = dataset("box_count")
    assert (ds.near_box_visits / ds.near_expected_visits).values == pytest.approx(1.0, abs=1e-3)
    least = PARTICLE + 2.0 * math.sqrt(13.5 * TEST * BOX)
    assert float(ds.near_least) == pytest.approx(1.0 + NEAR / least, rel=0.03)
    assert float(ds.near_least_freedom) == 7.0
    assert float(ds.near_missed) == 0.0
    assert float(ds.own_first) == pytest.approx(2.0 * CONTACTS / 1e5 * 0.917, rel=0.01)
    assert float(ds.huge_tests) == pytest.approx(1.0)
    assert float(ds.huge_ratio) == pytest.approx(1.0 + TEST / (PARTICLE + 12.5 * BOX + 1.05 * TEST), rel=0.01)


def test_ideal_boxes(dataset):
    ds = dataset("ideal_boxes")
    ideal = math.sqrt(13.5 * TEST / BOX)
    found = ds.ideal_interior.values.astype(bool)
    assert ds.ideal.values[found] == pytest.approx(ideal, rel=0.3)
    assert not found[ds["count"].values == 1_200_000].any()  # the limit of a diameter a box is below it
    assert ds.most.values[ds["count"].values == 1_200_000] == pytest.approx(13.02, abs=0.01)
    assert float(ds.exponent[0]) == pytest.approx(1.0, abs=0.15)
    assert ds.source_number.values.tolist() == [10, 7, 10]


def test_plateaus(dataset):
    """The gas farthest from the ideal number pays most, where that number follows N."""
    ds = dataset("ideal_boxes")
    plateau = ds.isel(plateau=0)
    assert plateau.plateau_boxes == 25**3 and plateau.plateau_count == 2000
    number = 25**3 / 2000
    least = PARTICLE + 2.0 * math.sqrt(13.5 * TEST * BOX)
    cost = PARTICLE + TEST * 13.5 / number + BOX * number
    assert float(plateau.plateau_penalty) == pytest.approx(cost / least, abs=0.03)
    assert (ds.plateau_penalty >= 1.0).all() and (ds.plateau_penalty_error < 0.03).all()


# The scaling figures' claims hold on a machine of known costs, and fail on falsified data.


@pytest.mark.parametrize("figure", SCALING)
def test_tests_and_identities_hold_on_a_known_machine(figure, dataset, tmp_path):
    claims = getattr(claims_of_scaling, figure)(dataset(figure))
    wrong = [
        claim.claim
        for claim, verdict in zip(claims, judge(claims), strict=True)
        if claim.kind != "reproduction" and verdict == "disagrees"
    ]
    assert wrong == []
    core.write(tmp_path / "claims.csv", figure, claims)
    assert len(core.read(tmp_path / "claims.csv")) == len(claims) + len(core.family_test(claims))


FALSIFIED = {
    "naive_scaling": ({"tests_excess": 0.5}, "N(N-1)/2"),
    "box_count": ({"crossing_searches": 1.0, "crossing_searches_error": 0.01}, "searched at a crossing"),
    "ideal_boxes": ({"penalty": 2.0, "penalty_error": 0.01}, "worst of all gases"),
    "linear_scaling": ({"list_share": 1.0, "list_share_error": 0.01}, "neighbour list"),
    "event_scaling": ({"pairs_excess": 0.1}, "N(N-1)/2"),
}


@pytest.mark.parametrize("figure", SCALING)
def test_claims_can_fail(figure, dataset):
    ds = dataset(figure)
    changes, text = FALSIFIED[figure]
    for name, value in changes.items():
        ds[name] = ds[name] * 0.0 + value
    found = [
        verdict for claim, verdict in judged(getattr(claims_of_scaling, figure)(ds)).items() if text in claim
    ]
    assert found == ["disagrees"]


def test_pair_tests_that_go_missing_are_noticed(dataset):
    ds = dataset("box_count")
    ds["pair_tests"] = 0.9 * ds.pair_tests
    assert any(
        "pair tests" in claim
        for claim, verdict in judged(claims_of_scaling.box_count(ds)).items()
        if verdict == "disagrees"
    )


def test_quick_round_widths_are_noticed(dataset):
    ds = dataset("box_count")
    ds["advantage"] = ds.advantage + 0.1
    found = [
        verdict
        for claim, verdict in judged(claims_of_scaling.box_count(ds)).items()
        if "power of two" in claim
    ]
    assert found == ["disagrees", "disagrees"]


@pytest.mark.parametrize(
    ("name", "value", "text"),
    [
        ("near_box_visits", 14.0, "searched within reach"),
        ("near_missed", 1.0, "difference of the contacts"),
        ("own_first", 0.1, "end in the own box"),
        ("huge_tests", 0.0, "pairs tested more"),
    ],
)
def test_false_remarks_are_noticed(name, value, text, dataset):
    ds = dataset("box_count")
    ds[name] = ds[name] * 0.0 + value
    found = [verdict for claim, verdict in judged(remarks(ds)).items() if text in claim]
    assert found == ["disagrees"]


def test_remarks_about_time_are_decided(dataset):
    """Leaving out boxes costs more than it saves on the known machine, and a further test little."""
    found = judged(remarks(dataset("box_count")))
    decided = {
        claim: verdict for claim, verdict in found.items() if "within reach over" in claim or "huge" in claim
    }
    assert list(decided.values()) == ["agrees", "source in error", "agrees", "source in error"]


def test_plateaus_are_decided(dataset):
    ds = dataset("ideal_boxes")
    ds["plateau_penalty"] = ds["plateau_penalty"] * 0.0 + 1.5
    found = [verdict for claim, verdict in judged(ideal_boxes(ds)).items() if "worst N" in claim]
    assert found == 4 * ["source in error"]


def test_no_minimum_is_no_pass(dataset):
    found = judged(ideal_boxes(dataset("ideal_boxes")))
    assert found["ideal number of boxes per particle, N = 1200000, r = 0.1"] == "inconclusive"


# The scaling figures draw the columns of their data sets, also where the time has no minimum.


IDEAL = ("ideal", "ideal_low", "ideal_high")


@pytest.fixture
def measure(dataset):
    """Draws a figure of made-up costs. Returns its varied data set and its panels."""

    def drawn(figure, *kept):
        ds = varied(dataset(figure), *kept)
        return ds, draw(getattr(draw_scaling, figure), ds).axes

    return drawn


def timed(x, dataset, name="seconds", scale=1.0):
    """Points of a time with its error; scale: a factor of both, which may be an array."""
    return Points(x, scale * dataset[name], scale * dataset[f"{name}_error"])


def test_naive_scaling_is_drawn(measure):
    ds, (step, test) = measure("naive_scaling")
    shows(step, timed(ds["count"], ds, scale=1e3))
    shows(test, timed(ds["count"], ds, scale=1e9 / ds["pair_tests"]))


def test_box_count_is_drawn(measure):
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
    assert len(draw(draw_scaling.box_count, ds).axes[0].patches) == 0


def test_ideal_boxes_is_drawn(measure):
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


def test_linear_scaling_is_drawn(measure):
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


def test_event_scaling_is_drawn(measure):
    ds, (work, time) = measure("event_scaling")
    tests, times = [], []
    for search, dimension in zip(ds["method_search"].values, ds["method_dimension"].values, strict=True):
        own = ds.isel(run=((ds["search"] == search) & (ds["dimension"] == dimension)).values)
        tests.append(Points(own["count"], own["pair_tests"]))
        times.append(timed(own["count"], own, scale=1e6))
    shows(work, *tests)
    shows(time, *times)
