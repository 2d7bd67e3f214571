"""Made-up echoes with a known growth."""

import math

import numpy as np
import pytest
import xarray as xr

from gaspart.reproduction.figures.reversibility import ROUNDINGS, measure
from gaspart.reproduction.points.point import Point

SIDE = 8.7


def echoes(growth, engine="event", jump_after=None, seeds=6, samples=30):
    """What `echo` gives if errors grow from a coordinate's rounding by exp(growth) a collision."""
    rng = np.random.default_rng(2)
    s = np.linspace(1.0, 30.0, samples) + np.zeros((seeds, 1))
    growth = growth * (1.0 + 0.02 * rng.standard_normal((seeds, 1)))
    distance = np.minimum(SIDE * 2.0**-53 * np.exp(growth * s), 3.0)
    if jump_after is not None:
        distance = np.where(s > jump_after, 2.0, distance)
    apart = np.minimum(1e-13 * np.exp(growth * s), 3.0)
    attributes = {"count": 125, "dimension": 3, "side": SIDE, "packing_fraction": 0.1, "time_step": 0.0}
    return xr.Dataset(
        {
            name: (("seed", "sample"), values)
            for name, values in (("collisions", s), ("echo", distance), ("divergence", apart))
        }
        | {"exponent": ("seed", 1.47 * (1.0 + 0.01 * rng.standard_normal(seeds)))},
        attrs=attributes | {"engine": engine, "precision": "float64"},
    )


def test_growth_memory_and_jumps(tmp_path):
    """Of one gas by both engines: steps forget all at once."""
    (tmp_path / "gas").mkdir()
    points = [Point("gas", name, "echo", {}, str(tmp_path), 1) for name in ("event", "step")]
    for one, run in zip(points, (echoes(1.47), echoes(1.47, "step", jump_after=8.0)), strict=True):
        run.to_netcdf(one.path)
    dataset = measure(points, {})
    event, step = dataset.isel(row=0), dataset.isel(row=1)
    assert float(event.growth) == pytest.approx(1.47, rel=0.03)
    assert float(event.divergence) == pytest.approx(float(event.growth), rel=0.01)
    assert float(event.memory * event.growth) == pytest.approx(ROUNDINGS - math.log(SIDE), abs=0.5)
    assert float(event.exponent) == pytest.approx(1.47, abs=4.0 * float(event.exponent_error))
    assert (float(event.jumps), float(step.jumps)) == (0.0, 1.0)
    assert float(step.memory) == pytest.approx(8.5, abs=0.6)
    assert float(event.side) == SIDE
