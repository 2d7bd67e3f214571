"""Made-up pressures on walls with known answers, in the form that `measure.wall_pressure` gives."""

from __future__ import annotations

import numpy as np
import pytest
import xarray as xr
from reproduction.claims.data import judged
from reproduction.families.drawn import Points, draw, shows, varied

import gaspart as gp
from gaspart import theory
from gaspart.analysis.run import Run
from gaspart.errors import SceneError
from gaspart.reproduction.families.pressure import measure
from gaspart.reproduction.families.pressure.claims import wall_pressure as claims_of_wall_pressure
from gaspart.reproduction.families.pressure.figure import wall_pressure as draw_wall_pressure
from gaspart.reproduction.points.point import Point

CONTAINERS = [  # dimension, walled axes, length, other lengths, count, temperature
    *((2, 1, 60.0, 15.0, count, 1.0) for count in (57, 115, 229)),
    *((3, 1, 30.0, 8.0, count, 1.0) for count in (73, 367, 733)),
    (2, 2, 28.025, 0.0, 100, 1.0),
    (3, 3, 8.682, 0.0, 125, 1.0),
    *((2, 1, 60.0, 15.0, 229, temperature) for temperature in (0.25, 4.0)),
]


def pressures(relative_error=5e-4, factor=1.0, seed=1):
    """Pressures with Gaussian scatter about `factor` times theory's."""
    rng = np.random.default_rng(seed)
    rows = []
    for dimension, axes, length, other, count, temperature in CONTAINERS:
        width = other ** (dimension - axes)
        inner = (length - 1.0) ** axes * width
        expected, error = theory.wall_pressure(length, count / inner, count, dimension, axes)
        density = count / (length**axes * width)
        eta = theory.packing_fraction(density, dimension)
        pressure = expected * factor * (1.0 + relative_error * rng.standard_normal())
        rows.append({
            "pressure": pressure + error * rng.standard_normal(),
            "pressure_error": relative_error * expected,
            "whole_pressure": pressure * ((length - 1.0) / length) ** (axes - 1),
            "bulk_pressure": density * float(theory.compressibility_factor(eta, dimension)),
            "expected": expected,
            "expected_error": error,
            "density": density,
            "packing_fraction": eta,
            "temperature": temperature,
            "count": count,
            "dimension": dimension,
            "axes": axes,
            "length": length,
        })  # fmt: skip
    return xr.Dataset({name: ("point", np.array([row[name] for row in rows])) for name in rows[0]})


# Pressure on walls from trajectories: of one particle, exactly, and of a short run of a gas.


def point(tmp_path, **settings):
    settings = {
        "dimension": 2, "radius": 0.5, "side": [20, 10], "boundary": ["wall", "periodic"], "count": 40,
        "temperature": 1.0, "collisions_per_particle": 300, "equilibration": 20, "samples": 32,
    } | settings  # fmt: skip
    made = Point("some", "single", "simulate", settings, str(tmp_path), 1)
    recipe = made.parameters
    gp.run(
        made.scene,
        made.engine,
        seed=made.seed(),
        duration=recipe["duration"],
        sample_interval=recipe["sample_interval"],
        path=tmp_path / "some/single/replica-0.nc",
    )
    return made


def test_a_gas_between_two_walls_has_the_pressure_of_theory(tmp_path):
    (tmp_path / "some/single").mkdir(parents=True)
    row = measure.wall_pressure([point(tmp_path, temperature=3.0)], {}).isel(point=0)
    assert float(row["temperature"]) == pytest.approx(3.0, rel=0.5)
    assert float(row["pressure_error"] / row["pressure"]) < 0.03
    assert abs(float(row["pressure"] - row["expected"])) < 4.0 * float(row["pressure_error"])
    # the force counts over the same area: the other axis has no walls
    assert float(row["whole_pressure"]) == pytest.approx(float(row["pressure"]))
    assert float(row["density"]) == pytest.approx(40 / 200)


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
    pressure, temperature, count = measure._replica(run)
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
        measure.wall_pressure([Point("some", "single", "simulate", settings, str(tmp_path), 1)], {})


def verdicts(dataset):
    return judged(claims_of_wall_pressure(dataset))


def test_right_data_agree():
    found = verdicts(pressures())
    assert set(found.values()) == {"agrees"}
    assert any(text.startswith("pressure of 125 spheres") for text in found)
    assert sum("bulk pressure at N/V" in text for text in found) == 2


def test_a_bias_of_half_a_percent_is_found():
    found = verdicts(pressures(factor=1.005))
    assert found["pressure of spheres between two walls over theory's, mean of 3 slits"] == "disagrees"


def test_short_runs_are_inconclusive():
    assert "inconclusive" in verdicts(pressures(relative_error=0.01)).values()


def test_an_energy_scale_is_found():
    dataset = pressures()
    dataset["pressure"] = dataset["pressure"] * dataset["temperature"] ** 0.01
    found = verdicts(dataset)
    assert next(v for text, v in found.items() if text.startswith("exponent")) == "disagrees"


def deviation(ds, points, shift):
    """100 (P / theory - 1) of some containers, with both uncertainties."""
    own = ds.isel(point=points)
    error = 100.0 * np.hypot(own["pressure_error"], own["expected_error"]) / own["expected"]
    ratio = own["pressure"] / own["expected"]
    return Points(own["packing_fraction"] + shift, 100.0 * (ratio - 1.0), error)


def test_pressures_against_temperature_and_density_and_their_deviation():
    ds = varied(pressures(), "density", "temperature")
    temperatures, densities, residuals = draw(draw_wall_pressure, ds).axes
    series = ds.isel(point=[2, 8, 9]).sortby("temperature")
    t, n = series["temperature"], float(series["density"][0].round(9))
    shows(temperatures, Points(t, series["pressure"] / n, series["pressure_error"] / n))
    expected = []
    for dimension in (2, 3):
        own = ds.isel(point=(ds["dimension"] == dimension).values)
        corrected = own["bulk_pressure"] / own["expected"] / own["density"]
        expected += [
            Points(own["packing_fraction"], own["whole_pressure"] / own["density"]),
            Points(own["packing_fraction"], own["pressure"] * corrected, own["pressure_error"] * corrected),
        ]
    shows(densities, *expected)
    groups = ([0, 1, 2, 8, 9], 0.0), ([6], 0.003), ([3, 4, 5], 0.0), ([7], 0.003)
    shows(residuals, *(deviation(ds, *group) for group in groups))
    axes = draw(draw_wall_pressure, pressures().isel(point=[0, 1, 6])).axes  # discs only, at one temperature
    shows(axes[0])
    assert len(axes[1].containers) == 2
