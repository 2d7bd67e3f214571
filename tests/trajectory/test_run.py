"""Trajectory files: what is in them, who can read them, and what happens when something goes wrong."""

import fcntl
import os
import subprocess
import sys
import textwrap
from dataclasses import replace

import numpy as np
import pytest
from scenes import gas

import gaspart as gp
from gaspart.trajectory import amber, recording, run
from gaspart.trajectory.recipe import Recipe, multiple, read_recipe
from gaspart.trajectory.run import checkpoint_path, partial_path

ENGINES = {"event": gp.EventDriven(), "step": gp.TimeStepped(time_step=0.0625)}


def mixture(dimension):
    """Two species and an explicit particle between walls along y, periodic along the other axes."""
    container = gp.Container((9.0, 8.0, 7.0)[:dimension], ("periodic", "wall", "periodic")[:dimension])
    species = [gp.Species(12, 0.5, temperature=1.0), gp.Species(8, 0.25, mass=2.0, temperature=1.0)]
    body = gp.Body((4.0, 4.0, 4.0)[:dimension], (0.5, 0.25, 1.0)[:dimension], radius=0.75, mass=3.0)
    return gp.Scene(container, species, [body])


@pytest.fixture(scope="module", params=[2, 3], ids=["discs", "spheres"])
def written(request, tmp_path_factory):
    """A trajectory of 9 frames, and the states and tallies that it should hold."""
    scene, engine = mixture(request.param), ENGINES["event"]
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


def test_mdanalysis_reads_it_as_it_is(written):
    from MDAnalysis.coordinates.TRJ import NCDFReader

    path, scene, states, _ = written
    with NCDFReader(str(path), convert_units=False) as reader:
        assert (reader.n_frames, reader.n_atoms) == (9, scene.count)
        for n, frame in enumerate(reader):
            assert frame.time == 0.5 * n
            assert np.array_equal(frame.positions, vectors(states, "positions")[n])
            assert np.array_equal(frame.velocities, vectors(states, "velocities")[n])
            thickness = () if scene.dimension == 3 else (1.5,)
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


def test_xarray_reads_it_as_it_is(written):
    import xarray as xr

    path, _, states, tallies = written
    with xr.open_dataset(path) as data:
        assert np.array_equal(data["coordinates"], vectors(states, "positions"))
        assert np.array_equal(data["time"], [state.time for state in states])
        assert np.array_equal(data["collisions"], [tally.collisions for tally in tallies])
        assert (data.attrs["Conventions"], data.attrs["ConventionVersion"]) == ("AMBER", "1.0")


def test_it_is_netcdf_3_of_64_bit_offsets_with_the_units_that_readers_insist_on(written):
    import netCDF4

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
        for name in amber.counters("event"):
            assert np.array_equal(data[name], [getattr(tally, name) for tally in tallies]), name
        assert np.array_equal(data["kinetic_energy"], [state.kinetic_energy for state in states])
        displacements = np.array([state.unwrapped - states[0].unwrapped for state in states])
        assert data["displacements"].dtype == np.float64
        assert np.array_equal(data["displacements"], displacements)
        assert data.attrs["packing_fraction"] == scene.packing_fraction
        assert data["velocities"].attrs["units"] == "length/time"
        assert data["virial_sum"].attrs["units"] == "mass length^2/time^2"
        assert data["collisions"].attrs["units"] == "1" and data["time"].attrs["units"] == "time"
        assert all("units" in data[name].attrs for name in data.data_vars)
        hit = data["wall_hits"].isel(frame=-1).sel(face=["y low", "y high"])
        assert (hit > 0).all() and float(data["wall_hits"].isel(frame=-1).sum()) == float(hit.sum())


@pytest.mark.parametrize("dimension", [2, 3])
def test_rough_particles_have_spins_and_only_followed_particles_are_written(tmp_path, dimension):
    scene = replace(gas(dimension, 20, 0.2, "wall"), restitution=gp.Restitution(0.9, 0.5))
    path = gp.run(scene, ENGINES["event"], 5, 4.0, 2.0, tmp_path / "run.nc", displacements=True, follow=3)
    simulation = gp.Simulation(scene, ENGINES["event"], 5)
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
    assert read_recipe(path) == Recipe(scene, ENGINES["event"], 5, 4.0, 2.0, True, 3)


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


