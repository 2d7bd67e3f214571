"""Runs that start from the last state of another."""

import warnings
from dataclasses import replace

import numpy as np
import pytest
from scenes import gas

import gaspart as gp
from gaspart.state.given import check_apart, state_at_time_zero
from gaspart.trajectory.opening import partial_path
from gaspart.trajectory.recipe import read_recipe

PLAIN = gas(3, 100, 0.3)
ENGINES = [gp.EventDriven(), gp.TimeStepped(time_step=0.015625), gp.DSMC(time_step=0.0625, cells_per_side=3)]
every_engine = pytest.mark.parametrize("engine", ENGINES, ids=lambda engine: engine.name)


def source(path, scene=PLAIN, engine=ENGINES[0], **options):
    return gp.run(scene, engine, 3, 2.0, 0.5, path, **options)


def test_the_last_state_is_exact_with_a_checkpoint_and_rounded_without(tmp_path):
    sim = gp.Simulation(PLAIN, gp.EventDriven(), 3)
    sim.advance(until=2.0)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        exact = gp.last_state(source(tmp_path / "kept.nc", keep_checkpoint=True))
    with pytest.warns(UserWarning, match="run.nc: has no checkpoint of its end .* single precision only"):
        rounded = gp.last_state(source(tmp_path / "run.nc"))
    for name in ("positions", "velocities"):
        assert np.array_equal(getattr(exact, name), getattr(sim.state, name))
        of_frame = getattr(sim.state, name).astype(np.float32)
        assert np.array_equal(getattr(rounded, name), of_frame.astype(float))
        assert not np.array_equal(getattr(rounded, name), getattr(exact, name))
    assert exact.time == rounded.time == 2.0


@pytest.mark.parametrize("keep", [True, False], ids=["exact", "rounded"])
@every_engine
def test_a_run_starts_from_the_last_state_of_another(tmp_path, engine, keep):
    first = source(tmp_path / "first.nc", keep_checkpoint=keep)
    sim = gp.Simulation(PLAIN, engine, 5, initial=gp.last_state(first))
    path = gp.run(PLAIN, engine, 5, 2.0, 0.5, tmp_path / "second.nc", initial=first)
    with gp.open_trajectory(path) as data:
        for n, time in enumerate(data["time"].values):
            sim.advance(until=time + 1e-9)
            assert np.allclose(data["velocities"][n], sim.state.velocities, rtol=1e-6, atol=1e-6)
        assert data["collisions"][-1] > 100
    assert np.array_equal(read_recipe(path).initial.positions, sim.initial_state.positions)


def test_it_has_the_same_bytes_again_after_a_cut_and_extended(tmp_path):
    first, recipe = source(tmp_path / "first.nc"), (PLAIN, gp.EventDriven(), 5)
    whole = gp.run(*recipe, 2.0, 0.5, tmp_path / "whole.nc", initial=first).read_bytes()
    path = tmp_path / "run.nc"
    gp.run(*recipe, 2.0, 0.5, path, initial=str(first)).rename(partial_path(path))
    assert gp.resume(path).read_bytes() == whole
    path.unlink()
    gp.run(*recipe, 1.0, 0.5, path, initial=gp.last_state(first), keep_checkpoint=True)
    first.unlink()  # the file holds what it was started from
    assert gp.resume(path, duration=2.0).read_bytes() == whole
    with pytest.raises(gp.SceneError, match=r"run\.nc'?: exists, .*with another initial state"):
        gp.run(*recipe, 2.0, 0.5, path)


def test_replays_analyses_and_checkpoints_know_the_start():
    state = gp.Simulation(PLAIN, gp.EventDriven(), 3).state.copy()
    state.velocities *= 2.0
    sim = gp.Simulation(PLAIN, gp.EventDriven(), 5, initial=state)
    sim.advance(until=4.0)
    assert np.array_equal(next(sim.replay(interval=1.0)).velocities, state.velocities)
    assert np.array_equal(list(sim.replay(interval=4.0))[-1].positions, sim.state.positions)
    z = gp.analysis.compressibility_factor(sim)
    assert abs(float(z.deviation)) < 4.0
    again = sim.again()
    again.restore(sim.checkpoint())
    assert np.array_equal(again.state.positions, sim.state.positions)
    with pytest.raises(gp.SceneError, match="is of another initial state than this simulation"):
        gp.Simulation(PLAIN, gp.EventDriven(), 5).restore(sim.checkpoint())


