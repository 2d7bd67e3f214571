"""Runs that start from the last frame of a file of another program."""

from dataclasses import replace

import gsd.hoomd
import numpy as np
import pytest
from scenes import gas

import gaspart as gp
from gaspart.cli import main
from gaspart.scene.boundaries import flow
from gaspart.trajectory.recipe import read_recipe

EVENT = gp.EventDriven()
PLAIN = gas(3, 40, 0.2)
SIDE = PLAIN.container.lengths[0]
MIXED = replace(
    PLAIN, species=[gp.Species(20, 0.5, temperature=1.0), gp.Species(9, 0.2, mass=0.1, speed=1.0)]
)


@pytest.fixture(scope="module")
def state():
    sim = gp.Simulation(PLAIN, EVENT, 3)
    sim.advance(until=1.0)
    return sim.state


def write_xyz(path, state, columns="velo:R:3", lattice=None, order=None, digits=17, radius=False, ids=False):
    """Extended XYZ with a first frame that is not meant."""
    order = np.arange(state.count) if order is None else order
    side = lattice or f"{SIDE!r} 0 0 0 {SIDE!r} 0 0 0 {SIDE!r}"
    named = "species:S:1:pos:R:3:" + columns + ":radius:R:1" * radius + ":id:I:1" * ids
    lines = []
    for places in (np.zeros_like(state.positions), state.positions):
        lines += [str(state.count), f'Lattice="{side}" Properties={named} pbc="T T T"']
        for n in order.tolist():
            numbers = [*places[n], *(state.velocities[n] if columns else [])]
            words = [f"{x:.{digits}g}" for x in (*numbers, *([state.radii[n]] if radius else []))]
            lines.append(" ".join(["A", *words, *([str(n)] if ids else [])]))
    path.write_text("\n".join(lines) + "\n", encoding="ascii")
    return path


def write_gsd(path, state, moving=(True, True), **changed):
    with gsd.hoomd.open(str(path), "w") as file:
        for n, moves in enumerate(moving):
            frame = gsd.hoomd.Frame()
            frame.configuration.box = [SIDE, SIDE, SIDE, 0, 0, 0]
            frame.particles.N = state.count
            frame.particles.position = state.positions - 0.5 * SIDE + 0.01 * (n + 1 - len(moving))
            if moves:
                frame.particles.velocity = (n + 1) / len(moving) * state.velocities
            frame.particles.diameter = 2.0 * state.radii
            frame.particles.mass = state.masses
            for name, value in changed.items():
                setattr(frame.particles, name, value)
            file.append(frame)
    return path


def test_an_xyz_file_is_a_start_in_double_precision(tmp_path, state):
    path = write_xyz(tmp_path / "gas.xyz", state)
    read = gp.read_state(path, PLAIN)
    assert np.array_equal(read.positions, state.positions)
    assert np.array_equal(read.velocities, state.velocities)
    assert read.time == 0.0 and np.array_equal(read.radii, state.radii)
    run = gp.run(PLAIN, EVENT, 3, 1.0, 0.5, tmp_path / "run.nc", initial=path)
    same = gp.run(PLAIN, EVENT, 3, 1.0, 0.5, tmp_path / "same.nc", initial=state)
    assert run.read_bytes() == same.read_bytes()


def test_a_gsd_file_is_a_start_in_single_precision(tmp_path, state):
    read = gp.read_state(write_gsd(tmp_path / "gas.gsd", state), PLAIN)
    assert read.positions == pytest.approx(state.positions, abs=2.0**-24 * SIDE)
    assert np.array_equal(read.velocities, state.velocities.astype(np.float32).astype(float))
    sim = gp.Simulation(PLAIN, EVENT, initial=read)
    sim.advance(until=1.0)
    sim.check_invariants()
    assert sim.tally.collisions > 20


def test_an_exported_mixture_is_a_start_again(tmp_path):
    first = gp.run(MIXED, EVENT, 3, 1.0, 0.5, tmp_path / "first.nc")
    read = gp.read_state(gp.export(first, tmp_path / "first.gsd"), MIXED)
    assert read.positions == pytest.approx(gp.last_state(first).positions, abs=1e-6)
    assert np.array_equal(read.velocities, gp.last_state(first).velocities)


def test_discs_between_walls_are_a_start(tmp_path):
    scene = gas(2, 30, 0.3, "wall")
    first = gp.run(scene, EVENT, 3, 1.0, 0.5, tmp_path / "first.nc")
    read = gp.read_state(gp.export(first, tmp_path / "first.gsd"), scene)
    assert read.positions == pytest.approx(gp.last_state(first).positions, abs=1e-6)
    pushed = replace(scene, faces={"x_high": gp.Piston(30.0, 1.0)})
    assert gp.read_state(tmp_path / "first.gsd", pushed).piston[0] == scene.container.lengths[0]


@pytest.mark.parametrize("ids", [True, False], ids=["by id", "by radius"])
def test_particles_in_another_order_are_those_of_the_scene(tmp_path, ids):
    state = gp.Simulation(MIXED, EVENT, 3).state
    order = np.random.default_rng(1).permutation(state.count)
    path = write_xyz(tmp_path / "gas.xyz", state, order=order, radius=True, ids=ids)
    read = gp.read_state(path, MIXED)
    assert np.array_equal(read.radii, state.radii)
    if ids:
        assert np.array_equal(read.positions, state.positions)
    for radius in (0.5, 0.2):  # those of a species are alike
        one, other = (np.sort(each.positions[each.radii == radius], axis=0) for each in (read, state))
        assert np.array_equal(one, other)
    pairs = {tuple(place): tuple(v) for place, v in zip(state.positions, state.velocities, strict=True)}
    assert all(pairs[tuple(r)] == tuple(v) for r, v in zip(read.positions, read.velocities, strict=True))


