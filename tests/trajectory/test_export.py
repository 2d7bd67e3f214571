"""States for other programs, read back by them."""

import sys

import numpy as np
import pytest
from scenes import gas

import gaspart as gp
from gaspart.inspection.checks import judge_places
from gaspart.inspection.readers import read_frames
from gaspart.trajectory import export as export_module


@pytest.fixture(
    scope="module",
    params=[pytest.param((3, 0.55), marks=pytest.mark.thorough), (2, 0.6)],
    ids=["spheres", "discs"],
)
def state(request, tmp_path_factory):
    """The folder and the last frame of a dense, equilibrated run."""
    dimension, eta = request.param
    folder = tmp_path_factory.mktemp("dense")
    scene = gas(dimension, 256, eta, arrangement="lattice", mass=2.0)
    with gp.open_trajectory(gp.run(scene, gp.EventDriven(), 1, 2.0, 1.0, folder / "run.nc")) as data:
        return folder, data.isel(frame=-1).load()


@pytest.mark.thorough
def test_gsd_is_read_back_and_nothing_overlaps(state):
    folder, last = state
    frames = read_frames(gp.export(folder / "run.nc", folder / "state.gsd"))
    assert np.allclose(frames.positions[0], last["coordinates"] % frames.lengths, atol=3e-6)
    assert np.array_equal(frames.velocities[0], last["velocities"].values.astype(float))
    assert frames.diameter == 1.0 and frames.dimension == last.sizes["spatial"]
    assert all(check.passed is not False for check in judge_places(frames))


@pytest.mark.filterwarnings("ignore::PendingDeprecationWarning")
def test_mdanalysis_reads_the_lammps_data(state):
    import MDAnalysis

    folder, last = state
    path = gp.export(folder / "run.nc", folder / "state.data")
    style = "id type diameter density x y z"
    universe = MDAnalysis.Universe(path, format="DATA", atom_style=style)
    d = last.sizes["spatial"]
    assert np.allclose(universe.atoms.positions[:, :d], last["coordinates"], atol=1e-6)
    per_picosecond = 1e-3 * universe.atoms.velocities[:, :d]  # it takes LAMMPS' for angstrom per femtosecond
    assert np.allclose(per_picosecond, last["velocities"], atol=1e-6)
    assert np.allclose(universe.dimensions[:d], last["cell_lengths"][:d])
    row = next(line for line in path.read_text().splitlines() if line.startswith("1 1 1"))
    assert float(row.split()[3]) == pytest.approx(2.0 / (np.pi / 6.0))


def test_a_frame_is_counted_from_either_end(state):
    folder, _ = state
    for frame in (0, -3):
        gp.export(folder / "run.nc", folder / f"{frame}.data", frame=frame)
    assert (folder / "0.data").read_bytes() == (folder / "-3.data").read_bytes()


def test_invalid_exports_are_refused(state):
    folder, _ = state
    for path, frame, complaint in (
        ("a.pdb", -1, "must end in .gsd, .xyz, .data"),
        ("a.gsd", 3, "must be one of 3 frames"),
        ("nowhere/a.gsd", -1, "cannot be written: No such file"),
    ):
        with pytest.raises(gp.SceneError, match=complaint):
            gp.export(folder / "run.nc", folder / path, frame)
    assert not list(folder.glob("a.*"))


def test_without_gsd_the_message_names_what_to_install(state, monkeypatch):
    folder, _ = state
    monkeypatch.setitem(sys.modules, "gsd", None)
    monkeypatch.delitem(sys.modules, "gsd.hoomd", raising=False)
    with pytest.raises(gp.SceneError, match=r"GSD files .*: pip install 'gaspart\[gsd\]'"):
        gp.export(folder / "run.nc", folder / "a.gsd")
    assert not (folder / "a.gsd").exists()


SCENES = {
    "walls": gas(3, 60, 0.1, "wall"),
    "discs": gas(2, 60, 0.2),
    "species": gp.Scene(
        container=gp.Container(lengths=(12.0,) * 3, boundary=("wall", "periodic", "periodic")),
        species=[
            gp.Species(count=30, radius=0.5, temperature=1.0),
            gp.Species(count=40, radius=0.3, mass=0.25, temperature=1.0),
        ],
    ),
    "open": gp.Scene(
        container=gp.Container(lengths=(10.0, 8.0, 8.0), boundary=("wall", "periodic", "periodic")),
        species=[gp.Species(count=40, radius=0.25, temperature=1.0)],
        faces={"x_low": gp.Open(activity=0.01, temperature=1.0)},
        centres_to_walls=True,
    ),
    **{
        f"piston {side}": gp.Scene(
            container=gp.Container(lengths=(16.0, 8.0, 8.0), boundary=("wall", "periodic", "periodic")),
            species=[gp.Species(count=100, radius=0.5, temperature=1.0)],
            faces={side: gp.Piston(mass=10.0, pressure=0.5)},
        )
        for side in ("x_low", "x_high")
    },
}


@pytest.fixture(params=SCENES)
def run(request, tmp_path):
    """The name of a scene, and its run."""
    path = gp.run(SCENES[request.param], gp.EventDriven(), 1, 2.0, 0.5, tmp_path / "run.nc")
    return request.param, path


