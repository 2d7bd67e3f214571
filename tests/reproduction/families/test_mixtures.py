"""Made-up measurements of mixtures, as the smoke run's points are."""

from __future__ import annotations

import math

import numpy as np
import pytest
from reproduction.claims.data import about, judged
from reproduction.families.drawn import Points, draw, estimates, shows

import gaspart as gp
from gaspart import theory
from gaspart.reproduction.families.mixtures import figure
from gaspart.reproduction.families.mixtures.claims import deviations
from gaspart.reproduction.families.mixtures.claims import mixture_state as claims_of_mixture_state
from gaspart.reproduction.families.mixtures.measure import mixture_state as measure_mixture_state
from gaspart.reproduction.families.mixtures.measure import theories
from gaspart.reproduction.jobs.simulate import simulate
from gaspart.reproduction.points.point import Point
from gaspart.reproduction.table import Table, from_rows
from gaspart.scene.gas import Mixture
from gaspart.scene.sizes import relative_radii

POINTS = [
    *((3, ratio, small, 0.4) for ratio in (0.5, 0.9) for small in (0.5, 0.9)),
    (3, 0.5, 0.5, 0.1),
    (2, 0.5, 0.5, 0.5),
    (2, 0.9, 0.9, 0.5),
    (3, None, 0.1, 0.4),
    (3, None, 0.3, 0.4),
    (2, None, 0.1, 0.5),
]
"""dimension; size ratio and small fraction, or None and polydispersity; packing fraction."""


def measured(error=2e-4, seed=1):
    """Z is that of "santos", off by a random error; so are contact values and rates."""
    rng, rows = np.random.default_rng(seed), []
    for dimension, ratio, other, eta in POINTS:
        if ratio is None:
            sizes, counts = tuple(relative_radii(100, other, "lognormal")), (1,) * 100
        else:
            sizes, counts = (1.0, ratio), (round(1000 * (1.0 - other)), round(1000 * other))
        gas = Mixture(dimension, eta, counts, sizes, (1.0,) * len(sizes), 1.0)
        row = {
            "dimension": dimension,
            "packing_fraction": eta,
            "count": 4000,
            "size_ratio": math.nan if ratio is None else ratio,
            "small_fraction": math.nan if ratio is None else other,
            "polydispersity": other if ratio is None else math.nan,
            "distribution": "lognormal" if ratio is None else "",
            "correction": 1e-5,
            "reference_error": 1e-5,
            **theories(gas),
        }
        z = row["santos"]
        row |= {"Z": z * (1.0 + error * rng.normal()), "Z_error": error * z, "Z_freedom": 20.0}
        if ratio is not None:
            row |= {"virial": error * rng.normal(), "virial_error": error, "virial_freedom": 20.0}
            for name in ("contact", "rate"):
                value = np.array(row[f"{name}_santos"])
                row[name] = value * (1.0 + error * rng.normal(size=3))
                row[f"{name}_error"] = error * value
                row[f"{name}_freedom"] = np.full(3, 20.0)
        rows.append(row)
    pairs = ["large-large", "large-small", "small-small"]
    return from_rows("point", rows, ("pair",)).assign_coords(pair=pairs)


GAS = {
    "dimension": 3,
    "count": 200,
    "radius": 0.5,
    "packing_fraction": 0.2,
    "boundary": "periodic",
    "temperature": 1.0,
    "exact_temperature": True,
    "engine": "event",
    "collisions_per_particle": 300,
    "equilibration": 20,
    "samples": 32,
    "replicas": 2,
}
TWO = {"size_ratio": 0.6, "small_fraction": 0.5, "pairs": True}


def point(**settings):
    return Point("mixture", "one", "simulate", GAS | settings, "results", 1)