def test_velocities_of_a_file_are_about_the_flow(tmp_path, state):
    path = write_xyz(tmp_path / "gas.xyz", state)
    scene = replace(PLAIN, faces={"y_high": gp.LeesEdwards(0.3)})
    run = gp.run(scene, EVENT, 3, 1.0, 0.5, tmp_path / "run.nc", initial=path)
    start = read_recipe(run).initial
    mean = state.momentum / state.count
    assert start.velocities - flow(scene, start.positions) == pytest.approx(
        state.velocities - mean, abs=1e-12
    )


def refused(path, scene):
    with pytest.raises(gp.SceneError) as error:
        gp.run(scene, EVENT, 3, 1.0, 0.5, path.with_name("run.nc"), initial=path)
    assert "\n" not in str(error.value) and path.name in str(error.value)
    return str(error.value)


def test_what_does_not_fit_is_refused_in_one_line(tmp_path, state):
    path, walled = tmp_path / "gas.xyz", replace(PLAIN, container=gp.Container((SIDE,) * 3, "wall"))
    write_xyz(path, state, radius=True)
    assert "has 40 particles, and the scene 41" in refused(path, gas(3, 41, 0.2))
    assert "must be the container of the scene, (" in refused(path, gas(3, 40, 0.1))
    small = replace(PLAIN, species=[replace(PLAIN.species[0], radius=0.4)])
    assert "radius = 0.5: no particle of the file has the radius of particle 0 of the scene, 0.4" in refused(
        path, small
    )
    assert "is not inside the container" in refused(path, walled)
    flat = gp.Scene(gp.Container((SIDE, SIDE), "periodic"), [gp.Species(40, 0.1)])
    write_xyz(path, state)
    assert "has positions that differ along z, and the scene has two dimensions" in refused(path, flat)
    write_xyz(path, replace(state, velocities=np.full_like(state.velocities, np.nan)))
    assert "must be finite numbers" in refused(path, PLAIN)
    path.write_text("40\nno more\n", encoding="ascii")
    assert "is truncated: frame 0 has 0 particles" in refused(path, PLAIN)


def test_velocities_that_the_last_frame_lacks_are_not_those_of_the_first(tmp_path, state):
    path = write_gsd(tmp_path / "gas.gsd", state, moving=(True, False))
    with pytest.warns(UserWarning, match="has no velocities in its last frame: they are drawn"):
        drawn = gp.read_state(path, PLAIN, 5).velocities
    assert np.array_equal(drawn, gp.Simulation(PLAIN, EVENT, 5).initial_state.velocities)
    assert gp.read_state(write_gsd(path, state, moving=(True,)), PLAIN).velocities.any()
    heavy = write_gsd(tmp_path / "heavy.gsd", state, mass=2.0 * state.masses)
    assert "mass = 2.0: no particle of the file has the mass of particle 0 of the scene, 1" in refused(
        heavy, PLAIN
    )


def test_coordinates_of_few_digits_that_overlap_are_refused(tmp_path):
    scene = gas(3, 108, 0.55, arrangement="lattice")
    sim = gp.Simulation(scene, EVENT, 3)
    sim.advance(until=0.3)
    side = scene.container.lengths[0]
    lattice = f"{side!r} 0 0 0 {side!r} 0 0 0 {side!r}"
    path = write_xyz(tmp_path / "gas.xyz", sim.state, lattice=lattice, digits=2)
    with pytest.raises(gp.SceneError, match="is the relative overlap of two particles"):
        gp.run(scene, EVENT, 3, 1.0, 0.5, tmp_path / "run.nc", initial=path)
    assert not list(tmp_path.glob("run.nc*"))


def test_positions_and_radii_alone_are_a_start(tmp_path):
    """A plain file, in another order than the scene; velocities are those of the scene with this seed."""
    MIXED.to_file(tmp_path / "gas.yaml")
    first = gp.Simulation(MIXED, EVENT, 1).initial_state
    order = np.arange(first.count)[::-1]
    rows = [f"A {' '.join(map(repr, first.positions[n].tolist()))} {float(first.radii[n])!r}" for n in order]
    path = tmp_path / "gas.xyz"
    path.write_text("\n".join([str(first.count), f"{SIDE!r} {SIDE!r} {SIDE!r}", *rows, ""]))
    command = ["run", str(tmp_path / "gas.yaml"), "--duration", "1", "--sample-interval", "0.5", "--quiet"]
    with pytest.warns(UserWarning, match=r"gas\.xyz has no velocities in its last frame: they are drawn"):
        assert main([*command, "--seed", "7", "-o", str(tmp_path / "run.nc"), "--from", str(path)]) == 0
    start = read_recipe(tmp_path / "run.nc").initial
    assert np.array_equal(start.velocities, gp.Simulation(MIXED, EVENT, 7).initial_state.velocities)
    assert np.array_equal(np.sort(start.positions, axis=0), np.sort(first.positions, axis=0))
    assert np.array_equal(start.radii, first.radii)
