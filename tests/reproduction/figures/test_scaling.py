"""Jobs of a machine whose every cost is known, for the tests of the scaling figures."""

import math
from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

from gaspart.reproduction.claims import judge
from gaspart.reproduction.config import merged_with_default
from gaspart.reproduction.figures import (
    box_count,
    event_scaling,
    ideal_boxes,
    linear_scaling,
    naive_scaling,
)
from gaspart.reproduction.points.points import all_points, figure_points

ROOT = Path(__file__).parents[3]
PARTICLE, TEST, BOX, LIST = 30e-9, 12e-9, 0.3e-9, 2e-9  # s per particle and step, pair test, box; list
NEAR, CONTACTS = 20e-9, 10  # s per particle and step to leave out boxes; contacts in a timing
CONFIG, _ = merged_with_default(ROOT / "config/config.yaml")
MODULES = (naive_scaling, box_count, ideal_boxes, linear_scaling, event_scaling)
FIGURES = {name: parts for module in MODULES for name, parts in module.FIGURES.items()}


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
        reached = box_count.boxes_in_reach(own.side / own.boxes_per_side, 2.0 * own.radius, own.dimension)
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
    tests = [box_count.expected_pair_tests(count, n, dimension, side, radius)[0] for n in sides]
    visits = [count * box_count.expected_box_visits(n, dimension, side, radius) for n in sides]
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
    near = (count - 1.0) * box_count.neighbour_share(sides, **gas)
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
            of = CONFIG["figures"][figure]
            made[figure] = FIGURES[figure].measure(points(figure, folder), of)
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


@pytest.mark.parametrize("figure", FIGURES)
def test_tests_and_identities_hold_on_a_known_machine(figure, dataset):
    """Exponents too, which the small data sets do not have."""
    claims = list(FIGURES[figure].claims(dataset(figure)))
    verdicts = zip(claims, judge(claims), strict=True)
    assert not [claim.claim for claim, at in verdicts if claim.kind != "reproduction" and at == "disagrees"]
