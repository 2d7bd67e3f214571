"""Viscosity and conductivity of short runs, and the bounds within which theory is claimed."""

from __future__ import annotations

import numpy as np
import pytest

from gaspart import theory
from gaspart.reproduction.figures import transport
from gaspart.reproduction.jobs.simulate import simulate
from gaspart.reproduction.points.point import Point
from gaspart.reproduction.table import entries, from_rows

GAS = {
    "dimension": 3, "count": 64, "radius": 0.5, "packing_fraction": 0.1, "boundary": "periodic",
    "temperature": 1.0, "exact_temperature": True, "arrangement": "lattice", "engine": "event",
    "collisions_per_particle": 800, "equilibration": 20, "samples": 800, "lags": 15, "stress": True,
    "follow": 1, "replicas": 6,
}  # fmt: skip
MEASURE = {"viscosity": transport.measure_viscosity, "conductivity": transport.measure_conductivity}


def simulated(tmp_path, monkeypatch, experiment, name, **changes):
    monkeypatch.chdir(tmp_path)
    one = Point(experiment, name, "simulate", GAS | changes, "results", 1)
    (tmp_path / one.path).parent.mkdir(parents=True, exist_ok=True)
    simulate(tmp_path / one.path, **one.arguments)
    return one


def test_coefficients_are_near_enskogs(tmp_path, monkeypatch):
    """At packing fraction 0.1, where these differ from it by a few per cent, by 4 sigma of some 6 %."""
    one = simulated(tmp_path, monkeypatch, "spheres", "one")
    for name, measure in MEASURE.items():
        row = measure([one], {}).isel(point=0)
        error = float(row["value_error"])
        assert error < 0.12
        assert abs(float(row["value"]) - 1.0) < 4.5 * error + 0.03
        assert float(row["finite"]) == theory.transport_finite_size_factor(64, 3, name)
        assert abs(float(row["difference"])) < 4.5 * float(row["difference_error"]) + 0.02
        assert abs(float(row["time"][1]) - 1.5) < 0.02
        if name == "viscosity":
            assert float(row["bulk_error"]) < 0.15
            assert abs(float(row["bulk"]) - 1.0) < 4.5 * float(row["bulk_error"]) + 0.03


@pytest.mark.thorough
def test_growth_is_the_integrals_own(tmp_path, monkeypatch):
    """Dilute discs in two small containers: growths are noise, the curves those of `coefficient`."""
    short = {"dimension": 2, "replicas": 4, "samples": 200, "collisions_per_particle": 200}
    points = [
        simulated(tmp_path, monkeypatch, "discs", f"count={count}", count=count, **short)
        for count in (36, 64)
    ]
    starts = {"viscosity": 4.0, "conductivity": 8.0}
    found = transport.measure_growth(points, {f"{name}_from": start for name, start in starts.items()})
    for name, measure in MEASURE.items():
        plain = measure(points, {})
        np.testing.assert_allclose(found[name], plain["running"])
        np.testing.assert_allclose(found["time"], plain["time"])
        late = found["time"].values >= starts[name]
        modes = found[f"{name}_modes"].values
        assert (np.isfinite(modes) == late).all()
        for row in range(2):
            ends = np.flatnonzero(late[row])[[0, -1]]
            grown, of_modes = np.diff(found[name].values[row, ends]), np.diff(modes[row, ends])
            assert np.isclose(float(found[f"{name}_growth"][row]), grown[0])
            assert np.isclose(float(found[f"{name}_modes_growth"][row]), of_modes[0])
            assert 0.0 < float(found[f"{name}_short_waves"][row]) < 1.0


@pytest.mark.parametrize(
    ("dimension", "eta", "subjects"),
    [
        (3, 0.01, ["viscosity over Chapman", "growth by", "bulk viscosity over"]),
        (3, 0.3, ["viscosity over Enskog", "growth by", "bulk viscosity over"]),
        (3, 0.45, ["growth by"]),
        (2, 0.01, ["viscosity over Chapman", "growth by", "bulk viscosity over"]),
        (2, 0.4, ["growth by"]),
    ],
)
def test_theory_has_a_verdict_only_where_it_is_known(dimension, eta, subjects):
    row = {"dimension": dimension, "packing_fraction": eta, "count": 256, "finite": 0.99}
    row |= entries(dict.fromkeys(("value", "growth", "bulk", "difference"), (1.0, 0.01)))
    claims = [one for one in transport.claim_viscosity(from_rows("point", [row])) if not one.no_verdict]
    assert [one.claim[: len(text)] for one, text in zip(claims, subjects, strict=True)] == subjects
