"""The scales of a scene, and the duration and interval that follow from them. Nothing is run here."""

import math
from dataclasses import replace

import pytest
from scenes import gas

import gaspart as gp
from gaspart.accuracy.scales import scales
from gaspart.accuracy.target import Target
from gaspart.cli import main

SI = gp.Scene(
    gp.Container((1e-8,) * 3, "periodic"), gp.Species(100, 1.8e-10, mass=6.6e-26, temperature=300.0)
)
AT_REST = gp.Scene(gp.Container((9.0, 16.0)), gp.Species(4, 0.5))


@pytest.mark.parametrize("dimension", [2, 3])
def test_those_of_a_plain_gas_are_theory(dimension):
    scene = gas(dimension, 100, 0.2)
    found, plain = scales(scene), scene.gas
    assert found.thermal_speed == pytest.approx(plain.thermal_speed, rel=1e-14)
    assert found.collision_time == pytest.approx(
        1.0 / gp.theory.collision_rate(**plain.parameters), rel=1e-14
    )
    path = gp.theory.mean_free_path(plain.packing_fraction, dimension, diameter=plain.diameter)
    assert found.mean_free_path == pytest.approx(float(path), rel=1e-12)
    assert found.crossing_time == min(scene.container.lengths) / found.thermal_speed
    assert found.packing_fraction == pytest.approx(0.2)


def test_a_mixture_of_nearly_equals_has_the_scales_of_the_gas():
    whole = gas(3, 1000, 0.2)
    half = replace(whole.species[0], count=500)
    halves = replace(whole, species=[half, replace(half, mass=1.0001)])
    assert halves.gas is None
    assert scales(halves).collision_time == pytest.approx(scales(whole).collision_time, rel=0.01)
    assert scales(halves).thermal_speed == pytest.approx(1.0, rel=1e-3)


def test_time_scales_as_it_must_and_faces_can_be_hotter():
    scene = gas(2, 100, 0.1, "wall")
    hot = replace(scene, species=[replace(scene.species[0], temperature=4.0)])
    by_faces = replace(scene, faces={"x_low": gp.Thermal(4.0)})
    for other in (hot, by_faces):
        assert scales(other).crossing_time == pytest.approx(0.5 * scales(scene).crossing_time)
        assert scales(other).collision_time == pytest.approx(0.5 * scales(scene).collision_time, rel=0.15)


def test_what_falls_has_the_time_of_its_fall_and_what_rests_has_none():
    falling = scales(replace(AT_REST, gravity=(0.0, -4.0)))
    assert falling.crossing_time == falling.event_time == pytest.approx(9.0 / 6.0)
    assert falling.interval == 1.5 and falling.duration == 15.0
    assert scales(AT_REST).interval is scales(AT_REST).duration is None
    alone = replace(AT_REST, species=[], particles=gp.Particle((4.0, 4.0), (1.0, 0.0), 0.5))
    assert scales(alone).mean_free_path == scales(alone).collision_time == float("inf")
    assert scales(AT_REST).lines == ["scales: nothing moves at the start, and nothing falls"]


@pytest.mark.parametrize(
    "scene", [gas(3, 100, 1e-4), gas(3, 100, 0.3), gas(2, 40_000, 0.6, arrangement="lattice"), SI]
)
def test_the_suggestion_is_a_run_that_the_program_takes(scene):
    found = scales(scene)
    frames = found.duration / found.interval
    assert frames == pytest.approx(round(frames), rel=1e-9) and 100 <= frames <= 1001
    assert found.duration >= 199.0 * found.collision_time and found.duration >= 9.9 * found.crossing_time


def test_units_of_which_k_b_is_not_one_are_noticed():
    assert "units: k_B is 1" in scales(SI).lines[-1] and "thermal speed 6.74e+13" in scales(SI).lines[0]
    assert len(scales(gas(3, 100, 0.1)).lines) == 2


