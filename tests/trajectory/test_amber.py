"""Trajectory files: what is in them, and which programs read them."""

from dataclasses import replace

import netCDF4
import numpy as np
import pytest
from scenes import gas

import gaspart as gp
from gaspart.trajectory import amber, checked_store
from gaspart.trajectory.recipe import Recipe, read_recipe

ENGINE = gp.EventDriven()


def mixture(dimension):
    """Two species and an explicit particle between walls along y, periodic along the other axes."""
    container = gp.Container((9.0, 8.0, 7.0)[:dimension], ("periodic", "wall", "periodic")[:dimension])
    species = [gp.Species(12, 0.5, temperature=1.0), gp.Species(8, 0.25, mass=2.0, temperature=1.0)]
    particle = gp.Particle((4.0, 4.0, 4.0)[:dimension], (0.5, 0.25, 1.0)[:dimension], radius=0.75, mass=3.0)
    return gp.Scene(container, species, [particle])


@pytest.fixture(
    scope="module", params=[pytest.param(2, marks=pytest.mark.thorough), 3], ids=["discs", "spheres"]
)
def written(request, tmp_path_factory):
    """A trajectory of 9 frames, and the states and tallies that it should hold."""
    scene, engine = mixture(request.param), ENGINE
    path = gp.run(scene, engine, 5, 4.0, 0.5, tmp_path_factory.mktemp("run") / "run.nc", displacements=True)
    simulation = gp.Simulation(scene, engine, 5)
    states, tallies = [], []
    for n in range(9):
        simulation.advance(until=0.5 * n)
        states.append(simulation.state)
        tallies.append(simulation.tally)
    return path, scene, states, tallies


def vectors(states, name):
    """(frame, N, 3) positions or velocities in float32, z = 0 for discs."""
    found = np.array([getattr(state, name) for state in states], dtype=np.float32)
    return np.pad(found, ((0, 0), (0, 0), (0, 3 - found.shape[2])))


@pytest.mark.interpreted
def test_mdanalysis_reads_it_as_it_is(written):
    from MDAnalysis.coordinates.TRJ import NCDFReader

    path, scene, states, _ = written
    with NCDFReader(str(path), convert_units=False) as reader:
        assert (reader.n_frames, reader.n_atoms) == (9, scene.count)
        for n, frame in enumerate(reader):
            assert frame.time == 0.5 * n
            assert np.array_equal(frame.positions, vectors(states, "positions")[n])
            assert np.array_equal(frame.velocities, vectors(states, "velocities")[n])
            thickness = () if scene.dimension == 3 else (9.0,)  # the longest side
            assert np.allclose(frame.dimensions, (*scene.container.lengths, *thickness, 90, 90, 90))


def test_mdtraj_reads_it_as_it_is(written):
    import mdtraj

    path, scene, states, _ = written
    with mdtraj.formats.NetCDFTrajectoryFile(str(path)) as file:
        positions, time, lengths, angles = file.read()
    assert np.array_equal(positions, vectors(states, "positions"))
    assert np.array_equal(time, 0.5 * np.arange(9))
    assert np.array_equal(lengths[:, : scene.dimension], np.tile(scene.container.lengths, (9, 1)))
    assert (lengths > 0).all() and (angles == 90).all()

    topology = mdtraj.Topology()
    residue = topology.add_residue("gas", topology.add_chain())
    for _ in range(scene.count):
        topology.add_atom("X", mdtraj.element.argon, residue)
    loaded = mdtraj.load_netcdf(str(path), top=topology)
    assert np.allclose(loaded.xyz * 10, vectors(states, "positions"), rtol=1e-6)


def test_it_is_netcdf_3_of_64_bit_offsets_with_the_units_that_readers_insist_on(written):
    with netCDF4.Dataset(written[0]) as file:
        assert file.data_model == "NETCDF3_64BIT_OFFSET"
        units = {
            name: variable.units for name, variable in file.variables.items() if "units" in variable.ncattrs()
        }
        assert file.dimensions["frame"].isunlimited() and len(file.dimensions["spatial"]) == 3
        assert b"".join(file["cell_angular"][1]) == b"beta "
    wanted = {"time": "picosecond", "coordinates": "angstrom", "velocities": "angstrom/picosecond"}
    assert units.items() >= {**wanted, "cell_lengths": "angstrom", "cell_angles": "degree"}.items()


