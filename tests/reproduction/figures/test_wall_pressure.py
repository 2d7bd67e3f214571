"""Pressure on walls from a made-up trajectory, exactly."""

import numpy as np
import pytest
import xarray as xr

from gaspart.analysis.run import Run
from gaspart.errors import SceneError
from gaspart.reproduction.figures import wall_pressure
from gaspart.reproduction.points.point import Point


def test_the_force_and_the_drift_are_taken_exactly(tmp_path):
    """Two particles drifting along the periodic axis, one hit of 2 m v on each wall and interval."""
    made = Point("some", "single", "simulate", {
        "dimension": 2, "radius": 1.0, "side": [10, 8], "boundary": ["wall", "periodic"], "count": 2,
        "temperature": 1.0, "duration": 64.0, "samples": 32,
    }, str(tmp_path), 1)  # fmt: skip
    frames = np.arange(33.0)
    hits = np.stack([frames, frames, 0 * frames, 0 * frames], axis=1)
    velocities = np.broadcast_to([[3.0, 5.0], [-3.0, 5.0]], (33, 2, 2))
    made_up = xr.Dataset({
        "wall_impulse": (("frame", "face"), 6.0 * hits),
        "wall_hits": (("frame", "face"), hits),
        "velocities": (("frame", "atom", "spatial"), velocities),
        "kinetic_energy": ("frame", np.full(33, 34.0)),
        "time": ("frame", 2.0 * frames),
    })  # fmt: skip
    run = Run(made.scene, made_up["time"].values, made_up)
    pressure, temperature, count = wall_pressure.replica(run)
    # energy about the drift: 34 - 25 = 9 = (4 - 1) / 2 k T
    assert temperature == pytest.approx(6.0)
    assert count == 64
    assert pressure == pytest.approx(np.full(32, 6.0 / 2.0 / 8.0))  # the walls are 8 long


def test_a_container_without_walls_is_refused(tmp_path):
    settings = {
        "dimension": 2, "radius": 0.5, "side": 10, "boundary": "periodic", "count": 4, "temperature": 1.0,
        "duration": 1.0,
    }  # fmt: skip
    with pytest.raises(SceneError, match="needs walls"):
        wall_pressure.measure([Point("some", "single", "simulate", settings, str(tmp_path), 1)], {})
