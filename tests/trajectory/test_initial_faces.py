"""Runs that start from a given state between faces that move: sheared images, pistons, vibrating walls."""

from dataclasses import replace

import numpy as np
import pytest
from scenes import gas

import gaspart as gp
from gaspart.scene.boundaries import flow
from gaspart.state.given import check_apart, state_at_time_zero
from gaspart.trajectory.opening import partial_path
from gaspart.trajectory.recipe import read_recipe

pytestmark = pytest.mark.thorough

EVENT = gp.EventDriven()
LENGTHS = (12.0, 10.0)
PLAIN = gp.Scene(gp.Container(LENGTHS, "periodic"), [gp.Species(60, 0.5, temperature=1.0)])
WALLS = replace(PLAIN, container=gp.Container(LENGTHS, ("periodic", "wall")))
MIXED = replace(PLAIN, species=[gp.Species(20, 0.2, mass=3.0, temperature=1.0), *PLAIN.species])


def sheared(rate, scene=PLAIN):
    return replace(scene, faces={"y_high": gp.LeesEdwards(rate)})


def pushed(scene=WALLS, face="y_high", mass=60.0, pressure=1.0):
    return replace(scene, faces={face: gp.Piston(mass, pressure)})


def after(time, scene, initial=None, seed=3):
    sim = gp.Simulation(scene, EVENT, seed, initial=initial)
    sim.advance(until=time)
    sim.check_invariants()
    return sim


def peculiar(scene, state):
    return state.velocities - flow(scene, state.positions)


def temperature(scene, state):
    return replace(state, velocities=peculiar(scene, state)).temperature


def refusal(scene, state):
    with pytest.raises(gp.SceneError) as error:
        gp.Simulation(scene, EVENT, initial=state)
    assert "\n" not in str(error.value)
    return str(error.value)


@pytest.mark.parametrize("scene", [PLAIN, MIXED], ids=["one kind", "a mixture"])
def test_a_plain_gas_is_sheared_about_its_own_velocities(scene):
    state = after(2.0, scene).state
    assert abs(state.momentum).max() > 1.0  # as drawn: it would be dragged along
    start = gp.Simulation(sheared(0.2, scene), EVENT, initial=state).initial_state
    assert np.array_equal(start.positions, state.positions)
    assert temperature(sheared(0.2, scene), start) == pytest.approx(state.temperature, rel=1e-12)
    relative = replace(start, velocities=peculiar(sheared(0.2, scene), start))
    assert relative.momentum == pytest.approx(np.zeros(2), abs=1e-10)
    mean = state.momentum / state.masses.sum()
    assert relative.velocities == pytest.approx(state.velocities - mean, abs=1e-12)
    assert start.displaced == 0.0 and not start.images.any()
    end = after(5.0, sheared(0.2, scene), state).state
    check_apart(sheared(0.2, scene), end)
    assert end.displaced == pytest.approx(0.2 * 10.0 * 5.0)


def test_a_sheared_gas_goes_on_where_its_images_are():
    """As if it had never stopped: only the rounding of the displacement differs."""
    scene, whole = sheared(0.2), after(6.7, sheared(0.2))
    state = whole.state
    parts = after(2.0, scene, state)
    whole.advance(until=8.7)
    assert state.displaced == pytest.approx(13.4)
    assert parts.initial_state.displaced == state.displaced % 12.0
    assert np.array_equal(parts.initial_state.velocities, state.velocities)
    missed = parts.state.positions - whole.state.positions
    assert abs(missed - np.array(LENGTHS) * np.round(missed / LENGTHS)).max() < 1e-6
    assert parts.state.velocities == pytest.approx(whole.state.velocities, abs=1e-6)
    assert parts.tally.collisions > 100
    carried = 4.0 * state.images[:, 1, None] * [1.0, 0.0]  # with the image where the whole run began
    moved = parts.state.unwrapped - parts.initial_state.unwrapped
    assert moved == pytest.approx(whole.state.unwrapped - state.unwrapped - carried, abs=1e-5)
    assert abs(parts.state.images[:, 1]).max() > 0 and carried.any()


@pytest.mark.parametrize("rate", [-0.5, 0.0, 0.4])
def test_another_shear_rate_keeps_velocities_about_the_flow_and_the_displacement(rate):
    state = after(3.3, sheared(0.2)).state
    on = after(3.0, sheared(rate), state)
    start = on.initial_state
    assert peculiar(sheared(rate), start) == pytest.approx(peculiar(sheared(0.2), state), abs=1e-12)
    assert start.displaced == pytest.approx(6.6)
    assert on.state.displaced == pytest.approx(6.6 + rate * 10.0 * 3.0)
    check_apart(sheared(rate), on.state)
    assert on.tally.collisions > 100