def test_a_file_states_masses_boundary_and_the_container_of_the_moment(run):
    name, path = run
    scene = SCENES[name]
    with gp.open_trajectory(path) as data:
        masses = [kind.mass for kind in scene.species for _ in range(kind.count)]
        assert data["mass"].values[: len(masses)].tolist() == masses and data["mass"].attrs["units"] == "mass"
        assert data.attrs["boundary"].split() == [
            "periodic" if along else "wall" for along in scene.container.periodic
        ]
        cell, places = data["cell_lengths"].values, data["coordinates"].values
        energy = 0.5 * np.einsum(
            "tnd,tnd,n->t", *2 * [np.nan_to_num(data["velocities"].values)], data["mass"]
        )
        assert np.allclose(energy, data["kinetic_energy"], rtol=1e-6)
        if scene.dimension == 2:  # no reader finds an image along z nearer than those in the plane
            assert np.all(cell[:, 2] == max(scene.container.lengths))
        if not name.startswith("piston"):
            assert np.array_equal(cell[0, : scene.dimension], scene.container.lengths)
            assert "cell_origin" not in data
            return
        low, position = data["cell_origin"].values, data["piston_position"].values
        radius, inside = 0.5, slice(1, None)
        assert np.allclose(low[:, 0] + cell[:, 0] if name.endswith("high") else low[:, 0], position)
        assert np.all(cell[inside, 0] < 16.0) and np.all(low[:, 1:] == 0.0)
        nearest = (places[..., 0].min(axis=1) - low[:, 0], (low + cell)[:, 0] - places[..., 0].max(axis=1))
        assert min(map(np.min, nearest)) > radius - 1e-5


@pytest.mark.parametrize("suffix", [".gsd", ".xyz"])
def test_all_frames_are_exported_with_their_numbers_and_containers(run, suffix):
    name, path = run
    scene = SCENES[name]
    out = gp.export(path, path.with_suffix(suffix), frame="all")
    with gp.open_trajectory(path) as data:
        counts = np.isfinite(data["coordinates"].values).all(axis=2).sum(axis=1)
        places, cell = data["coordinates"].values.astype(float), data["cell_lengths"].values
        origin = data["cell_origin"].values if "cell_origin" in data else np.zeros_like(cell)
        velocities, times = data["velocities"].values, data["time"].values
    if name == "open":
        assert np.ptp(counts) > 0
        with pytest.raises(gp.SceneError, match="a changing number cannot be checked"):
            read_frames(out)
        if suffix == ".gsd":
            import gsd.hoomd

            with gsd.hoomd.open(str(out)) as file:
                assert [frame.particles.N for frame in file] == counts.tolist()
                assert [frame.configuration.step for frame in file] == list(range(len(times)))
                assert np.concatenate([frame.log["time"] for frame in file]).tolist() == times.tolist()
        return
    if suffix == ".gsd":
        import gsd.hoomd

        with gsd.hoomd.open(str(out)) as file:
            corners = np.array([frame.log["cell_origin"] for frame in file])
        assert np.array_equal(corners, origin) and (name != "piston x_low" or np.ptp(corners[:, 0]) > 0.1)
    frames = read_frames(out, time_step=0.5 if suffix == ".gsd" else None)
    assert np.array_equal(frames.time, times)
    assert np.array_equal(np.asarray(frames.velocities, np.float32), velocities)
    d = scene.dimension
    for n in range(len(times)):
        one = frames.at(n)
        assert np.allclose(one.lengths, cell[n, :d])
        apart = one.positions[0] - (places[n] - origin[n, :d])
        apart -= np.where(scene.container.periodic, one.lengths * np.round(apart / one.lengths), 0.0)
        assert np.abs(apart).max() < 3e-6
    assert suffix == ".gsd" or frames.periodic == scene.container.periodic
    again = gp.read_state(out, scene)
    assert np.allclose(again.velocities, velocities[-1])
    apart = again.positions - places[-1]
    apart -= np.where(
        scene.container.periodic, scene.container.lengths * np.round(apart / again.lengths), 0.0
    )
    assert np.abs(apart).max() < 3e-6


def test_lammps_data_has_one_frame(state):
    folder, _ = state
    with pytest.raises(gp.SceneError, match=r"give its number, or write \.xyz or \.gsd"):
        gp.export(folder / "run.nc", folder / "all.data", frame="all")


def test_rows_of_a_table_have_nine_digits_in_every_block():
    count = 2 * export_module._ROWS + 1
    numbers = np.resize([0.0, -0.0, 1.0, 0.1, -1e-12, 123456789.5, 1e22, float(np.float32(0.3))], count)
    ids = np.arange(1, count + 1)
    rows = "".join(export_module._rows("%d %.9g\n", ids, numbers)).splitlines()
    assert rows == [f"{n} {x:.9g}" for n, x in zip(ids, numbers, strict=True)]


def test_an_xyz_file_of_another_program_is_not_replaced(state):
    folder, _ = state
    path = gp.export(folder / "run.nc", folder / "a.xyz")
    gp.export(folder / "run.nc", path, overwrite=True)
    path.write_text("1\nof mine\nA 0 0 0\n")
    with pytest.raises(gp.SceneError, match="not an XYZ file written by gaspart"):
        gp.export(folder / "run.nc", path, overwrite=True)
