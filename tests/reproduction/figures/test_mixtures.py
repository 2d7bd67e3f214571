"""Runs beside theories of mixtures, settings of points, and the comparison of two theories."""

import math

import numpy as np
import pytest
from reproduction.claims.data import judged
from reproduction.made import simulated

import gaspart as gp
from gaspart import theory
from gaspart.reproduction.figures import mixtures
from gaspart.reproduction.points.point import Point
from gaspart.reproduction.table import from_rows

GAS = {
    "dimension": 3, "count": 200, "radius": 0.5, "packing_fraction": 0.2, "boundary": "periodic",
    "temperature": 1.0, "exact_temperature": True, "engine": "event", "collisions_per_particle": 300,
    "equilibration": 20, "samples": 32, "replicas": 2,
}  # fmt: skip
TWO = {"size_ratio": 0.6, "small_fraction": 0.5, "pairs": True}


def point(**settings):
    return Point("mixture", "one", "simulate", GAS | settings, "results", 1)


def test_both_kinds_are_near_theory(tmp_path):
    points = [
        simulated(Point(name, "one", "simulate", GAS | sizes, str(tmp_path), 1))
        for name, sizes in (("mixture", TWO), ("many", {"polydispersity": 0.2}))
    ]
    ds = mixtures.measure(points, {})
    assert ds["packing_fraction"].values == pytest.approx(0.2, rel=1e-12)
    for row in (ds.isel(point=n) for n in (0, 1)):
        assert float(row["Z_error"]) < 0.02
        assert abs(float(row["Z"] - row["santos"])) < 4.5 * float(row["Z_error"]) + 0.002
    assert ds["distribution"].values.tolist() == ["", "lognormal"]
    two = ds.isel(point=0)
    assert abs(float(two["virial"])) < 4.5 * float(two["virial_error"]) < 0.03
    for name in ("contact", "rate"):
        off = np.abs(two[name] - two[f"{name}_santos"])
        assert (off < 4.5 * two[f"{name}_error"] + 0.01 * two[f"{name}_santos"]).all()
    pure = float(theory.carnahan_starling(0.2) - 1.0) / 0.8
    mixture = points[0].scene.mixture
    starling = theory.mixture_compressibility_factor(*mixture.sizes, theory="linear", pure=pure)
    assert float(two["starling"]) == starling


def test_points_of_two_sizes_and_of_many():
    scene = point(**TWO).scene
    assert [kind.count for kind in scene.species] == [100, 100]
    assert [kind.radius for kind in scene.species] == [0.5, 0.3]
    assert scene.packing_fraction == pytest.approx(0.2, rel=1e-12)
    many = point(polydispersity=0.1, radius_distribution="uniform")
    assert many.scene.packing_fraction == pytest.approx(0.2, rel=1e-12)
    rate = theory.mixture_collision_rates(*many.scene.mixture.sizes).sum(axis=1).mean()
    assert many.schedule.sample_interval * 32 == pytest.approx(300 / rate, rel=2e-3)


@pytest.mark.parametrize(
    ("key", "settings"),
    [
        ("size_ratio", {"size_ratio": 0.5}),
        ("small_fraction", {"small_fraction": 0.5}),
        ("size_ratio", {**TWO, "polydispersity": 0.1}),
        ("radius_distribution", {"radius_distribution": "uniform"}),
        ("size_ratio", {**TWO, "count": None, "side": 10.0}),
    ],
)
def test_keys_that_need_or_exclude_each_other(key, settings):
    given = {name: value for name, value in (GAS | settings).items() if value is not None}
    with pytest.raises(gp.SceneError, match=rf"^experiments\.mixture\.{key} = "):
        _ = Point("mixture", "one", "simulate", given, "results", 1).scene


@pytest.mark.parametrize(
    ("starling", "boublik", "verdict", "ratio"),
    [(1e-4, -3e-4, "reproduced", 1.0 / 3.0), (3e-4, 1e-4, "source in error", 3.0)],
)
def test_the_comparison_of_1999_is_one_of_rms_deviations(starling, boublik, verdict, ratio):
    theories = {
        "boublik": 2.0 / (1.0 + boublik),
        "starling": 2.0 / (1.0 + starling),
        "linear": 2.0,
        "santos": 2.0,
    }
    row = {"dimension": 3, "packing_fraction": 0.4, "size_ratio": math.nan, "polydispersity": 0.3}
    row |= {"Z": 2.0, "Z_error": 4e-5, "Z_freedom": 20.0, **theories}
    claims = [one for one in mixtures.claims(from_rows("point", [row] * 4)) if "rms deviation" in one.claim]
    assert set(judged(claims).values()) == {verdict}
    (claim,) = claims
    assert claim.measured.value == pytest.approx(ratio)
    # of the ratio against each of the four deviations, whose errors are independent
    slope = (1.0 / starling - 1.0 / boublik) * ratio / 4.0
    assert claim.measured.error == pytest.approx(abs(slope) * 2e-5 * np.sqrt(4.0), rel=1e-2)
