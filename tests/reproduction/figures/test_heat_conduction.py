"""Heat between walls: short runs, and blocks and profiles with known answers."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from reproduction.made import made

import gaspart as gp
from gaspart.reproduction.figures import heat_conduction_gas, heat_conduction_metal
from gaspart.reproduction.figures._gap import Averages, Gap, averages
from gaspart.reproduction.figures.heat_conduction_gas import FRAMES
from gaspart.reproduction.points.point import Point
from gaspart.theory.heat import free_molecular_flux


def run(tmp_path, scene, **settings):
    """A point of this scene with its runs made."""
    return made(tmp_path, "heat", scene, **{"replicas": 1} | settings)


def gas(count, radius, components="all"):
    """Spheres between walls at 2 and 1."""
    container = gp.Container((10.0 + 2 * radius, 6.0, 6.0), ("wall", "periodic", "periodic"))
    faces = {"x_low": gp.Thermal(2.0, components), "x_high": gp.Thermal(1.0, components)}
    return gp.Scene(container, [gp.Species(count, radius, temperature=1.4)], faces=faces)


def test_the_gap_is_where_centres_can_be():
    assert Gap.of(gas(10, 0.5)) == Gap(length=10.0, area=36.0, hot=2.0, cold=1.0, dimension=3)


@pytest.mark.thorough
def test_what_the_walls_give_is_what_the_particles_gain(tmp_path):
    point = run(tmp_path, gas(20, 0.1), duration=200.0, equilibration=20.0, samples=40)
    found = averages(point, Gap.of(gas(20, 0.1)), blocks=8, bins=4)
    blocks = np.diff(found.stored[0, :, 0]) / 25.0 / 36.0  # of 5 samples, each 5 long
    assert found.heat_in - found.heat_out == pytest.approx(blocks, abs=1e-9)
    assert found.imbalance < 1e-9
    assert found.density.mean(axis=1) == pytest.approx(np.full(8, 20 / 360))
    with pytest.raises(ValueError, match="blocks"):
        averages(point, Gap.of(gas(20, 0.1)), blocks=1000, bins=4)


def test_the_flux_is_without_what_the_particles_store():
    """Blocks whose energy fluctuates around a flux of 3, and is given back in the next."""
    rng = np.random.default_rng(5)
    energy = rng.normal(size=(1, 201))
    moment = rng.normal(size=(1, 201))
    change = np.diff(energy)[0]
    found = Averages(
        3.0 + change, np.full(200, 3.0), *np.ones((2, 200, 1)), 0.0, np.stack([energy, moment], -1), 600.0
    )
    assert found.flux().value == pytest.approx(3.0, abs=1e-12)
    assert found.wall_ratio().value == pytest.approx(600.0 / (600.0 + change.sum()))


@pytest.mark.thorough
def test_a_thin_gas_carries_what_free_flight_does(tmp_path):
    """Uniform too, with the temperature sqrt(T1 T2) of two half Maxwellians."""
    point = run(tmp_path, gas(40, 0.01), duration=6000.0, equilibration=100.0, samples=400)
    ds = heat_conduction_gas.measure([point], {"bins": 5, "blocks": 10, "clear": 3}).isel(point=0)
    assert float(ds["number"]) == pytest.approx(40 / 360)
    assert float(ds["full"]) == pytest.approx(free_molecular_flux(40 / 360, 2.0, 1.0, 3))
    assert float(ds["flux_error"]) < 0.05 * float(ds["full"])
    assert abs(float(ds["flux"] - ds["full"])) < 3.5 * float(ds["flux_error"])
    assert float(ds["imbalance"]) < 1e-9
    sigma = ds["density_error"].values.mean()
    assert np.abs(ds["density"].values / (40 / 360) - 1.0).max() < 4.0 * sigma / (40 / 360)
    assert ds["temperature"].values == pytest.approx(np.full(5, np.sqrt(2.0)), rel=0.05)
    assert np.isnan(ds["slab_flux"]) and np.isnan(ds["approach"]).all()


def test_the_jump_of_a_made_up_profile_comes_back():
    """T^(3/2) linear between 1.9 and 1.05, where the walls have 2 and 1: slopes and paths by hand."""
    gap = Gap(100.0, 1.0, 2.0, 1.0, 3)
    position = np.linspace(5.0, 95.0, 30)
    power = 1.9**1.5 + (1.05**1.5 - 1.9**1.5) * position / 100.0
    temperature, pressure = power ** (2 / 3), 1e-4
    found = heat_conduction_gas.jump(gap, position, np.full(30, pressure), pressure / temperature, 1.0)
    slope = (1.9**1.5 - 1.05**1.5) / 100.0
    path = 1.0 / (np.sqrt(2.0) * np.pi * pressure)
    hot = 0.1 / (path * 1.9 * slope / (1.5 * np.sqrt(1.9)))
    cold = 0.05 / (path * 1.05 * slope / (1.5 * np.sqrt(1.05)))
    assert found == pytest.approx(0.5 * (hot + cold), rel=1e-3)


@pytest.mark.thorough
def test_a_dense_gas_is_compared_with_fourier(tmp_path):
    point = run(tmp_path, gas(100, 0.5), duration=300.0, equilibration=100.0, samples=60, boxes_per_side=1)
    ds = heat_conduction_gas.measure([point], {"bins": 5, "blocks": 12, "clear": 1}).isel(point=0)
    assert float(ds["knudsen"]) < heat_conduction_gas.FLUID
    assert float(ds["density"].mean()) == pytest.approx(100 / 360, rel=1e-3)
    assert float(ds["profile_ratio"]) == pytest.approx(1.0, abs=0.1)
    assert ds["approach_time"].values == pytest.approx(5.0 * np.arange(FRAMES))
    deviation = (ds["approach"] - ds["expected_approach"]) / ds["approach_error"]
    assert abs(float(deviation.mean())) < 1.0 and float(abs(deviation).max()) < 5.0
    assert float(ds["expected_approach"][-1]) == pytest.approx(0.35, abs=0.1)
    with pytest.raises(ValueError, match="blocks"):
        heat_conduction_gas.measure([point], {"bins": 5, "blocks": 1000, "clear": 1})


@pytest.mark.thorough
def test_modes_and_electrons_have_the_temperature_of_the_walls(tmp_path):
    """Whatever they began with; two temperatures give the heat capacity."""
    points = []
    for warm in (1.0, 2.0):
        faces = dict.fromkeys(("x_low", "x_high"), gp.Thermal(warm))
        species = [gp.Species(30, 0.02, temperature=1.0), gp.Species(10, 0.5, fixed=True, vibration=0.0)]
        scene = gp.Scene(gp.Container((8.0, 8.0), ("wall", "periodic")), species, faces=faces)
        folder = tmp_path / str(warm)
        folder.mkdir()
        points.append(run(folder, scene, duration=6000.0, equilibration=100.0, samples=600))
    ds = heat_conduction_metal.measure(points, {"bins": 2, "blocks": 10})
    assert ds["expected"].values == pytest.approx([40.0, 40.0])
    for name in ("energy_ratio", "mode_ratio"):
        assert (np.abs(ds[name] - 1.0) < 4.0 * ds[f"{name}_error"]).all()
    assert (np.abs(ds["log_fluctuation"]) < 4.0 * ds["log_fluctuation_error"]).all()
    assert np.isnan(ds["bend"]).all()  # of two bins
    assert ds["mode_ratio"].values == pytest.approx([1.0, 1.0], abs=0.05)
    assert float(ds["slope"]) == pytest.approx(1.0, abs=0.05)


@pytest.mark.thorough
def test_replicas_with_other_places_of_scatterers_are_one_block_each(tmp_path):
    """Their scatter is the uncertainty of the flux, which stretches of one run do not have."""
    faces = {"x_low": gp.Thermal(2.0), "x_high": gp.Thermal(1.0)}
    species = [gp.Species(20, 0.02, temperature=1.4), gp.Species(8, 0.5, fixed=True, vibration=1.4)]
    scene = gp.Scene(gp.Container((8.0, 6.0), ("wall", "periodic")), species, faces=faces)
    point = run(tmp_path, scene, duration=400.0, equilibration=100.0, samples=40, replicas=3)
    both = heat_conduction_metal.measure_metal(point, {"bins": 3, "blocks": 10})
    alone = []
    for k in range(3):
        one = Point("heat", "single", "simulate", point.settings | {"replicas": 1}, str(tmp_path / str(k)), 1)
        Path(one.replica_paths[0]).parent.mkdir(parents=True)
        Path(point.replica_paths[k]).rename(one.replica_paths[0])
        alone.append(heat_conduction_metal.measure_metal(one, {"bins": 3, "blocks": 10}))
    flux, fluxes = both["flux"], [one["flux"].value for one in alone]
    assert flux.value == pytest.approx(np.mean(fluxes), rel=1e-9)
    assert flux.error == pytest.approx(np.std(fluxes, ddof=1) / 3**0.5, rel=1e-9)
    assert flux.freedom == 2 and alone[0]["flux"].freedom == 9
    # the free area over half the perimeter of 8 discs of 0.52, on 7.96 of 8 by 6
    free = 7.96 * 6.0 - 8 * np.pi * 0.52**2
    assert both["gap_over_path"] == pytest.approx(7.96 * 2.0 * 8 * 0.52 / free)


def test_a_bent_profile_is_distinguished_from_a_straight_one():
    position = (np.arange(10) + 0.5) / 10
    straight, bent = 2.0 - position, 2.0 - position + 0.3 * position**2
    straight[[0, -1]] = 1.5  # next to the walls
    assert heat_conduction_metal.bend(straight) == pytest.approx(0.0, abs=1e-12)
    assert heat_conduction_metal.bend(bent) == pytest.approx(0.3)