@pytest.mark.thorough
def test_spins_are_taken_over_and_gravity_and_faces_may_differ(tmp_path):
    box = gas(2, 30, 0.2, "wall")
    rough = replace(box, restitution=gp.Restitution(1.0, 0.5))
    sim = gp.Simulation(rough, gp.EventDriven(), 1)
    sim.advance(until=3.0)
    assert sim.state.spins.any()
    path = gp.run(rough, gp.EventDriven(), 1, 3.0, 1.0, tmp_path / "rough.nc", initial=sim.state)
    assert np.array_equal(read_recipe(path).initial.spins, sim.state.spins)
    assert gp.last_state(path).spins.any()
    falling = replace(rough, gravity=(0.0, -1.0), faces={"y_low": gp.Thermal(2.0)})
    on = gp.Simulation(falling, gp.EventDriven(), 1, initial=gp.last_state(path))
    assert np.array_equal(on.state.spins, gp.last_state(path).spins)
    on.advance(until=3.0)
    on.check_invariants()
    smooth = gp.Simulation(box, gp.EventDriven(), initial=sim.state)
    assert not smooth.state.spins.any()


@pytest.mark.thorough
@pytest.mark.parametrize(
    "scene", [gas(2, 2000, 0.7, arrangement="compressed"), gas(3, 2000, 0.5, "wall", arrangement="lattice")]
)
def test_frames_of_dense_gases_are_accepted(tmp_path, scene):
    """Particles that touch overlap by the rounding of single precision, which then never grows."""
    scene = replace(scene, gravity=(0.0, 0.0, -1.0)) if scene.dimension == 3 else scene
    path = gp.run(scene, gp.EventDriven(), 3, 1.0, 0.25, tmp_path / "run.nc")
    sim = gp.Simulation(scene, gp.EventDriven(), initial=gp.last_state(path))
    sim.advance(until=1.0)
    sim.check_invariants()
    check_apart(scene, sim.state)


def refusal(scene, state, engine=ENGINES[0]):
    with pytest.raises(gp.SceneError) as error:
        gp.Simulation(scene, engine, initial=state)
    assert "\n" not in str(error.value)
    return str(error.value)


def test_what_does_not_match_is_refused_in_one_line(tmp_path):
    state = gp.Simulation(PLAIN, gp.EventDriven(), 3).state
    assert "initial = '99 particles in 3 dimensions': must be as in the scene, 100" in refusal(
        PLAIN, gp.Simulation(gas(3, 99, 0.3), ENGINES[0]).state
    )
    assert "must be the container of the scene, (" in refusal(gas(3, 100, 0.2), state)
    heavy = replace(PLAIN, species=[replace(PLAIN.species[0], mass=2.0)])
    assert "particle 0 has this mass, and 2 in the scene: species must be the same" in refusal(heavy, state)
    small = replace(PLAIN, species=[replace(PLAIN.species[0], radius=0.4)])
    assert "has this radius, and 0.4" in refusal(small, state)
    assert "must be a State" in refusal(PLAIN, "state")
    changed = state.copy()
    changed.velocities[3, 1] = np.nan
    assert "initial = 'velocities': must be finite numbers" in refusal(PLAIN, changed)
    changed = state.copy()
    changed.positions[3] = changed.positions[4] + 0.9 / np.sqrt(3.0)
    assert "is the relative overlap of two particles" in refusal(PLAIN, changed)
    gp.Simulation(PLAIN, ENGINES[2], initial=changed)  # whose particles may overlap
    walled = replace(PLAIN, container=gp.Container(PLAIN.container.lengths, "wall"))
    assert "is not inside the container" in refusal(walled, state)
    sticky = replace(walled, faces={"x_low": gp.Sticky(1.0)})
    assert "does not say which particles stick" in refusal(sticky, state)


def test_a_file_that_lacks_the_state_is_refused(tmp_path):
    followed = source(tmp_path / "followed.nc", follow=10)
    with pytest.raises(gp.SceneError, match="has 10 of 100 particles, and no checkpoint"):
        gp.last_state(followed)
    kept = source(tmp_path / "kept.nc", follow=10, keep_checkpoint=True)
    assert gp.last_state(kept).count == 100
    with pytest.raises(gp.SceneError, match="cannot be read: No such file"):
        gp.run(PLAIN, ENGINES[0], 1, 1.0, 0.5, tmp_path / "run.nc", initial=tmp_path / "no.nc")
    assert not (tmp_path / "run.nc").exists() and not partial_path(tmp_path / "run.nc").exists()


def test_positions_at_the_edges_are_put_inside():
    scene = gp.Scene(gp.Container((8.0, 8.0), ("periodic", "wall")), [gp.Species(2, 0.5)])
    state = gp.Simulation(scene, ENGINES[0]).state.copy()
    state.positions[:] = [[8.0, 0.5 - 2e-7], [-1e-20, 7.5 + 2e-7]]
    taken = state_at_time_zero(scene, state)
    assert np.array_equal(taken.positions, [[0.0, 0.5], [0.0, 7.5]])
    state.positions[0, 1] = 0.499
    with pytest.raises(gp.SceneError, match="particle 0 is not inside the container"):
        state_at_time_zero(scene, state)
