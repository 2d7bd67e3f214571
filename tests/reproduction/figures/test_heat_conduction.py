"""Heat between walls: what short runs conserve, and blocks and profiles with known answers."""

from pathlib import Path

import numpy as np
import pytest
from reproduction.made import made

import gaspart as gp
from gaspart.reproduction.figures import heat_conduction_gas, heat_conduction_metal
from gaspart.reproduction.figures._gap import Averages, Gap, averages
from gaspart.reproduction.points.point import Point
from gaspart.reproduction.table import entries, from_rows
from gaspart.theory.heat import METAL_GAP


@pytest.mark.thorough
def test_what_the_walls_give_is_what_the_particles_gain(tmp_path):
    container = gp.Container((10.2, 6.0, 6.0), ("wall", "periodic", "periodic"))
    species = [gp.Species(20, 0.1, temperature=1.4)]
    faces = {"x_low": gp.Thermal(2.0), "x_high": gp.Thermal(1.0)}
    scene = gp.Scene(container, species, faces=faces)
    point = made(tmp_path, "heat", scene, duration=200.0, equilibration=20.0, samples=40, replicas=1)
    found = averages(point, Gap.of(scene), blocks=8, bins=4)
    blocks = np.diff(found.stored[0, :, 0]) / 25.0 / 36.0  # of 5 samples, each 5 long
    assert found.heat_in - found.heat_out == pytest.approx(blocks, abs=1e-9)
    assert found.imbalance < 1e-9
    assert found.density.mean(axis=1) == pytest.approx(np.full(8, 20 / 360))
    with pytest.raises(ValueError, match="blocks"):
        averages(point, Gap.of(scene), blocks=1000, bins=4)


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
def test_replicas_with_other_places_of_scatterers_are_one_block_each(tmp_path):
    """Their scatter is the uncertainty of the flux, which stretches of one run do not have."""
    faces = {"x_low": gp.Thermal(2.0), "x_high": gp.Thermal(1.0)}
    species = [gp.Species(20, 0.02, temperature=1.4), gp.Species(8, 0.5, fixed=True, vibration=1.4)]
    scene = gp.Scene(gp.Container((8.0, 6.0), ("wall", "periodic")), species, faces=faces)
    point = made(tmp_path, "heat", scene, duration=400.0, equilibration=100.0, samples=40, replicas=3)
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


@pytest.mark.parametrize(
    ("change", "subjects"),
    [
        ({}, {"energy of a mode", "second-order", "flux among", "heat capacity"}),
        ({"gap_over_path": 5.0}, {"energy of a mode", "flux among", "heat capacity"}),
        ({"hot": 1.5}, {"energy of a mode", "flux among", "heat capacity"}),
        ({"regular": False}, {"energy of a mode", "second-order", "heat capacity"}),
    ],
)
def test_a_metal_is_compared_where_theory_has_been_computed(change, subjects):
    """The bend between walls at 2 and 1, of this gap; the flux of a grid only with that of random places."""
    row = {"hot": 2.0, "cold": 1.0, "expected": 360.0, "gap_over_path": METAL_GAP, "regular": False}
    row |= {"position": np.linspace(0.1, 0.9, 8), "electrons": np.linspace(1.9, 1.1, 8)}
    row |= entries(dict.fromkeys(("share", "flux", "bend"), (1.0, 0.01)))
    metals = from_rows("point", [row | change, row | {"regular": True} | change], ("bin",))
    metals = metals.assign(electrons_error=0.01 * metals["electrons"], slope=1.0, slope_error=0.01)
    claimed = [one.claim for one in heat_conduction_metal.claims(metals)]
    texts = {"energy of a mode", "second-order", "flux among", "heat capacity"}
    assert {text for text in texts if any(claim.startswith(text) for claim in claimed)} == subjects
