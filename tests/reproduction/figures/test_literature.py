"""Values of runs beside published ones."""

from __future__ import annotations

import numpy as np
import pytest
from reproduction.made import simulated

from gaspart.reproduction.figures.literature import measure
from gaspart.reproduction.points.point import Point

GAS = {
    "dimension": 3, "count": 1372, "radius": 0.5, "packing_fraction": 0.261799388, "boundary": "periodic",
    "temperature": 1.0, "exact_temperature": True, "arrangement": "lattice", "engine": "event",
    "collisions_per_particle": 40, "equilibration": 15, "samples": 40, "replicas": 2,
}  # fmt: skip
TRANSPORT = {"lags": 10, "stress": True, "follow": 1}
DIFFUSION = {"lags": 16, "displacements": True, "collisions_per_particle": 64, "samples": 32}


def measured(gas, tmp_path, judged=()):
    """The table of one point, which is simulated."""
    one = simulated(Point("gases", "one", "simulate", GAS | gas, str(tmp_path), 1))
    return measure([one], {"judged": list(judged)})


def test_z_is_that_of_infinite_systems(tmp_path):
    """108 spheres have a Z that is 1 % below that of a million."""
    few = {"count": 108, "packing_fraction": 0.4, "collisions_per_particle": 600}
    found = measured(few, tmp_path, ["gases"])
    (row,) = (found.isel(value=n) for n in range(found.sizes["value"]))
    assert str(row["quantity"].values) == "Z" and int(row["judged"]) == 1
    assert float(row["theirs"]) == pytest.approx(6.9455088, abs=1e-4)
    assert float(row["ours_error"]) < 0.02 * float(row["theirs"])
    assert abs(float(row["ours"] - row["theirs"])) < 4.5 * float(row["ours_error"])


def test_transport_coefficients_are_beside_each_published_one(tmp_path):
    found = measured(TRANSPORT, tmp_path)
    assert found["quantity"].values.tolist() == ["viscosity"] * 2 + ["conductivity"] * 2
    assert found["theirs"].values.tolist() == [0.58, 0.541, 2.3, 2.29]
    assert not found["judged"].any()
    assert np.all(abs(found["ours"] / found["theirs"] - 1.0) < 0.8)


def test_diffusion_is_that_of_as_many(tmp_path):
    found = measured(DIFFUSION | {"packing_fraction": 0.052359878}, tmp_path)
    assert found["quantity"].values.tolist() == ["diffusion"] and found["theirs"].values.tolist() == [1.929]
    assert found["ours"].values == pytest.approx(1.929, rel=0.15)
