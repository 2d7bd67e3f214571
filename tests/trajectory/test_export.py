"""States for other programs, read back by them."""

import sys

import numpy as np
import pytest
from scenes import gas

import gaspart as gp
from gaspart.inspection.checks import judge_places
from gaspart.inspection.readers import read_frames


@pytest.fixture(scope="module", params=[(3, 0.55), (2, 0.6)], ids=["spheres", "discs"])
def state(request, tmp_path_factory):
    """The folder and the last frame of a dense, equilibrated run."""
    dimension, eta = request.param
    folder = tmp_path_factory.mktemp("dense")
    scene = gas(dimension, 256, eta, arrangement="lattice", mass=2.0)
    with gp.open_trajectory(gp.run(scene, gp.EventDriven(), 1, 2.0, 1.0, folder / "run.nc")) as data:
        return folder, data.isel(frame=-1).load()


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
        ("a.pdb", -1, "must end in .gsd or .data"),
        ("a.gsd", 3, "the trajectory has 3"),
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