def test_check_and_a_run_without_a_duration_suggest_one(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    scene = gas(2, 20, 0.1)
    scene.to_file("scene.yaml")
    first, suggested = scales(scene).lines
    assert main(["check", "scene.yaml"]) == 0
    assert capsys.readouterr().out.splitlines()[-2:] == [first, suggested]
    assert main(["run", "scene.yaml", "-o", "run.nc"]) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert "are required: --duration, --sample-interval, or --until" in line
    assert line.endswith(f"for this scene {suggested.removeprefix('suggested: ')}")


def test_a_run_is_suggested_in_which_a_piston_leaves_room():
    container = gp.Container((80.0, 60.0), ("wall", "periodic"))
    species = [gp.Species(700, 0.5, temperature=1.0)]
    pushed = scales(gp.Scene(container, species, faces={"x_low": gp.Piston(speed=1.5)}))
    assert 20.0 < pushed.duration < 24.0 < scales(gp.Scene(container, species)).duration
    assert 1.0 < pushed.interval < 3.0


def test_a_free_molecular_gas_between_walls_has_the_time_of_its_crossing():
    """Where particles meet walls a thousand times as often as one another, collisions set no time."""
    species = [gp.Species(300, 0.001, temperature=4.0)]
    faces = {"x_low": gp.Open(1e-8, 4.0)}
    container = gp.Container((12.0, 6.0, 6.0), ("wall", "periodic", "periodic"))
    found = scales(gp.Scene(container, species, faces=faces, centres_to_walls=True))
    assert found.free_molecular and found.collision_time > 1000.0 * found.crossing_time
    assert found.crossing_time == found.interval == 3.0 and found.duration == 600.0
    rate = 1e-8 / (4e-9 / 3.0 * math.pi) * 36.0 * math.sqrt(4.0 / (2.0 * math.pi))
    assert found.attempts == pytest.approx(rate)
    assert f"reservoirs: {rate:.3g} particles try to enter per time" in found.lines
    around = scales(gp.Scene(replace(container, boundary="periodic"), species))
    assert not around.free_molecular and around.duration > 100.0 * found.duration


@pytest.mark.parametrize("boundary", ["periodic", "wall"])
def test_advice_for_a_free_molecular_gas_has_the_clock_of_its_crossings(boundary):
    """Without walls, collisions alone change the gas."""
    target = Target(
        gp.Scene(gp.Container((1.0,) * 3, boundary), gp.Species(9, 1e-6, temperature=1.0)), "vacf"
    )
    assert (target.frequency == 1.0 / target.crossing) == (boundary == "wall")
    assert scales(target.scene).free_molecular == (boundary == "wall")


@pytest.mark.parametrize("dimension", [2, 3])
def test_scatterers_end_the_free_flights_of_points(dimension):
    """The mean free path is 4 V / S in three dimensions and pi A / L in two (Cauchy)."""
    fixed = gp.Species(8, 0.4, fixed=True)
    scene = gp.Scene(gp.Container((4.0,) * dimension, "periodic"), [fixed, gp.Species(9, 1e-9, speed=1.0)])
    free = 4.0**dimension - 8.0 * gp.theory.particle_volume(dimension, 0.8)
    path = math.pi * free / (8.0 * 0.8 * math.pi) if dimension == 2 else free / (8.0 * math.pi * 0.16)
    assert scales(scene).mean_free_path == pytest.approx(path, rel=1e-6)
    found = Target(scene, "vacf").frequency
    assert found == pytest.approx(1.0 / scales(scene).collision_time, rel=1e-6)


def test_a_gas_that_falls_from_random_heights_says_how_hot_it_becomes():
    """The barometer of the notebook: 2.14 and 2.24 measured with two seeds, 2.20 for the mean height."""
    gas = gp.Species(300, 0.02, temperature=1.0)
    box = gp.Container((60.0, 6.0), ("periodic", "wall"))
    start, later = scales(gp.Scene(box, [gas], gravity=(0.0, -1.0))).fallen
    assert start == 1.0 and 2.14 < later < 2.26
    energy = start + 0.5 * (6.0 - 0.04)
    assert later + later - 5.96 / math.expm1(5.96 / later) == pytest.approx(energy, rel=1e-9)
    hot = {"y_low": gp.Thermal(1.0)}
    assert scales(gp.Scene(box, [gas], gravity=(0.0, -1.0), faces=hot)).fallen is None
    assert scales(gp.Scene(box, [gas])).fallen is None