def test_images_that_are_displaced_have_no_place_in_a_plain_container():
    state = after(3.3, sheared(0.2)).state
    rule = "initial = 6.6: is the displacement of images in a sheared gas; the images of the scene are not"
    assert rule in refusal(PLAIN, replace(state, displaced=6.6))
    for name in ("displaced", "shear_rate"):
        assert f"initial = inf: must have a finite {name}" in refusal(PLAIN, replace(state, **{name: np.inf}))
    at_rest = state_at_time_zero(PLAIN, replace(state, displaced=24.0))
    assert at_rest.velocities == pytest.approx(peculiar(sheared(0.2), state), abs=1e-12)
    assert at_rest.displaced is at_rest.shear_rate is None


def test_particles_that_overlap_across_a_sheared_face_are_refused():
    state = gp.Simulation(replace(sheared(0.2), species=[gp.Species(2, 0.5)]), EVENT).state.copy()
    state.positions[:] = [[1.0, 9.8], [9.0, 0.3]]  # 7.5 below the first is its image
    scene = replace(sheared(0.2), species=[gp.Species(2, 0.5)])
    gp.Simulation(scene, EVENT, initial=replace(state, displaced=1.0))
    assert "relative overlap of two particles" in refusal(scene, replace(state, displaced=4.2))


def test_a_gas_between_walls_is_pushed_by_a_piston_at_its_side():
    state = after(2.0, WALLS).state
    sim = after(4.0, pushed(), state)
    assert np.array_equal(sim.initial_state.positions, state.positions)
    assert np.array_equal(sim.initial_state.velocities, state.velocities)
    assert np.array_equal(sim.initial_state.piston, [10.0, 0.0])
    place, velocity = sim.state.piston
    conserved = sim.state.kinetic_energy + 0.5 * 60.0 * velocity**2 + 1.0 * 12.0 * place
    assert place < 10.0 and conserved == pytest.approx(state.kinetic_energy + 120.0, rel=1e-10)


@pytest.mark.parametrize("face", ["y_low", "y_high"])
def test_a_piston_goes_on_where_it_is(face):
    whole = after(2.0, pushed(face=face, pressure=2.0))
    state = whole.state
    parts = after(1.5, pushed(face=face, pressure=2.0), state)
    whole.advance(until=3.5)
    assert np.array_equal(parts.initial_state.piston, state.piston)
    assert abs(state.piston[0] - (10.0 if face == "y_high" else 0.0)) > 0.1 and state.piston[1] != 0.0
    assert parts.state.piston == pytest.approx(whole.state.piston, abs=1e-7)
    assert parts.state.positions == pytest.approx(whole.state.positions, abs=1e-6)
    assert parts.tally.wall_hits[2 + (face == "y_high")] > 5
    heavier = gp.Simulation(pushed(face=face, mass=600.0, pressure=5.0), EVENT, initial=state)
    assert np.array_equal(heavier.state.piston, state.piston)  # the load is the scene's
    free = gp.Simulation(WALLS, EVENT, initial=state)  # the piston is taken away
    assert free.state.piston is None


def test_what_a_piston_excludes_is_refused_in_one_line():
    state = after(2.0, pushed(pressure=2.0)).state
    rule = "initial = 'y_high': is the face that is the piston, y_low in the scene: they must be the same"
    assert rule in refusal(pushed(face="y_low"), state)
    highest = state.positions[:, 1].max()
    beyond = replace(state, piston=np.array([highest + 0.4, 0.0]))
    assert "is not inside the container, or beyond the piston at" in refusal(pushed(), beyond)
    touching = replace(state, piston=np.array([highest + 0.5 - 4e-7, 0.0]))  # as in single precision
    assert state_at_time_zero(pushed(), touching).positions[:, 1].max() == touching.piston[0] - 0.5
    for wrong in ([11.0, 0.0], [-1.0, 0.0], [9.0, np.nan], [9.0]):
        assert "must be a position from 0 to 10 and a velocity" in refusal(
            pushed(), replace(state, piston=np.array(wrong))
        )


