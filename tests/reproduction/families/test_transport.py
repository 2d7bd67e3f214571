"""Made-up measurements of viscosity and conductivity."""

from __future__ import annotations

import numpy as np
import pytest
from reproduction.claims.data import about, judged
from reproduction.families.drawn import Points, draw, estimates, shows

from gaspart import theory
from gaspart.reproduction.families.transport import claims, measure
from gaspart.reproduction.families.transport import figure as draw_transport
from gaspart.reproduction.jobs.simulate import simulate
from gaspart.reproduction.points.point import Point
from gaspart.reproduction.table import from_rows


def measured(error=0.002, seed=1):
    """Spheres and discs whose coefficients are Enskog's, each off by a random error."""
    rng, rows = np.random.default_rng(seed), []
    for dimension, eta in ((3, 0.01), (3, 0.2), (3, 0.3), (3, 0.45), (2, 0.01), (2, 0.4)):
        finite = 0.99 if eta <= 0.02 else 1.0
        lags = 16 if eta < 0.45 else 31
        known = {"value": finite + error * rng.normal(), "growth": finite + error * rng.normal()}
        known["bulk"] = 1.0 + error * rng.normal()
        known["difference"] = known["growth"] / known["value"] - 1.0
        time = 1.0 * np.arange(lags)
        rows.append(
            {
                "dimension": dimension,
                "packing_fraction": eta,
                "count": 256,
                "finite": finite,
                **known,
                **{f"{name}_error": error for name in known},
                **{f"{name}_freedom": 15.0 for name in known},
                "time": time,
                "running": finite * -np.expm1(-time),
                "running_error": np.full(lags, error),
            }
        )
    return from_rows("point", rows, ("lag",))


def growing(error=0.05, growth=1.0, seed=1):
    """Two containers whose integrals grow `growth` times as much as the modes."""
    rng, rows = np.random.default_rng(seed), []
    time = np.arange(1.0, 40.0, 2.0)
    for count in (256, 1024):
        row = {"count": count, "time": time}
        for name in ("viscosity", "conductivity"):
            modes = np.where(time > 10.0, 1.0 + 0.03 * np.log(time / 40.0) + 1e-4 * count, np.nan)
            row |= {
                f"{name}_growth": growth + error * rng.normal(),
                f"{name}_growth_error": error,
                f"{name}_growth_freedom": 15.0,
                f"{name}_short_waves": 0.15,
                f"{name}_modes": modes,
                name: 1.0 - np.exp(-time) + 1e-5 * count,
                f"{name}_error": np.full(time.size, 0.002),
            }
        rows.append(row)
    return from_rows("point", rows, ("lag",))


GAS = {
    "dimension": 3,
    "count": 64,
    "radius": 0.5,
    "packing_fraction": 0.1,
    "boundary": "periodic",
    "temperature": 1.0,
    "exact_temperature": True,
    "arrangement": "lattice",
    "engine": "event",
    "collisions_per_particle": 800,
    "equilibration": 20,
    "samples": 800,
    "lags": 15,
    "stress": True,
    "follow": 1,
    "replicas": 6,
}


def test_coefficients_are_near_enskogs(tmp_path, monkeypatch):
    """At packing fraction 0.1, where these differ from it by a few per cent, by 4 sigma of some 6 %."""
    monkeypatch.chdir(tmp_path)
    one = Point("spheres", "one", "simulate", GAS, "results", 1)
    (tmp_path / one.path).parent.mkdir(parents=True)
    simulate(tmp_path / one.path, **one.arguments)
    for name, function in (
        ("viscosity", measure.viscosity),
        ("conductivity", measure.conductivity),
    ):
        row = function([one], {}).isel(point=0)
        error = float(row["value_error"])
        assert error < 0.12
        assert abs(float(row["value"]) - 1.0) < 4.5 * error + 0.03
        assert float(row["finite"]) == theory.transport_finite_size_factor(64, 3, name)
        assert abs(float(row["difference"])) < 4.5 * float(row["difference_error"]) + 0.02
        assert abs(float(row["time"][1]) - 1.5) < 0.02
    bulk = measure.viscosity([one], {}).isel(point=0)
    assert float(bulk["bulk_error"]) < 0.15
    assert abs(float(bulk["bulk"]) - 1.0) < 4.5 * float(bulk["bulk_error"]) + 0.03


