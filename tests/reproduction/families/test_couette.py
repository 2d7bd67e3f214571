"""Made-up measurements of gases between sliding walls, as theory states them."""

from __future__ import annotations

import numpy as np
import pytest
from reproduction.claims.data import about, judged
from reproduction.families.drawn import Points, draw, estimates, shows

from gaspart import theory
from gaspart.reproduction.families.couette import measure
from gaspart.reproduction.families.couette.claims import couette as claims_of_couette
from gaspart.reproduction.families.couette.figure import couette as draw_couette
from gaspart.reproduction.families.couette.measure import NUMBERS
from gaspart.reproduction.jobs.simulate import simulate
from gaspart.reproduction.points.point import Point
from gaspart.reproduction.table import from_rows
from gaspart.scene.scene import Scene
from gaspart.theory.shear import NORMAL_STRESSES, VELOCITY_SLIP

FLOWS = (  # engine, packing fraction, Knudsen number, speed, stress over pressure
    ("DSMC", 0.0, 0.05, 1.0, 0.036),
    ("DSMC", 0.0, 0.05, 2.5, 0.084),
    ("DSMC", 0.0, 50.0, 1.0, 0.392),
    ("event-driven", 0.023, 0.047, 1.0, 0.033),
    ("event-driven", 0.3, 0.01, 1.0, 0.02),
)


def measured(error=1.0, seed=1):
    """Each number off by a random error; error: that of most claims, over what they need."""
    rng, rows = np.random.default_rng(seed), []
    sizes = {"slip": 0.02, "pressure": 2e-4, "reduced_rate": 1e-5, "heating": 0.002}
    sizes |= dict.fromkeys(("normal_x", "normal_y", "normal_z"), 4e-4)
    place = np.linspace(-0.45, 0.45, 10)
    for engine, eta, knudsen, speed, rate in FLOWS:
        normal = [slope * rate**2 for slope in NORMAL_STRESSES]
        pressure = 1.0 + (normal[0] if eta < 0.1 else 0.0)
        values = (1.0, VELOCITY_SLIP, float(theory.viscous_heating(eta, 3)), *normal, pressure, rate)
        numbers = dict(zip(NUMBERS, values, strict=True)) | {"stress": min(1.0, 1.7 * knudsen)}
        if knudsen > 1.0:
            numbers["stress"] = 0.99
        for name, value in list(numbers.items()):
            size = error * sizes.get(name, 0.003)
            numbers |= {name: value + size * rng.normal(), f"{name}_error": size, f"{name}_freedom": 19.0}
        flow = place / (1.0 + 2.0 * knudsen)
        shown = {"place": place, "flow": flow, "temperature": 1.1 - 0.13 * (speed * flow) ** 2}
        shown |= {"flow_error": np.full(10, 0.001), "temperature_error": np.full(10, 0.001)}
        at = {"engine": engine, "packing_fraction": eta, "knudsen": knudsen, "speed": speed}
        rows.append({"part": "flows", **at, **numbers, **shown})
    for eta, off in ((0.1, 0.002), (0.3, -0.002)):
        ratio = {"viscosity": 1.0 + off * error, "viscosity_error": 0.006 * error, "viscosity_freedom": 79.0}
        rows.append({"part": "sheared", "engine": "event-driven", "packing_fraction": eta, **ratio})
    still = {"viscosity": 1.0, "viscosity_error": 0.004 * error, "viscosity_freedom": 7.0}
    rows.append({"part": "equilibrium", "engine": "event-driven", "packing_fraction": 0.3, **still})
    return from_rows("point", rows, ("bin",))


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
    return measure.couette([point], SETTINGS).isel(point=0)


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
    gap = measure.Gap(20.0, 1.0, 1.0, 1.0, 3)
    setting = measure.FlowBetweenPlates(gap, 1.0, 1.0, True, 1.0, place, np.abs(place) < 7.0)
    gradient = 1.0 / (20.0 + 2.0 * 1.25)
    velocity = gradient * place
    squares = np.stack([np.ones(40), 1.0 + velocity**2, np.ones(40)], axis=1)
    eta = float(measure.theory.enskog_viscosity(0.0, 3))
    averages = np.full(40, density), density * velocity, density * squares
    values = measure._gap_numbers(setting, eta * gradient, density, *averages)
    found = dict(zip(("stress", *measure.NUMBERS), values, strict=True))
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
    row = measure.couette([point], SETTINGS | parts).isel(point=0)
    assert row["part"] == "sheared" and abs(float(row["packing_fraction"]) - 0.1) < 1e-4
    assert abs(float(row["viscosity"]) - 1.0) < 4.5 * float(row["viscosity_error"]) < 0.3
    assert 0.05 < float(row["reduced_rate"]) < 0.12
    assert abs(sum(float(row[f"normal_{name}"]) for name in "xyz")) < 1e-12