def test_no_frame_is_lost_to_rounding(tmp_path):
    """0.1 is not a binary fraction: frames are at n x 0.1, and each is a whole number of steps on."""
    scene = gas(2, 10, 0.1)
    for engine in (gp.EventDriven(), gp.TimeStepped(time_step=0.02)):
        path = gp.run(scene, engine, 1, 30.0, 0.1, tmp_path / f"{engine.name}.nc")
        with gp.open_trajectory(path) as data:
            assert data.sizes["frame"] == 301
            assert np.abs(data["time"] - 0.1 * np.arange(301)).max() < 1e-13
            if engine.name == "step":
                assert np.array_equal(data["steps"], 5 * np.arange(301))


@pytest.mark.parametrize(
    ("change", "complaint"),
    [
        ({"duration": 1.1}, "duration = 1.1: must be a whole multiple of sample_interval, 0.5"),
        ({"duration": 0.25}, "duration = 0.25: must be a whole multiple of sample_interval"),
        ({"duration": float("nan")}, "duration = nan: must be positive"),
        ({"sample_interval": 0.0}, "sample_interval = 0.0: must be positive"),
        ({"sample_interval": 1e-10}, "sample_interval = 1e-10: makes more frames"),
        (
            {"engine": gp.TimeStepped(0.2)},
            "sample_interval = 0.5: must be a whole multiple of time_step, 0.2",
        ),
        ({"follow": 5}, "follow = 5: there are 4 particles"),
        ({"follow": 0}, "follow = 0: must be a whole number of at least 1"),
        ({"seed": -1}, "seed = -1: must be a whole number"),
        ({"scene": gp.Scene(gp.Container((5.0, 5.0)))}, "a run needs at least one particle"),
        ({"checkpoint_seconds": -1.0}, "checkpoint_seconds = -1.0: must not be negative"),
    ],
)
def test_invalid_settings_are_refused_before_anything_is_written(tmp_path, change, complaint):
    settings = {"scene": gas(2, 4, 0.1), "engine": gp.EventDriven(), "seed": 1, "duration": 1.0}
    settings = {**settings, "sample_interval": 0.5, "path": tmp_path / "run.nc", **change}
    with pytest.raises(gp.SceneError, match=complaint.replace("(", r"\(")):
        gp.run(**settings)
    assert list(tmp_path.iterdir()) == []


def test_integer_multiples():
    assert multiple("a", 0.3, "b", 0.1) == 3
    assert multiple("a", 1e9, "b", 0.1) == 10**10
    for value in (0.05, 0.30001, 1e300):
        with pytest.raises(gp.SceneError, match="a = .*: must be a whole multiple of b, 0.1"):
            multiple("a", value, "b", 0.1)


def test_a_complete_trajectory_is_kept_and_another_run_never_overwrites_it(tmp_path):
    scene, path = gas(2, 10, 0.1), tmp_path / "run.nc"
    gp.run(scene, gp.EventDriven(), 1, 1.0, 0.5, path)
    before, stamp = path.read_bytes(), path.stat().st_mtime_ns
    gp.run(scene, gp.EventDriven(), 1, 1.0, 0.5, path)
    assert path.stat().st_mtime_ns == stamp
    with pytest.raises(gp.SceneError, match=r"run\.nc.*of another run"):
        gp.run(scene, gp.EventDriven(), 2, 1.0, 0.5, path)
    assert path.read_bytes() == before
    gp.run(scene, gp.EventDriven(), 2, 1.0, 0.5, path, overwrite=True)
    assert read_recipe(path).seed == 2
    assert list(tmp_path.iterdir()) == [path]


def test_a_run_under_way_belongs_to_one_process_and_is_not_replaced_by_another_run(tmp_path):
    scene, path = gas(2, 10, 0.1), tmp_path / "run.nc"
    partial = partial_path(path)
    gp.run(scene, gp.EventDriven(), 1, 1.0, 0.5, path).rename(partial)
    with pytest.raises(gp.SceneError, match=r"run\.nc\.partial.*of another run"):
        gp.run(scene, gp.EventDriven(), 2, 1.0, 0.5, path)
    with partial.open("rb") as file:
        fcntl.flock(file, fcntl.LOCK_EX)
        with pytest.raises(gp.SceneError, match="another process"):
            gp.resume(path)
    assert gp.resume(path) == path
    with pytest.raises(gp.SceneError, match="already complete"):
        gp.resume(path)
    with pytest.raises(gp.SceneError, match=r"there is no other\.nc\.partial"):
        gp.resume(tmp_path / "other.nc")