def test_growth_is_the_integrals_own(tmp_path, monkeypatch):
    """Dilute discs in two small containers: growths are noise, the curves those of `coefficient`."""
    monkeypatch.chdir(tmp_path)
    points = []
    for count in (36, 64):
        gas = GAS | {"dimension": 2, "count": count, "replicas": 4, "samples": 200}
        one = Point(
            "discs", f"count={count}", "simulate", gas | {"collisions_per_particle": 200}, "results", 1
        )
        (tmp_path / one.path).parent.mkdir(parents=True, exist_ok=True)
        simulate(tmp_path / one.path, **one.arguments)
        points.append(one)
    found = measure.logarithmic_growth(points, {"viscosity_from": 4.0, "conductivity_from": 8.0})
    for name, function in (
        ("viscosity", measure.viscosity),
        ("conductivity", measure.conductivity),
    ):
        plain = function(points, {})
        np.testing.assert_allclose(found[name], plain["running"])
        np.testing.assert_allclose(found["time"], plain["time"])
        late = found["time"].values >= {"viscosity": 4.0, "conductivity": 8.0}[name]
        modes = found[f"{name}_modes"].values
        assert (np.isfinite(modes) == late).all()
        for row in range(2):
            ends = np.flatnonzero(late[row])[[0, -1]]
            grown = np.diff(found[name].values[row, ends]) / np.diff(modes[row, ends])
            assert np.isclose(float(found[f"{name}_growth"][row]), grown[0])
            assert 0.0 < float(found[f"{name}_short_waves"][row]) < 1.0


@pytest.mark.parametrize("figure", ["viscosity", "conductivity"])
def test_enskogs_coefficients_agree(figure):
    found = judged(getattr(claims, figure)(measured()))
    assert len(found) == 2 + 2 + 6 + (6 if figure == "viscosity" else 0)
    assert set(found.values()) <= {"agrees", "no verdict"}


@pytest.mark.parametrize(
    ("name", "factor", "point", "text"),
    [
        ("value", 1.03, 0, "Chapman"),
        ("value", 0.97, 4, "Chapman"),
        ("value", 1.09, 1, "over Enskog's"),
        ("difference", None, 3, "Helfand"),
        ("bulk", 0.93, 1, "bulk"),
    ],
)
def test_each_claim_can_fail(name, factor, point, text):
    ds = measured()
    values = ds[name].values.copy()
    values[point] = 0.1 if factor is None else factor * values[point]
    assert "disagrees" in about(claims.viscosity(ds.assign({name: (ds[name].dims, values)})), text)


def test_noise_is_inconclusive():
    assert about(claims.viscosity(measured(error=0.05)), "Chapman") == {"inconclusive"}
    assert np.isfinite(measured()["value"].values).all()


def test_growth_by_the_modes_agrees():
    found = judged(claims.logarithmic_growth(growing()))
    assert len(found) == 2 and set(found.values()) == {"agrees"}


@pytest.mark.parametrize(
    ("change", "verdict"), [({"growth": 0.0}, "disagrees"), ({"error": 0.6}, "inconclusive")]
)
def test_plateaus_disagree_and_noise_is_inconclusive(change, verdict):
    assert set(judged(claims.logarithmic_growth(growing(**change))).values()) == {verdict}


def test_bulk_viscosity_of_discs_has_a_verdict_in_dilute_gases_only():
    """Its integral grows with the logarithm of time."""
    found = judged(claims.viscosity(measured()))
    discs = {claim: verdict for claim, verdict in found.items() if "bulk" in claim and "discs" in claim}
    assert len(discs) > 1
    for claim, verdict in discs.items():
        assert verdict == ("agrees" if "fraction 0.01," in claim else "no verdict"), claim


@pytest.mark.parametrize("name", ["viscosity", "conductivity"])
def test_both_forms_and_the_integrals_are_drawn(name):
    ds = measured()
    if name == "conductivity":
        ds = ds.drop_vars("bulk")
    density, running, *_ = draw(getattr(draw_transport, name), ds).axes
    spheres = ds.isel(point=np.flatnonzero(ds["dimension"].values == 3))
    eta = spheres["packing_fraction"].values
    bulk = [Points(eta, *estimates(spheres, "bulk"))] if name == "viscosity" else []
    shows(
        density,
        Points(eta - 0.004, *estimates(spheres, "value")),
        Points(eta + 0.004, *estimates(spheres, "growth")),
        *bulk,
    )
    parts = ("time", "running", "running_error")
    series = [Points(*(spheres[key].isel(point=n) for key in parts)) for n in range(eta.size)]
    shows(running, *series)


def test_integrals_of_both_containers_are_drawn():
    ds = growing()
    rows = [ds.isel(point=n) for n in range(2)]
    late = [row.isel(lag=row["time"].values >= draw_transport.SHOWN_FROM) for row in rows]
    axes = draw(draw_transport.logarithmic_growth, ds).axes
    for axis, name in zip(axes, ("viscosity", "conductivity"), strict=True):
        shows(axis, *(Points(row["time"], *estimates(row, name)) for row in late))
