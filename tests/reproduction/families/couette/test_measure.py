import numpy as np

from gaspart.reproduction.families.couette import measure as couette
from gaspart.reproduction.jobs.simulate import simulate
from gaspart.reproduction.points.point import Point
from gaspart.scene.scene import Scene

SETTINGS = {"parts": {"flows": ["flows"], "equilibrium": ["still"]}, "blocks": 8, "bins": 20, "clear": 2}
FLOW = {
    "engine": "dsmc",
    "cells_per_side": (8, 1, 1),
    "time_step": 0.25,
    "duration": 1500,
    "equilibration": 50,
    "samples": 160,
}


def scene(speed, **rest):
    """Dilute spheres between walls five mean free paths apart."""
    face = {"kind": "thermal", "temperature": 1.0}
    faces = {
        name: face | {"velocity": [0.0, sign * 0.5 * speed, 0.0]}
        for name, sign in (("x_low", -1), ("x_high", 1))
    }
    return {
        "container": {"lengths": [5.02, 0.5, 0.5], "boundary": ["wall", "periodic", "periodic"]},
        "species": [{"count": 703, "radius": 0.01, "temperature": 1.0}],
        "faces": faces,
        **rest,
    }


def flow(tmp_path, speed):
    """The measured numbers of a simulated flow."""
    path = tmp_path / "scene.yaml"
    Scene.from_dict(scene(speed)).to_file(path)
    point = Point("flows", f"u{speed:g}", "simulate", {**FLOW, "scene": str(path)}, "results", 1)
    (tmp_path / point.path).parent.mkdir(parents=True, exist_ok=True)
    simulate(tmp_path / point.path, **point.arguments)
    return couette.couette([point], SETTINGS).isel(point=0)


def test_a_flow_has_the_stress_of_its_knudsen_number(tmp_path, monkeypatch):
    """0.286 of free flight's by the viscosity with slip, and a few per cent more by heating."""
    monkeypatch.chdir(tmp_path)
    row = flow(tmp_path, 1.5)
    assert row["part"] == "flows" and row["engine"] == "DSMC"
    assert abs(float(row["knudsen"]) - 0.2) < 0.002 and float(row["speed"]) == 1.5
    assert abs(float(row["stress"]) - 0.29) < 0.02 and float(row["stress_error"]) < 0.006
    assert abs(float(row["viscosity"]) - 1.0) < 4.5 * float(row["viscosity_error"]) + 0.05
    assert abs(float(row["pressure"]) - 1.0) < 0.05
    velocity = row["flow"].values
    assert (np.diff(velocity) > -0.03).all() and abs(velocity.sum()) < 0.5
    assert float(row["reduced_rate"]) > 0.1


def test_numbers_of_an_exact_flow():
    """A linear flow with the heating and the slip that theory states, without noise."""
    place = 20.0 * ((np.arange(40) + 0.5) / 40 - 0.5)
    density = 1.0 / (np.sqrt(2.0) * np.pi)
    gap = couette.Gap(20.0, 1.0, 1.0, 1.0, 3)
    setting = couette.FlowBetweenPlates(gap, 1.0, 1.0, True, 1.0, place, np.abs(place) < 7.0)
    gradient = 1.0 / (20.0 + 2.0 * 1.25)
    velocity = gradient * place
    squares = np.stack([np.ones(40), 1.0 + velocity**2, np.ones(40)], axis=1)
    eta = float(couette.theory.enskog_viscosity(0.0, 3))
    averages = np.full(40, density), density * velocity, density * squares
    values = couette._gap_numbers(setting, eta * gradient, density, *averages)
    found = dict(zip(("stress", *couette.NUMBERS), values, strict=True))
    assert abs(found["viscosity"] - 1.0) < 1e-12
    assert abs(found["slip"] - 1.25) < 0.05
    assert abs(found["heating"]) < 1e-9 and abs(found["pressure"] - 1.0) < 1e-12
    assert max(abs(found[f"normal_{axis}"]) for axis in "xyz") < 1e-12


def test_a_sheared_gas_has_enskogs_viscosity(tmp_path, monkeypatch):
    """And the work that it heats by is that of the measured stress."""
    monkeypatch.chdir(tmp_path)
    sheared = {
        "container": {"lengths": [10.0, 10.0, 10.0], "boundary": "periodic"},
        "species": [{"count": 191, "radius": 0.5, "temperature": 1.0}],
        "faces": {"y_high": {"kind": "lees_edwards", "shear_rate": 0.15}},
    }
    path = tmp_path / "scene.yaml"
    Scene.from_dict(sheared).to_file(path)
    settings = {"engine": "event", "duration": 200, "equilibration": 20, "samples": 80}
    settings |= {"lags": 2, "stress": True, "replicas": 2, "scene": str(path)}
    point = Point("sheared", "s", "simulate", settings, "results", 1)
    (tmp_path / point.path).parent.mkdir(parents=True, exist_ok=True)
    simulate(tmp_path / point.path, **point.arguments)
    parts = {"parts": {"flows": [], "sheared": ["sheared"], "equilibrium": []}}
    row = couette.couette([point], SETTINGS | parts).isel(point=0)
    assert row["part"] == "sheared" and abs(float(row["packing_fraction"]) - 0.1) < 1e-4
    assert abs(float(row["viscosity"]) - 1.0) < 4.5 * float(row["viscosity_error"]) < 0.3
    assert 0.05 < float(row["reduced_rate"]) < 0.12
    assert abs(sum(float(row[f"normal_{name}"]) for name in "xyz")) < 1e-12