def test_what_theory_states_agrees():
    found = judged(claims_of_couette(measured()))
    assert len(found) == 2 + 1 + 1 + 2 + 1 + 3 + 1 + 1 + 2
    assert set(found.values()) == {"agrees"}


@pytest.mark.parametrize(
    ("point", "name", "factor", "text"),
    [
        (0, "viscosity", 0.97, "over Enskog's viscosity, dilute"),
        (0, "slip", 0.8, "velocity slip"),
        (4, "viscosity", 1.1, "over Enskog's viscosity, spheres at"),
        (4, "viscosity", 1.06, "from the response over that from equilibrium"),
        (6, "viscosity", 1.06, "from uniform shear over that from equilibrium"),
        (3, "pressure", 1.01, "pressure on the walls"),
        (2, "stress", 0.9, "free flight"),
        (1, "heating", 1.2, "-dT/du^2"),
        (1, "normal_y", -0.9, "along gradient"),
        (1, "pressure", 1.003, "on the walls less pressure"),
    ],
)
def test_each_claim_can_fail(point, name, factor, text):
    ds = measured()
    values = ds[name].values.copy()
    values[point] *= factor
    assert "disagrees" in about(claims_of_couette(ds.assign({name: (ds[name].dims, values)})), text)


def test_noise_is_inconclusive():
    ds = measured(error=30.0)
    found = judged(claims_of_couette(ds))
    assert "inconclusive" in set(found.values()) and np.isfinite(ds["slip"].values[0])
    for text in ("velocity slip", "from the response", "over Enskog's viscosity, dilute"):
        assert {verdict for claim, verdict in found.items() if text in claim} == {"inconclusive"}


def test_profiles_and_coefficients_are_drawn():
    ds = measured()
    velocity, temperature, stress, viscosity, slip, normal = draw(draw_couette, ds).axes

    def points(x, name, *which, shift=0.0):
        one = ds.isel(point=list(which))
        return Points(one[x] + shift, *estimates(one, name))

    shows(velocity, *(points("place", "flow", n) for n in (2, 3, 4)))
    squares = {n: (ds["speed"][n] * ds["flow"][n]) ** 2 for n in (1, 0)}
    warm = {n: estimates(ds.isel(point=n), "temperature") for n in squares}
    shows(temperature, *(Points(squares[n], *warm[n]) for n in squares))
    shows(stress, points("knudsen", "stress", 0, 2), points("knudsen", "stress", 3))
    eta = "packing_fraction"
    uniform = points(eta, "viscosity", 5, 6, shift=-0.005)
    still = points(eta, "viscosity", 7, shift=0.005)
    shows(viscosity, points(eta, "viscosity", 0), points(eta, "viscosity", 3, 4), uniform, still)
    shows(slip, points(eta, "slip", 0), points(eta, "slip", 3, 4))
    dilute = ds.isel(point=[0, 1])
    square = dilute["reduced_rate"] ** 2
    shows(normal, *(Points(square, *estimates(dilute, f"normal_{axis}")) for axis in "xyz"))
