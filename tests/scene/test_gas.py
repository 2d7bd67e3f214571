"""The plain gas that a scene is."""

from dataclasses import replace

import pytest

import gaspart as gp
from gaspart import theory
from gaspart.scene.facts import Gas, plain_gas

BOX = gp.Container((10.0, 8.0), "periodic")
DISCS = gp.Species(50, 0.3, mass=2.0, temperature=1.5)


def test_a_plain_gas_has_what_theory_takes():
    gas = gp.Scene(BOX, [DISCS]).gas
    assert gas == Gas(2, pytest.approx(gp.Scene(BOX, [DISCS]).packing_fraction), 50, 0.6, 1.5, 2.0)
    assert gas.thermal_speed == pytest.approx(0.75**0.5)
    rate = theory.collision_rate(gas.packing_fraction, 2, 0.6, 1.5, 2.0)
    assert theory.collision_rate(**gas.parameters) == rate


def test_its_temperature_is_that_of_the_initial_velocities():
    speeds = replace(DISCS, temperature=None, speed=3.0)
    still = replace(DISCS, temperature=None)
    fast = gp.Particle((1.0, 1.0), (4.0, 0.0), 0.3, mass=2.0)
    assert gp.Scene(BOX, [speeds]).gas.temperature == 9.0
    assert gp.Scene(BOX, [still]).gas.temperature == 0.0
    assert gp.Scene(BOX, [still], [fast]).gas.temperature == pytest.approx(16.0 / 51.0)
    assert gp.Scene(BOX, [DISCS, replace(speeds, count=25)]).gas.temperature == pytest.approx(4.0)


@pytest.mark.parametrize(
    "more",
    [
        {"restitution": gp.Restitution(normal=0.9)},
        {"restitution": gp.Restitution(tangential=1.0)},
        {"container": gp.Container((10.0, 8.0)), "gravity": (0.0, -1.0)},
        {"walls": [gp.Wall((1.0, 1.0), (2.0, 1.0))]},
        {"species": []},
        {"species": [DISCS, replace(DISCS, radius=0.2)]},
        {"species": [DISCS, replace(DISCS, mass=1.0)]},
        {"species": [gp.Species(5, 0.3, fixed=True)]},
    ],
)
def test_other_scenes_are_none(more):
    assert gp.Scene(BOX, [DISCS]).gas is not None
    assert replace(gp.Scene(BOX, [DISCS]), **more).gas is None


def test_no_species_of_no_particles_and_no_rule_of_walls_changes_it():
    scene = gp.Scene(gp.Container((10.0, 8.0)), [DISCS])
    kinds = [DISCS, replace(DISCS, count=0, radius=0.1)]
    changed = replace(scene, species=kinds, centres_to_walls=True, restitution=gp.Restitution())
    assert changed.gas == scene.gas


@pytest.mark.parametrize(
    ("scene", "line"),
    [
        (
            {"species": [gp.Species(9, 0.3, polydispersity=0.2)]},
            r"species.polydispersity = 0.2: .*without radii that differ",
        ),
        ({"species": []}, "count = 0: .*the scene is empty"),
    ],
)
def test_a_scene_that_is_no_plain_gas_is_told_why(scene, line):
    container = gp.Container((9.0, 9.0, 9.0), boundary="periodic")
    with pytest.raises(gp.SceneError, match=line):
        plain_gas(gp.Scene(container, **scene))
