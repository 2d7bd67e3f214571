"""An exact flow between sliding walls."""

import numpy as np

from gaspart import theory
from gaspart.reproduction.figures import couette
from gaspart.reproduction.points.point import Point
from gaspart.scene.scene import Scene

SETTINGS = {"parts": {"flows": ["flows"], "sheared": ["sheared"]}, "blocks": 8, "bins": 40, "clear": 2}
PLATES = {
    "container": {"lengths": [5.02, 0.5, 0.5], "boundary": ["wall", "periodic", "periodic"]},
    "species": [{"count": 703, "radius": 0.01, "temperature": 1.0}],
    "faces": {
        "x_low": {"kind": "thermal", "temperature": 1.0, "velocity": [0.0, -0.5, 0.0]},
        "x_high": {"kind": "thermal", "temperature": 1.0, "velocity": [0.0, 0.5, 0.0]},
    },
}
"""Dilute spheres between walls five mean free paths apart."""


def test_numbers_of_an_exact_flow(tmp_path):
    """A linear flow with the slip that theory states, without heating or noise."""
    scene = str(tmp_path / "scene.yaml")
    Scene.from_dict(PLATES).to_file(scene)
    run = {"engine": "dsmc", "cells_per_side": (8, 1, 1), "time_step": 0.25, "duration": 1500}
    run |= {"equilibration": 50, "samples": 160, "scene": scene}
    flow = couette.Flow(Point("flows", "exact", "simulate", run, "results", 1), SETTINGS)
    assert flow.coarse > 1.0
    flow.coarse, density, length = 1.0, flow.density, flow.gap.length
    gradient = 1.0 / (length + 2.0 * 1.25 * flow.path(density))
    velocity = gradient * flow.position
    squares = np.stack([np.ones(40), 1.0 + velocity**2, np.ones(40)], axis=1)
    stress = float(theory.enskog_viscosity(0.0, 3, flow.diameter)) * gradient
    averages = np.full(40, density), density * velocity, density * squares
    values = flow.numbers(stress, density, *averages)
    found = dict(zip(("stress", *couette.NUMBERS), values, strict=True))
    assert abs(found["viscosity"] - 1.0) < 1e-12
    assert abs(found["slip"] - 1.25) < 0.05
    assert abs(found["heating"]) < 1e-9 and abs(found["pressure"] - 1.0) < 1e-12
    assert max(abs(found[f"normal_{axis}"]) for axis in "xyz") < 1e-12