def test_open_trajectory_gives_every_number_its_name(written):
    path, scene, states, tallies = written
    with gp.open_trajectory(path) as data:
        assert dict(data.sizes).items() >= {"frame": 9, "atom": 21, "spatial": scene.dimension}.items()
        assert data["face"].values.tolist()[:3] == ["x low", "x high", "y low"]
        assert np.array_equal(data["radius"], states[0].radii)
        assert np.array_equal(data["type"], states[0].species)
        for name in amber.counters(gp.EventDriven()):
            assert np.array_equal(data[name], [getattr(tally, name) for tally in tallies]), name
        assert np.array_equal(data["kinetic_energy"], [state.kinetic_energy for state in states])
        displacements = np.array([state.unwrapped - states[0].unwrapped for state in states])
        assert data["displacements"].dtype == np.float64
        assert np.array_equal(data["displacements"], displacements)
        assert data.attrs["packing_fraction"] == scene.packing_fraction
        assert data["velocities"].attrs["units"] == "length/time"
        assert data["virial_sum"].attrs["units"] == "mass length^2/time"
        assert data["collisions"].attrs["units"] == "1" and data["time"].attrs["units"] == "time"
        assert all("units" in data[name].attrs for name in data.data_vars)
        hit = data["wall_hits"].isel(frame=-1).sel(face=["y low", "y high"])
        assert (hit > 0).all() and float(data["wall_hits"].isel(frame=-1).sum()) == float(hit.sum())


@pytest.mark.parametrize("step", [2, 3, -2])
def test_frames_with_a_step_are_read_one_by_one(written, monkeypatch, step):
    path = written[0]
    with gp.open_trajectory(path) as data:
        right = data["coordinates"].values[::step, 1:]
    monkeypatch.setattr(checked_store, "_LARGE", 0)
    frames, read = [], netCDF4.Variable.__getitem__

    class Variable:
        def __init__(self, variable):
            self.shape, self.dtype, self._variable = variable.shape, variable.dtype, variable

        def __getitem__(self, key):
            frames.append(key[0])
            return read(self._variable, key)

    kind, make = checked_store._CheckedArray, checked_store._CheckedArray.__init__
    monkeypatch.setattr(kind, "__init__", lambda self, item, store: make(self, Variable(item), store))
    with gp.open_trajectory(path) as data:
        np.testing.assert_array_equal(data["coordinates"][::step, 1:].values, right)
    assert sorted(frames) == sorted(range(9)[::step])


@pytest.mark.interpreted
@pytest.mark.parametrize("dimension", [2, 3])
def test_rough_particles_have_spins_and_only_followed_particles_are_written(tmp_path, dimension):
    scene = replace(gas(dimension, 20, 0.2, "wall"), restitution=gp.Restitution(0.9, 0.5))
    path = gp.run(scene, ENGINE, 5, 4.0, 2.0, tmp_path / "run.nc", displacements=True, follow=3)
    simulation = gp.Simulation(scene, ENGINE, 5)
    simulation.advance(until=4.0)
    state = simulation.state
    with gp.open_trajectory(path) as data:
        last = data.isel(frame=-1)
        assert data["spins"].dims == ("frame", "atom", "spatial")[:dimension]
        assert (data["spins"].isel(frame=0) == 0.0).all() and (last["spins"] != 0.0).all()
        for name, values in (("spins", state.spins), ("coordinates", state.positions)):
            assert np.array_equal(last[name], values[:3].astype(np.float32))
        assert data["displacements"].shape == (3, 3, dimension) and data.sizes["atom"] == 3
        assert data.attrs["count"] == 20 and last["kinetic_energy"] == state.kinetic_energy
        assert last["dissipated_energy"] == simulation.tally.dissipated_energy > 0.0
    assert read_recipe(path) == Recipe(scene, ENGINE, 5, 4.0, 2.0, displacements=True, follow=3)


@pytest.mark.interpreted
def test_a_file_states_its_recipe(tmp_path):
    scene = mixture(3)
    engine = gp.TimeStepped(time_step=0.1, boxes_per_side=(3, 2, 2), precision="float32", rewind=False)
    path = gp.run(scene, engine, (3, 2**60), 0.6, 0.3, tmp_path / "run.nc")
    assert read_recipe(path) == Recipe(scene, engine, (3, 2**60), 0.6, 0.3)
    again = read_recipe(path)
    other = gp.run(
        again.scene, again.engine, again.seed, again.duration, again.sample_interval, tmp_path / "2.nc"
    )
    assert other.read_bytes() == path.read_bytes()


@pytest.mark.parametrize("length", range(1000, 9000, 500))
def test_frames_begin_where_the_header_ends(tmp_path, length):
    """Whatever its length: the library returns memory by the page, with more than the header."""
    layout = amber.Layout(3, 2, [], 0, amber.counters(gp.EventDriven()), [], {})
    header = layout.header(
        {"note": "x" * length}, {"radius": np.ones(3), "mass": np.ones(3), "type": np.zeros(3, int)}
    )
    frame = np.zeros(1, layout.frame)
    frame["time"] = 7.0
    (tmp_path / "one.nc").write_bytes(header[:4] + bytes([0, 0, 0, 1]) + header[8:] + frame.tobytes())
    with netCDF4.Dataset(tmp_path / "one.nc") as file:
        assert file["time"][:].tolist() == [7.0]
