"""Files of an earlier version stay readable: two that revision 876d4e98 wrote.

They have no `mass`, `boundary` and `cell_origin`; the cell is the whole container, and discs are in one of
their diameter.
"""

import shutil
from pathlib import Path

import netCDF4
import numpy as np
import pytest

import gaspart as gp
from gaspart.cli import main
from gaspart.inspection.readers import read_frames

FILES = Path(__file__).parent / "earlier"


@pytest.fixture(params=["piston", "discs"])
def name(request, tmp_path, monkeypatch):
    """The name of a run, which is in the present folder as run.nc."""
    monkeypatch.chdir(tmp_path)
    shutil.copy(FILES / f"{request.param}.nc", "run.nc")
    return request.param


def test_they_are_opened_with_what_is_there(name):
    with netCDF4.Dataset("run.nc") as file, gp.open_trajectory("run.nc") as data:
        d = data.attrs["dimension"]
        assert np.array_equal(data["coordinates"].values, file["coordinates"][:, :, :d])
        assert np.array_equal(data["velocities"].values, file["velocities"][:, :, :d])
        assert np.array_equal(data["radius"].values, file["radius"][:])
        if name == "discs":
            energy = 0.5 * (data["velocities"].values.astype(float) ** 2).sum(axis=(1, 2))
            assert np.allclose(energy, data["kinetic_energy"].values, rtol=1e-6)


@pytest.mark.parametrize(
    "words",
    [
        ["info", "run.nc"],
        ["check", "run.nc"],
        ["measure", "run.nc", "collision_rate", "--start", "0"],
        ["render", "run.nc", "-o", "run.png", "--size", "64x48"],
    ],
    ids=lambda words: words[0],
)
def test_each_command_reads_them(name, words, capsys):
    assert main(words) == 0
    assert "WRONG" not in capsys.readouterr().out


@pytest.mark.parametrize("suffix", [".gsd", ".xyz"])
def test_exports_have_the_container_of_the_moment(name, suffix):
    frames = read_frames(gp.export("run.nc", f"run{suffix}", frame="all"), 0.5 if suffix == ".gsd" else None)
    with gp.open_trajectory("run.nc") as data:
        assert np.allclose(frames.velocities, data["velocities"].values, atol=1e-7)
        if name == "piston":
            side = 8.0 - data["piston_position"].values
            assert np.ptp(side) > 0.1
            assert np.allclose([frames.at(n).lengths[0] for n in range(len(side))], side)
        else:
            assert np.allclose(frames.lengths, [8.0, 7.0])


def test_data_have_the_height_of_today(tmp_path):
    text = gp.export(FILES / "discs.nc", tmp_path / "discs.data").read_text()
    assert "-4.0 4.0 zlo zhi" in text


def test_an_unfinished_one_is_read_and_not_continued(name, capsys):
    contents = bytearray(Path("run.nc").read_bytes())
    contents[7] = 2  # frames
    Path("run.nc").unlink()
    partial = Path("run.nc.partial")
    partial.write_bytes(contents)
    assert main(["info", "run.nc"]) == 0
    assert (
        "2 of 21 frames, unfinished, and begun by another version: start it anew, as below"
        in capsys.readouterr().out
    )
    assert main(["resume", "run.nc"]) == 2
    complaint = capsys.readouterr().err
    assert complaint.startswith("gaspart: error: path = 'run.nc.partial': was begun by another version")
    assert complaint.endswith("start it anew\n") and complaint.count("\n") == 1
    assert partial.read_bytes() == contents
    with gp.open_trajectory(partial) as data:
        assert data.sizes["frame"] == 2