def test_both_kinds_are_near_theory(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    points = [point(**TWO), point(polydispersity=0.2)]
    points[1] = Point("many", *("one", "simulate"), points[1].settings, "results", 1)
    for one in points:
        (tmp_path / one.path).parent.mkdir(parents=True)
        simulate(tmp_path / one.path, **one.arguments)
    ds = measure_mixture_state(points, {})
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


def test_a_gas_of_that_theory_agrees():
    found = judged(claims_of_mixture_state(measured()))
    verdicts = [verdict for claim, verdict in found.items() if "rms deviation" not in claim]
    assert set(verdicts) == {"agrees", "no verdict"}
    assert sum("virial sum" in claim for claim in found) == 7
    assert sum("contact value" in claim for claim in found) == 3
    assert sum("Z over" in claim for claim in found) == 6
    assert sum("largest deviation" in claim for claim in found) == 4


@pytest.mark.parametrize(
    ("name", "factor", "text"),
    [
        ("Z", 1.004, "Z over"),
        ("contact", 1.03, "contact value of large-small"),
        ("virial", None, "virial sum"),
    ],
)
def test_each_claim_can_fail(name, factor, text):
    ds = measured()
    values = ds[name] * factor if factor else ds[name] + 0.005
    assert "disagrees" in about(claims_of_mixture_state(ds.assign({name: values})), text)


def test_boubliks_equation_is_excluded_or_nothing_is_said():
    found = judged(claims_of_mixture_state(measured(error=2e-3)))
    of_z = {verdict for claim, verdict in found.items() if "Z over Boublik's" in claim}
    assert of_z == {"inconclusive"}
    ds = measured()
    z = ds["Z"].where(ds["dimension"] == 2, 1.00001 * ds["boublik"])
    assert "disagrees" in about(claims_of_mixture_state(ds.assign(Z=z)), "Z over Boublik's")


@pytest.mark.parametrize(("theory", "verdict"), [("starling", "reproduced"), ("boublik", "source in error")])
def test_the_comparison_of_1999(theory, verdict):
    ds = measured(error=1e-5)
    z = ds["Z"].where(ds["dimension"] == 2, ds[theory] * (1.0 + 1e-5 * np.arange(ds.sizes["point"])))
    found = judged(claims_of_mixture_state(ds.assign(Z=z)))
    assert {found[claim] for claim in found if "rms deviation" in claim} == {verdict}


def test_deviations_contact_values_and_rates_are_drawn():
    ds = measured()
    ratio, density, discs, many, contact, rate = draw(figure.mixture_state, ds).axes

    def points(base, x, chosen, shift=0.0):
        part = ds.isel(point=np.flatnonzero(chosen)).sortby(x)
        percent = 100.0 * deviations(Table(part, "point"), base)
        return Points(part[x] + shift, percent.value, percent.error)

    spheres = (ds["dimension"] == 3) & np.isclose(ds["packing_fraction"], 0.4)
    few, most = ((ds["small_fraction"] == small) for small in (0.5, 0.9))
    shows(
        ratio,
        points("boublik", "size_ratio", spheres & few, -0.004),
        points("boublik", "size_ratio", spheres & most, 0.004),
    )
    shows(
        discs,
        points("santos", "size_ratio", (ds["dimension"] == 2) & few, -0.004),
        points("santos", "size_ratio", (ds["dimension"] == 2) & most, 0.004),
    )
    half = few & (ds["size_ratio"] == 0.5)
    shows(
        density,
        points("boublik", "packing_fraction", (ds["dimension"] == 3) & half),
        points("santos", "packing_fraction", (ds["dimension"] == 2) & half),
    )
    unequal = np.isfinite(ds["polydispersity"])
    shows(
        many,
        points("boublik", "polydispersity", (ds["dimension"] == 3) & unequal),
        points("santos", "polydispersity", (ds["dimension"] == 2) & unequal),
    )
    for axis, name in ((contact, "contact"), (rate, "rate")):
        part = ds.isel(point=np.flatnonzero(spheres & few))
        series = [
            Points(part["size_ratio"], *estimates(part.sel(pair=pair), name)) for pair in ds["pair"].values
        ]
        shows(axis, *series)