@pytest.mark.parametrize("scene", [sheared(0.3), pushed(pressure=2.0)], ids=["sheared", "piston"])
def test_a_file_alone_repeats_a_run_that_began_at_a_moving_face(tmp_path, scene):
    first = gp.run(scene, EVENT, 3, 2.0, 0.5, tmp_path / "first.nc", keep_checkpoint=True)
    state, path = gp.last_state(first), tmp_path / "run.nc"
    assert state.displaced if state.piston is None else state.piston[1]
    whole = gp.run(scene, EVENT, 5, 2.0, 0.5, tmp_path / "whole.nc", initial=first).read_bytes()
    gp.run(scene, EVENT, 5, 2.0, 0.5, path, initial=state).rename(partial_path(path))
    first.unlink()
    assert gp.resume(path).read_bytes() == whole
    path.unlink()
    gp.run(scene, EVENT, 5, 1.0, 0.5, path, initial=state, keep_checkpoint=True)
    assert gp.resume(path, duration=2.0).read_bytes() == whole
    stored, taken = read_recipe(path).initial, state_at_time_zero(scene, state)
    assert stored.displaced == taken.displaced and np.array_equal(stored.velocities, taken.velocities)
    if taken.piston is not None:
        assert np.array_equal(stored.piston, taken.piston)


@pytest.mark.parametrize("scene", [sheared(0.3), pushed(pressure=2.0)], ids=["sheared", "piston"])
def test_the_last_frame_of_a_moving_face_is_a_state(tmp_path, scene):
    """Of a run that began where another ended: the displacement counts from there."""
    begun = after(1.7, scene).state
    exact = after(2.0, scene, begun).state
    path = gp.run(scene, EVENT, 3, 2.0, 0.5, tmp_path / "run.nc", initial=begun)
    rounded = gp.last_state(path)
    assert rounded.positions == pytest.approx(exact.positions, abs=1e-6)
    if scene.shear_rate is None:
        assert np.array_equal(rounded.piston, exact.piston)
    else:
        assert rounded.displaced == pytest.approx(exact.displaced, abs=1e-12)
    end = after(2.0, scene, rounded).state
    check_apart(scene, end)


def test_checkpoints_know_the_start_of_the_images_and_the_piston():
    for scene in (sheared(0.3), pushed()):
        state = after(1.7, scene).state
        sim = after(1.0, scene, state)
        again = sim.again()
        again.restore(sim.checkpoint())
        for one in (sim, again):
            one.advance(until=2.0)
        assert np.array_equal(again.state.positions, sim.state.positions)
        other = replace(state, displaced=state.displaced and state.displaced + 1e-9, piston=None)
        with pytest.raises(gp.SceneError, match="is of another initial state than this simulation"):
            gp.Simulation(scene, EVENT, 3, initial=other).restore(sim.checkpoint())


def test_vibrating_faces_begin_anew_under_a_gas_that_has_settled():
    falling = replace(gas(2, 30, 0.2, "wall"), gravity=(0.0, -1.0))
    state = after(3.0, falling).state
    shaken = replace(falling, faces={"y_low": gp.Vibrating(0.2, 0.7)})
    sim = after(2.5, shaken, state)
    assert np.array_equal(sim.initial_state.positions, state.positions)
    later = after(1.0, shaken, sim.state)
    assert np.array_equal(later.initial_state.positions, sim.state.positions)
    assert later.tally.wall_energy[2] != 0.0


def test_energies_of_vibrations_are_taken_over(tmp_path):
    kinds = [gp.Species(12, 0.5, temperature=1.0), gp.Species(6, 0.5, fixed=True, temperature=2.0)]
    scene = gp.Scene(gp.Container(LENGTHS, "periodic"), kinds)
    state = after(2.0, scene).state
    whole = after(2.0, scene, state)
    assert state.vibrations.any() and not np.array_equal(whole.state.vibrations, state.vibrations)
    assert np.array_equal(whole.initial_state.vibrations, state.vibrations)
    path = gp.run(scene, EVENT, 5, 2.0, 1.0, tmp_path / "run.nc", initial=state)
    assert np.array_equal(read_recipe(path).initial.vibrations, state.vibrations)
    assert gp.last_state(path).vibrations == pytest.approx(whole.state.vibrations, rel=1e-5, abs=1e-6)
    rule = "vibrates = True: needs an initial state that has energies of vibrations"
    assert rule in refusal(scene, replace(state, vibrations=None))


def test_walls_have_no_images_that_could_be_displaced():
    state = after(3.3, sheared(0.2)).state
    low, high = state.positions[:, 1].min(), state.positions[:, 1].max()
    squeezed = state.copy()
    squeezed.positions[:, 1] = 0.5 + (state.positions[:, 1] - low) * 9.0 / (high - low)
    assert state_at_time_zero(WALLS, squeezed).displaced is None
