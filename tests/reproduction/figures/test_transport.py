"""Viscosity and conductivity of short runs, and the bounds within which theory is claimed."""

from __future__ import annotations

import pytest
from reproduction.made import simulated

from gaspart import theory
from gaspart.reproduction.figures import transport
from gaspart.reproduction.points.point import Point
from gaspart.reproduction.table import entries, from_rows

GAS = {
    "dimension": 3, "count": 64, "radius": 0.5, "packing_fraction": 0.1, "boundary": "periodic",
    "temperature": 1.0, "exact_temperature": True, "arrangement": "lattice", "engine": "event",
    "collisions_per_particle": 800, "equilibration": 20, "samples": 800, "lags": 15, "stress": True,
    "follow": 1, "replicas": 6,
}  # fmt: skip
MEASURE = {"viscosity": transport.measure_viscosity, "conductivity": transport.measure_conductivity}


def test_coefficients_are_near_enskogs(tmp_path):
    """At packing fraction 0.1, where these differ from it by a few per cent, by 4 sigma of some 6 %."""
    one = simulated(Point("spheres", "one", "simulate", GAS, str(tmp_path), 1))
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
