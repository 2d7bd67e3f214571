"""Gases between sliding walls and in uniform shear: short runs, and an exact flow."""

from __future__ import annotations

import numpy as np
import pytest
from reproduction.made import simulated

from gaspart import theory
from gaspart.reproduction.figures import couette
from gaspart.reproduction.points.point import Point
from gaspart.scene.scene import Scene

SETTINGS = {"parts": {"flows": ["flows"], "sheared": ["sheared"]}, "blocks": 8, "bins": 20, "clear": 2}
DSMC = {"engine": "dsmc", "cells_per_side": (8, 1, 1), "time_step": 0.25, "duration": 1500}
DSMC |= {"equilibration": 50, "samples": 160}


def between_walls(speed):
    """Dilute spheres between walls five mean free paths apart."""
    return {
        "container": {"lengths": [5.02, 0.5, 0.5], "boundary": ["wall", "periodic", "periodic"]},
        "species": [{"count": 703, "radius": 0.01, "temperature": 1.0}],
        "faces": {
            name: {"kind": "thermal", "temperature": 1.0, "velocity": [0.0, sign * 0.5 * speed, 0.0]}
            for name, sign in (("x_low", -1), ("x_high", 1))
        },
    }


@pytest.fixture
def point(tmp_path, monkeypatch):
    """Makes a point of a scene."""
    monkeypatch.chdir(tmp_path)

    def of(experiment, name, scene, **settings):
        path = tmp_path / "scene.yaml"
        Scene.from_dict(scene).to_file(path)
        return Point(experiment, name, "simulate", settings | {"scene": str(path)}, "results", 1)

    return of


def test_numbers_of_an_exact_flow(point):
    """A linear flow with the slip that theory states, without heating or noise."""
    flow = couette.Flow(point("flows", "exact", between_walls(1.0), **DSMC), SETTINGS | {"bins": 40})
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


@pytest.mark.thorough
def test_a_sheared_gas_has_enskogs_viscosity(point):
    scene = {
        "container": {"lengths": [10.0, 10.0, 10.0], "boundary": "periodic"},
        "species": [{"count": 191, "radius": 0.5, "temperature": 1.0}],
        "faces": {"y_high": {"kind": "lees_edwards", "shear_rate": 0.15}},
    }
    settings = {"engine": "event", "duration": 200, "equilibration": 20, "samples": 80}
    one = simulated(point("sheared", "s", scene, lags=2, stress=True, replicas=2, **settings))
    row = couette.measure([one], SETTINGS).isel(point=0)
    assert row["part"] == "sheared" and abs(float(row["packing_fraction"]) - 0.1) < 1e-4
    assert abs(float(row["viscosity"]) - 1.0) < 4.5 * float(row["viscosity_error"]) < 0.3
    assert 0.05 < float(row["reduced_rate"]) < 0.12
    assert abs(sum(float(row[f"normal_{name}"]) for name in "xyz")) < 1e-12