@pytest.mark.parametrize("moment", ["read_recipe", "begun_as", "may_replace", "_is_blank", "_locked"])
@pytest.mark.parametrize("command", ["resume", "run"])
def test_a_run_that_another_process_finishes_meanwhile(tmp_path, monkeypatch, command, moment):
    """At each moment at which its files are looked at."""
    recipe, path = (gas(2, 10, 0.1), gp.EventDriven(), 1, 1.0, 0.5), tmp_path / "run.nc"
    complete = gp.run(*recipe, path).read_bytes()
    path.rename(partial_path(path))
    original = getattr(run, moment)

    def after_it_was_finished(*arguments, **options):
        if not path.exists():
            partial_path(path).rename(path)
        return original(*arguments, **options)

    monkeypatch.setattr(run, moment, after_it_was_finished)
    if command == "resume" and moment in ("read_recipe", "begun_as"):
        with pytest.raises(gp.SceneError, match=r"run\.nc': is already complete"):
            gp.resume(path)
    else:
        assert (gp.resume(path) if command == "resume" else gp.run(*recipe, path)) == path
    assert path.read_bytes() == complete
    assert list(tmp_path.iterdir()) == [path]


def test_a_run_killed_while_its_header_was_written_begins_again(tmp_path):
    path = tmp_path / "run.nc"
    partial_path(path).write_bytes(bytes(4) + b"half a header")
    gp.run(gas(2, 10, 0.1), gp.EventDriven(), 1, 1.0, 0.5, path)
    with gp.open_trajectory(path) as data:
        assert data.sizes["frame"] == 3


def test_files_that_are_no_trajectories(tmp_path):
    import netCDF4

    complete = gp.run(gas(2, 10, 0.1), gp.EventDriven(), 1, 1.0, 0.5, tmp_path / "run.nc").read_bytes()
    with netCDF4.Dataset(tmp_path / "foreign", "w") as file:
        file.title = "of somebody else"
    contents = {"frames": complete[:-1], "header": complete[:600], "text": b"container:\n", "empty": b""}
    for name, content in contents.items():
        (tmp_path / name).write_bytes(content)
    complaints = {
        "missing": "cannot be read: No such file",
        "frames": f"is truncated: {len(complete) - 1} bytes, where 3 frames need {len(complete)}",
        "header": "is truncated or damaged: 600 bytes, where the header alone needs",
        "text": "is not a readable NetCDF file",
        "empty": "is not a readable NetCDF file",
        "foreign": "is not a trajectory written by gaspart",
    }
    for name, complaint in complaints.items():
        with pytest.raises(gp.SceneError, match=complaint) as caught:
            gp.open_trajectory(tmp_path / name)
        assert "\n" not in str(caught.value) and name in str(caught.value)


def test_folders_that_cannot_be_written_to(tmp_path):
    scene = gas(2, 4, 0.1)
    for path in (tmp_path / "nowhere" / "run.nc", tmp_path):
        with pytest.raises(gp.SceneError, match="must be a file in an existing folder"):
            gp.run(scene, gp.EventDriven(), 1, 1.0, 0.5, path)
    assert list(tmp_path.iterdir()) == []


FULL_DISK = """
    import resource, signal, sys
    from scenes import gas
    import gaspart as gp

    limit = int(sys.argv[2])
    signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
    gp.Simulation(gas(2, 100, 0.1), gp.EventDriven(), 1).advance(1.0)  # all kernels are in the cache now
    resource.setrlimit(resource.RLIMIT_FSIZE, (limit, limit))
    try:
        gp.run(gas(2, 100, 0.1), gp.EventDriven(), 1, 10.0, 0.5, sys.argv[1])
    except gp.SceneError as error:
        sys.exit(str(error))
"""


