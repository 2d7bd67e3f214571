"""Trajectories as other programs write them, and files that are none."""

import tracemalloc

import numpy as np
import pytest
from inspection.foreign import ROWS, gas_of, write_gsd, xyz
from scenes import gas

import gaspart as gp
from gaspart.cli import main
from gaspart.inspection.checks import judge
from gaspart.inspection.readers import read_frames


def test_two_spheres_at_one_place_are_found_in_an_xyz_file(tmp_path, capsys):
    path = tmp_path / "a.xyz"
    path.write_text("3\n\nA 1 1 1\nA 1 1 1\nA 5 5 5\n")
    assert main(["check", str(path), "--radius", "0.5", "--lengths", "10,10,10"]) == 1
    assert "WRONG overlaps: the deepest is 1 of a contact distance" in capsys.readouterr().out


def test_a_trajectory_of_gaspart_states_the_forces_on_its_particles(tmp_path):
    plain = gp.run(gas(2, 20, 0.1, "wall"), gp.EventDriven(), 1, 1.0, 0.5, tmp_path / "a.nc")
    frames = read_frames(plain)
    assert frames.plain and frames.dimension == 2 and not any(frames.periodic)


def cut_gsd(path):
    write_gsd(path, gas_of())
    path.write_bytes(path.read_bytes()[:300])


@pytest.mark.parametrize(
    ("name", "make", "complaint"),
    [
        ("a.nc", lambda path: path.write_bytes(b"CDF\x02 and so on"), "cannot be read"),
        ("a.gsd", lambda path: path.write_bytes(b"no such format" * 40), "cannot be read"),
        ("a.gsd", cut_gsd, "cannot be read"),
        ("a.xyz", lambda path: path.write_text("three\n"), "cannot be read: invalid literal"),
        ("a.xyz", lambda path: path.write_text("3\n\nA 1 1 1\n"), "is truncated: frame 0 has 1"),
        ("a.xyz", lambda path: path.write_bytes(b"\xff\xfe\x00\x01"), "cannot be read"),
        ("a.xyz", lambda path: path.write_text("1\n\nA 1 1 1\n"), "--lengths"),
        ("a.xyz", lambda path: xyz(path, ROWS), "--radius"),
    ],
)
def test_unreadable_files_are_reported_in_one_line(tmp_path, name, make, complaint):
    path = tmp_path / name
    make(path)
    with pytest.raises(gp.SceneError, match=complaint) as said:
        read_frames(path)
    assert "\n" not in str(said.value)


def test_a_plain_file_states_radii_in_a_fifth_column_and_sides_in_its_second_line(tmp_path, capsys):
    """Spheres of .5 and .1 at a distance of .65: they would overlap if all had .5."""
    path = tmp_path / "a.xyz"
    path.write_text("3\n6.0 7 8.5\nA 1 1 1 0.5\nB 1.65 1 1 0.1\nA 5 5 5 0.5\n")
    frames = read_frames(path)
    assert frames.radii.tolist() == [0.5, 0.1, 0.5] and frames.lengths.tolist() == [6.0, 7.0, 8.5]
    assert main(["check", str(path)]) == 0
    note = "3 spheres in 1 frames; sides from the second line and radii from the fifth column\n"
    assert note in capsys.readouterr().out
    assert main(["check", str(path), "--radius", "0.5"]) == 1
    path.write_text("2\n6.0 7.0\nA 1 1 0 0.5\nB 2.5 1 0 0.5\n")
    assert read_frames(path).lengths.tolist() == [6.0, 7.0]


@pytest.mark.parametrize(
    ("comment", "fifth"), [("6 7 8 9", "0.5"), ("6 -7 8", "0.5"), ("6 7 8", "-0.5"), ("6 7 8", "0.5 1.0")]
)
def test_other_numbers_of_a_plain_file_are_not_sizes(tmp_path, comment, fifth):
    path = tmp_path / "a.xyz"
    path.write_text(f"1\n{comment}\nA 1 1 1 {fifth}\n")
    with pytest.raises(gp.SceneError, match="lengths|radius"):
        read_frames(path)


def test_a_run_is_checked_in_blocks_with_the_same_results(tmp_path, monkeypatch):
    """The lines of checks do not depend on how many frames, or paths, are in memory at once."""
    path = gp.run(gas(3, 60, 0.1), gp.EventDriven(), 1, 12.0, 0.1, tmp_path / "a.nc")
    lines = [str(check) for check in judge(read_frames(path))]
    assert sum(line.startswith("ok") for line in lines) >= 5
    monkeypatch.setattr("gaspart.inspection.frames._BLOCK", 400)
    monkeypatch.setattr("gaspart.inspection.statistics._NUMBERS", 3000)
    frames = read_frames(path)
    assert [str(check) for check in judge(frames)] == lines
    assert np.array_equal(np.asarray(frames.positions), np.array([frames.positions[n] for n in range(121)]))
    assert len(frames.positions[::2]) == 61 and frames.positions[-1] is frames.positions[120]


@pytest.mark.thorough
def test_the_memory_of_a_check_does_not_grow_with_a_run(tmp_path, monkeypatch):
    for name, number in ("frames._BLOCK", 20_000), ("statistics._NUMBERS", 50_000):
        monkeypatch.setattr(f"gaspart.inspection.{name}", number)
    monkeypatch.setattr("gaspart.trajectory.amber._CHUNK", 200_000)
    scene, times = gas(3, 200, 0.1), (2.0, 14.0)
    paths = [gp.run(scene, gp.EventDriven(), 1, t, 0.02, tmp_path / f"{t}.nc") for t in times]
    peaks = []
    for path in [paths[0], *paths]:  # once more, for imports
        tracemalloc.start()
        judge(read_frames(path))
        peaks.append(tracemalloc.get_traced_memory()[1])
        tracemalloc.stop()
    grown = paths[1].stat().st_size - paths[0].stat().st_size
    assert grown > 3e6 and peaks[2] - peaks[1] < 0.3 * grown, (peaks, grown)
