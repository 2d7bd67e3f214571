"""Rough, inelastic and driven gases: what is read of small runs, and of frames that are known exactly."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
import scenes
import xarray as xr
from reproduction.made import made

import gaspart as gp
from gaspart import theory
from gaspart.analysis.run import Run
from gaspart.reproduction.figure import runs
from gaspart.reproduction.figures import cooling, driven_gas, equipartition


def gas(count=256, dimension=2, packing_fraction=0.02, **scene):
    side = float((count * theory.particle_volume(dimension) / packing_fraction) ** (1 / dimension))
    inertia = {"moment_of_inertia": 0.125} if dimension == 2 else {}
    return gp.Scene(
        gp.Container((side,) * dimension, "periodic"),
        [gp.Species(count, 0.5, temperature=2.0, **inertia)],
        **scene,
    )


def test_rough_discs_share_as_theory_says(tmp_path):
    rough = gas(restitution=gp.Restitution(1.0, 1.0))
    lossy = gas(restitution=gp.Restitution(1.0, 0.5))
    points = [
        made(tmp_path, "start", rough, duration=40.0, samples=10),
        made(tmp_path, "still", rough, duration=400.0, samples=64, equilibration=60.0),
        made(tmp_path, "lossy", lossy, duration=300.0, samples=40),
    ]
    ds = equipartition.measure(points, {"steady_from": 10.0})
    assert ds["inertia"].item() == pytest.approx(0.5)
    assert ds["translation"][0, 0] == 1.0 and ds["rotation"][0, 0] == pytest.approx(0.0, abs=1e-6)
    assert abs(ds["rate"].item() - 2.0 / 3.0) < 4.0 * ds["rate_error"].item() < 0.5
    assert abs(ds["equilibrium_ratio"].item() - 1.0) < 4.0 * ds["equilibrium_ratio_error"].item() < 0.3
    assert abs(ds["steady_ratio"].item() - theory.rough_ratio(0.5, 0.5)) < 0.1
    # the energy of a gas without losses is conserved: 2 (N - 1) T_tr + N T_rot, less the drift's own
    run = equipartition.read(points[0])[0]
    total = 2.0 * 255 * run.translation + 256 * run.rotation
    assert total == pytest.approx(np.full(11, total[0]), rel=2e-3)


def test_rough_walls_mix_velocity_and_spin_as_theory_says(tmp_path):
    scene = gp.Scene(
        gp.Container((4000.0, 10.0002), ("periodic", "wall")),
        [gp.Species(2048, 0.0001, mass=2.0, temperature=4.0, moment_of_inertia=0.6e-8)],
        restitution=gp.Restitution(1.0, 1.0),
    )
    ds = equipartition.measure(
        [made(tmp_path, "walls", scene, duration=18.0, samples=18)], {"steady_from": 1.0}
    )
    row = ds.isel(walls=0)
    assert float(row["wall_inertia"]) == pytest.approx(0.3)
    assert row["wall_time"][-1] == pytest.approx(18.0 * np.sqrt(2.0) / 10.0)
    assert row["wall_translation"][0] == 1.0 and row["wall_rotation"][0] == pytest.approx(0.0, abs=1e-6)
    total = row["wall_translation"] + row["wall_rotation"]
    assert total.values == pytest.approx(np.ones(19), abs=0.01)  # hardly any collisions
    for name in ("exchange", "wall_ratio"):
        assert abs(row[name] - 1.0) < 4.0 * row[f"{name}_error"] < 0.2, name


def test_an_inelastic_gas_cools_as_haff_says_and_the_number_variance_is_counted(tmp_path):
    points = [
        made(tmp_path, "haff", gas(restitution=gp.Restitution(0.8)), duration=200.0, samples=16),
        made(
            tmp_path,
            "dense",
            gas(packing_fraction=0.2, restitution=gp.Restitution(0.9)),
            duration=9.0,
            samples=3,
        ),
    ]
    ds = cooling.measure(points, {"clustering": ["dense"], "cells_per_side": 4})
    assert abs(ds["rate"].item() - theory.cooling_rate(0.8, 2)) < 4.0 * ds["rate_error"].item() < 0.05
    assert abs(ds["exponent"].item() + 2.0) < 0.15
    assert ds.sizes["particle"] == 256 and ds.attrs["side"] > 0.0
    assert ds["cluster_excess"].values == pytest.approx(np.ones((1, 4)), rel=0.1)
    assert np.all((ds["variance"].values > 0.1) & (ds["variance"].values < 1.0))


def test_number_variance_of_equal_cells_is_zero_and_of_one_cell_is_largest():
    scene = gp.Scene(gp.Container((4.0, 4.0), "periodic"), [gp.Species(8, 0.1)])
    even = np.array([[x + 0.5, y + 0.5] for x in (0, 1) for y in (0, 1)] * 2)
    frames = np.stack([2.0 * even, np.full((8, 2), 4.0)])  # the last on the upper boundary
    positions = xr.Dataset({"coordinates": (("frame", "atom", "spatial"), frames)})
    assert cooling.number_variance(Run(scene, np.arange(2.0), positions), 2) == pytest.approx([0.0, 6.0])


@pytest.mark.thorough
def test_a_driven_gas_is_at_the_temperature_of_the_energy_balance(tmp_path):
    scene = replace(
        scenes.gas(2, 128, 0.02), restitution=gp.Restitution(0.6), thermostat=gp.Thermostat(0.03, 0.25)
    )
    point = made(tmp_path, "driven", scene, duration=1000.0, samples=50, equilibration=200.0)
    ds = driven_gas.measure([point], {}).isel(gas=0)
    power = 0.03 * (1.0 - 1.0 / 128)
    expected = theory.driven_temperature(0.6, 2, 0.03, 0.02)
    assert abs(ds["temperature"] / expected - 1.0) < 4.0 * ds["temperature_error"] / expected + 0.02
    assert ds["temperature_error"] < 0.05 * expected
    assert ds["given"] == pytest.approx(power, abs=4.0 * float(ds["given_error"]) + 1e-3 * power)
    assert ds["lost"] == pytest.approx(power, rel=0.05)


def test_the_cumulant_is_that_of_the_velocities(tmp_path):
    """Of one frame with known speeds: those of the centre of mass are left out."""
    particles = [
        gp.Particle((2.0 + 3.0 * n, 5.0), (v + 7.0, 0.5), 0.1) for n, v in enumerate((1.0, -1.0, 2.0, -2.0))
    ]
    scene = gp.Scene(
        gp.Container((100.0, 10.0), "periodic"), particles=particles, species=[gp.Species(0, 0.1)]
    )
    scene.to_file(tmp_path / "scene.yaml")
    point = made(tmp_path, "still", scene, duration=0.001, samples=1, replicas=1)
    (found,) = [driven_gas.means(run) for run in runs(point)]
    squares = np.array([1.0, 1.0, 4.0, 4.0])
    assert found["temperature"] == pytest.approx(squares.mean() * 4 / (2 * 3), rel=1e-6)
    assert found["cumulant"] == pytest.approx(
        2 * (squares**2).mean() / (4 * squares.mean() ** 2) - 1, rel=1e-6
    )