def test_a_full_disk_loses_nothing(tmp_path):
    """A limit on the file's size fails a write where a full disk would: in a frame, or in the header."""
    path, reference = tmp_path / "run.nc", tmp_path / "reference.nc"
    complete = gp.run(gas(2, 100, 0.1), gp.EventDriven(), 1, 10.0, 0.5, reference).read_bytes()
    for limit, frames in ((len(complete) // 2, range(5, 15)), (1000, None)):
        command = [sys.executable, "-c", textwrap.dedent(FULL_DISK), str(path), str(limit)]
        # What measures coverage would have to write as well.
        env = {key: value for key, value in _environment().items() if not key.startswith("COVERAGE")}
        done = subprocess.run(command, capture_output=True, text=True, env=env)
        assert done.returncode == 1
        assert "cannot be written: File too large" in done.stderr and done.stderr.count("\n") == 1
        if frames:
            with gp.open_trajectory(partial_path(path)) as data:
                assert data.sizes["frame"] in frames
            assert gp.resume(path).read_bytes() == complete
            path.unlink()
    assert list(tmp_path.iterdir()) == [reference]


def _environment():
    return {**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)}


def test_a_broken_invariant_stops_the_run_and_keeps_its_state(tmp_path, monkeypatch):
    path, checked = tmp_path / "run.nc", []

    def check(simulation, state):
        checked.append(simulation.time)
        if simulation.time == 2.0:
            raise gp.SimulationError("at time 2 the energy has drifted")

    monkeypatch.setattr(gp.Simulation, "check_invariants", check)
    with pytest.raises(gp.SimulationError, match=r"drifted; its state is kept in .*run\.nc\.failed\.npz"):
        gp.run(gas(2, 10, 0.1), gp.EventDriven(), 1, 4.0, 0.5, path)
    assert not path.exists()
    with gp.open_trajectory(partial_path(path)) as data:
        assert data["time"].values.tolist() == [0.0, 0.5, 1.0, 1.5]
    with np.load(path.with_name("run.nc.failed.npz")) as kept:
        assert kept["trajectory frames"] == 4


def test_progress_is_reported(tmp_path, monkeypatch):
    monkeypatch.setattr(recording, "_PROGRESS", 0.0)
    reported = []
    gp.run(
        gas(2, 10, 0.1),
        gp.EventDriven(),
        1,
        2.0,
        0.5,
        tmp_path / "run.nc",
        progress=lambda *x: reported.append(x),
    )
    times, durations, collisions = zip(*reported, strict=True)
    assert times[-1] == 2.0 and set(durations) == {2.0}
    assert list(times) == sorted(times) and list(collisions) == sorted(collisions) and collisions[-1] > 0


def test_a_damaged_checkpoint_costs_the_work_and_nothing_else(tmp_path):
    scene, path = gas(2, 10, 0.1), tmp_path / "run.nc"
    complete = gp.run(scene, gp.EventDriven(), 1, 2.0, 0.5, path).read_bytes()
    for spoilt in (b"", b"PK\x03\x04 not a zip file", complete):
        path.rename(partial_path(path))
        checkpoint_path(path).write_bytes(spoilt)
        assert gp.resume(path).read_bytes() == complete
        assert list(tmp_path.iterdir()) == [path]


def test_a_cache_that_cannot_be_written_is_reported_and_costs_time_only(tmp_path):
    """Compiled anew, and what is computed is the same: a kernel of one line stands for all."""
    (tmp_path / "a file").write_text("")
    code = "from gaspart.kernels.compilation import kernel; print(kernel(lambda x: 3.0 * x)(0.1))"
    environment = _environment() | {"GASPART_CACHE": str(tmp_path / "a file" / "cache")}
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, env=environment)
    assert (done.returncode, done.stdout) == (0, f"{3.0 * 0.1}\n")
    assert "cannot write the kernel cache" in done.stderr and "set GASPART_CACHE" in done.stderr


@pytest.mark.parametrize("chosen", [True, False], ids=["chosen", "not chosen"])
def test_without_a_home_there_is_a_cache_all_the_same(tmp_path, chosen):
    """An unknown user without HOME: the chosen folder, or a temporary one, with one line that reports it."""
    code = """
        import pwd, sys, warnings
        def unknown(user):
            raise KeyError(user)
        pwd.getpwuid = unknown
        import gaspart.kernels.cache, numba
        print(gaspart.kernels.cache.usable_cache("digest"))
        import gaspart.kernels.compilation
    """
    environment = {key: value for key, value in _environment().items() if key not in _CACHES}
    environment |= {"TMPDIR": str(tmp_path)} | ({"GASPART_CACHE": str(tmp_path / "mine")} if chosen else {})
    command = [sys.executable, "-c", textwrap.dedent(code)]
    done = subprocess.run(command, capture_output=True, text=True, env=environment)
    own = "mine" if chosen else f"gaspart-{os.getuid()}"
    assert (done.returncode, done.stdout) == (0, f"{tmp_path / own / 'digest'}\n"), done.stderr
    assert ("there is no home for the kernel cache; using " in done.stderr) == (not chosen)
    assert "Traceback" not in done.stderr


_CACHES = ("HOME", "XDG_CACHE_HOME", "GASPART_CACHE", "TMPDIR")


def test_a_temporary_cache_that_others_may_write_to_is_not_used(tmp_path, monkeypatch):
    from gaspart.kernels.cache import usable_cache

    for name in _CACHES:
        monkeypatch.delenv(name, raising=False)
    (tmp_path / "file").write_text("")
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "file"))
    monkeypatch.setattr("tempfile.gettempdir", lambda: str(tmp_path))
    own = tmp_path / f"gaspart-{os.getuid()}"
    own.mkdir()
    for mode, found in ((0o777, None), (0o700, own / "digest")):
        own.chmod(mode)
        with pytest.warns(UserWarning, match="cannot write the kernel cache"):
            assert usable_cache("digest") == found
