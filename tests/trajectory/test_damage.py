"""Damaged trajectories and checkpoints: each is detected, in one line, or costs work and nothing else."""

import os
import struct
import subprocess
import sys
import zlib
from pathlib import Path

import numpy as np
import pytest
from scenes import gas

import gaspart as gp
from gaspart.cli import main
from gaspart.trajectory import amber, recording
from gaspart.trajectory.opening import TRAJECTORY, checkpoint_path, partial_path, read_checkpoint
from gaspart.trajectory.recipe import read_recipe

SCENE = gas(2, 10, 0.1)
RECIPE = (SCENE, gp.EventDriven(), 1, 8.0, 0.5)
NUMBERS = [range(25), pytest.param(range(25, 525), marks=pytest.mark.thorough)]


@pytest.fixture(scope="module")
def complete(tmp_path_factory):
    """The bytes of a finished trajectory of 17 frames."""
    return gp.run(*RECIPE, tmp_path_factory.mktemp("complete") / "run.nc").read_bytes()


@pytest.fixture(scope="module")
def unfinished(tmp_path_factory):
    """The bytes of the same trajectory under way, and of its checkpoint: (partial, checkpoint)."""
    path, write = tmp_path_factory.mktemp("unfinished") / "run.nc", recording.write_checkpoint

    def write_until_the_middle(*arguments):
        write(*arguments)
        if arguments[2] == 9:
            raise KeyboardInterrupt

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(recording, "write_checkpoint", write_until_the_middle)
        with pytest.raises(KeyboardInterrupt):
            gp.run(*RECIPE, path, checkpoint_seconds=0.0)
    return partial_path(path).read_bytes(), checkpoint_path(path).read_bytes()


def damaged(rng, content):
    """`content` with damage of a random kind, which changes at least one byte."""
    size = len(content)
    while True:
        first, length = int(rng.integers(size)), int(rng.integers(1, 300))
        # half of the damage is to the header, which is short
        first = first % 3000 if rng.random() < 0.5 else first
        block, rest = content[first : first + length], content[first + length :]
        kind = rng.integers(8)
        if kind == 0:
            found = (
                content[:first] + bytes([content[first] ^ (1 << int(rng.integers(8)))]) + content[first + 1 :]
            )
        elif kind == 1:
            found = content[:first]
        elif kind == 2:
            found = content[:first] + rest
        elif kind == 3:
            found = content[:first] + bytes(len(block)) + rest
        elif kind == 4:
            found = content[:first] + rng.bytes(len(block)) + rest
        elif kind == 5:
            found = content[:first] + block + block + rest
        elif kind == 6:
            second = int(rng.integers(size))
            low, high = sorted((first, second))
            found = content[:low] + content[high : high + length] + content[low + length : high]
            found += content[low : low + length] + content[high + length :]
        else:
            found = content + rng.bytes(length)
        if found != content:
            return found


def complains(capsys, *arguments):
    """Whether a command refuses with one line."""
    code = main([*map(str, arguments)])
    output = capsys.readouterr().err
    assert (code, output.count("\n")) in ((0, 0), (2, 1)), (code, output)
    assert "Traceback" not in output
    return code == 2


@pytest.mark.interpreted
@pytest.mark.parametrize("numbers", NUMBERS, ids=["sample", "search"])
def test_damage_to_a_trajectory_is_detected(tmp_path, capsys, complete, numbers):
    path = tmp_path / "run.nc"
    for number in numbers:
        path.write_bytes(damaged(np.random.default_rng(number), complete))
        assert complains(capsys, "info", path), number
        assert complains(capsys, "check", path), number
        assert complains(capsys, "run", *scene_and_options(tmp_path)), number
        with pytest.raises(gp.SceneError) as error, gp.open_trajectory(path) as data:
            data.load()
        assert "\n" not in str(error.value)


def scene_and_options(folder):
    scene = folder / "scene.yaml"
    if not scene.exists():
        SCENE.to_file(scene)
    return [scene, "-o", folder / "run.nc", "--duration", "8", "--sample-interval", "0.5"]


@pytest.mark.parametrize("numbers", NUMBERS, ids=["sample", "search"])
def test_damage_to_an_unfinished_run_is_detected_or_repaired(tmp_path, capsys, complete, unfinished, numbers):
    path = tmp_path / "run.nc"
    for number in numbers:
        rng = np.random.default_rng(number)
        contents = list(unfinished)
        which = int(rng.integers(2))
        contents[which] = damaged(rng, contents[which])
        partial_path(path).write_bytes(contents[0])
        checkpoint_path(path).write_bytes(contents[1])
        complains(capsys, "info", path)
        refused = complains(capsys, "resume", path)
        assert not (refused and which), number  # without a checkpoint it starts again
        if not refused:
            assert path.read_bytes() == complete, number
            path.unlink()
        elif not TRAJECTORY.recognises(partial_path(path)):  # it could be anybody's file
            with pytest.raises(gp.SceneError, match="is not an unfinished trajectory"):
                gp.run(*RECIPE, path, overwrite=True)
            partial_path(path).unlink()
        assert gp.run(*RECIPE, path, overwrite=True).read_bytes() == complete
        path.unlink()


@pytest.mark.parametrize("numbers", NUMBERS, ids=["sample", "search"])
def test_edited_attributes_are_detected(tmp_path, capsys, complete, numbers):
    import netCDF4

    path, values = tmp_path / "run.nc", ["", "[", "nonsense", np.float64(np.nan), np.int32(-1), b"\xff"]
    for number in numbers:
        rng = np.random.default_rng(number)
        path.write_bytes(complete)
        with netCDF4.Dataset(path, "a") as file:
            names = file.ncattrs()
            name = names[rng.integers(len(names))]
            if rng.random() < 0.5:
                file.delncattr(name)
            else:
                file.setncattr(name, values[rng.integers(len(values))])
        for command in ("info", "check", "resume"):
            assert complains(capsys, command, path), (number, name)
        with pytest.raises(gp.SceneError):
            gp.open_trajectory(path)


def with_checksums(content):
    """`content` with the checksums of its header and frames as a forger would compute them."""
    size = amber.frame_bytes(content[: amber._HEAD])
    at = amber._value_at(content, "header_bytes")
    header = bytearray(content[: int.from_bytes(content[at : at + 4], "big")])
    frames, count = content[len(header) :], bytes(header[4:8])
    at = amber._value_at(header, "header_crc32")
    header[4:8] = header[at : at + 4] = bytes(4)
    header[at : at + 4] = struct.pack(">I", zlib.crc32(header))
    own, checked = zlib.crc32(header), b""
    for n in range(len(frames) // size):
        frame = frames[n * size : (n + 1) * size]
        checked += frame[:-4] + amber._frame_checksum(frame, n, own)
    header[4:8] = count
    return bytes(header) + checked


RENAMED = [
    *("radius", "type", "time", "kinetic_energy", "collisions", "dissipated_energy"),
    *("coordinates", "velocities", "checksum", "frame", "atom", "spatial", "face"),
]


@pytest.mark.parametrize("name", RENAMED)
def test_a_forged_file_with_other_variables_than_its_recipe_is_one_line(tmp_path, capsys, complete, name):
    assert with_checksums(complete) == complete
    path, stored = tmp_path / "run.nc", struct.pack(">I", len(name)) + name.encode()
    forged = complete.replace(stored, stored[:-1] + b"_")
    assert forged != complete
    path.write_bytes(with_checksums(forged))
    (tmp_path / "out").mkdir()
    for command in (
        ["info"],
        ["check"],
        ["measure", "temperature"],
        ["measure", "force"],
        ["render"],
        ["export"],
    ):
        arguments = [command[0], path, *command[1:]]
        if command[0] in ("render", "export"):
            arguments += ["-o", tmp_path / "out" / ("a.png" if command[0] == "render" else "a.data")]
        refused = complains(capsys, *arguments)
        assert refused or name == "face", command


@pytest.mark.interpreted
def test_exchanged_frames_and_frames_of_another_run_are_detected(tmp_path, capsys, complete):
    other = gp.run(SCENE, gp.EventDriven(), 2, 8.0, 0.5, tmp_path / "other.nc").read_bytes()
    path = tmp_path / "run.nc"
    size = next(size for size in range(len(complete) // 17, 0, -1) if header_ends(complete, size))
    frames = [complete[len(complete) - (17 - n) * size :][:size] for n in range(17)]
    header = complete[: len(complete) - 17 * size]
    exchanged = [frames[1], frames[0], *frames[2:]]
    foreign = [*frames[:16], other[-size:]]
    for changed, place in ((exchanged, 0), (foreign, 16)):
        path.write_bytes(header + b"".join(changed))
        assert main(["info", str(path)]) == 2
        assert f"frame {place} is damaged: its checksum does not match" in capsys.readouterr().err


def test_only_frames_that_are_read_are_checked_and_each_once(tmp_path, complete, monkeypatch):
    from gaspart.trajectory import amber as module

    size = next(size for size in range(len(complete) // 17, 0, -1) if header_ends(complete, size))
    spoilt = bytearray(complete)
    spoilt[len(complete) - 7 * size + size // 2] ^= 1  # of frame 10
    path, read = tmp_path / "run.nc", []
    path.write_bytes(spoilt)
    checked = module.damaged_frame
    monkeypatch.setattr(module, "damaged_frame", lambda *given: read.extend(given[2]) or checked(*given))
    with gp.open_trajectory(path) as data:
        assert len(data.time.values) == 17 and read == []
        assert data["coordinates"].isel(frame=[2, 3, 11]).values.shape == (3, 10, 2)
        assert data["collisions"].isel(frame=slice(2, 5)).values.shape == (3,)
        assert data["velocities"].isel(frame=-1, atom=4).values.shape == (2,)
        assert data["radius"].values.shape == (10,)
        assert read == [2, 3, 11, 4, 16]
        for name in ("coordinates", "collisions", "wall_impulse"):
            with pytest.raises(gp.SceneError, match="frame 10 is damaged: its checksum does not match"):
                _ = data[name].values


def test_a_damaged_frame_is_not_measured_nor_shown(tmp_path, capsys, complete):
    size = next(size for size in range(len(complete) // 17, 0, -1) if header_ends(complete, size))
    spoilt = bytearray(complete)
    spoilt[len(complete) - size + size // 2] ^= 1  # of the last frame
    path = tmp_path / "run.nc"
    path.write_bytes(spoilt)
    for command in (
        ["measure", path, "Z"],
        ["measure", path, "collision_rate"],
        ["export", path, "-o", tmp_path / "a.data"],
        ["render", path, "-o", tmp_path / "a.png"],
        ["view", path, "-o", tmp_path / "a.html"],
        ["info", path],
        ["check", path],
    ):
        assert main([*map(str, command)]) == 2, command
        assert "frame 16 is damaged: its checksum does not match" in capsys.readouterr().err
    assert [*tmp_path.iterdir()] == [path]
    assert main(["export", str(path), "-o", str(tmp_path / "a.data"), "--frame", "15"]) == 0


def test_a_damaged_time_is_found_when_the_file_is_opened(tmp_path, complete):
    size = next(size for size in range(len(complete) // 17, 0, -1) if header_ends(complete, size))
    for time in (2.0, np.nan, 1e300):
        spoilt = bytearray(complete)
        at = len(complete) - 12 * size
        spoilt[at : at + 8] = np.array(time, ">f8").tobytes()
        (tmp_path / "run.nc").write_bytes(spoilt)
        with pytest.raises(gp.SceneError, match="frame 5 is damaged"):
            gp.open_trajectory(tmp_path / "run.nc")


def header_ends(content, size):
    """Whether the frames have this size: each begins with its time."""
    at = len(content) - 17 * size
    times = [np.frombuffer(content, ">f8", 1, at + n * size)[0] for n in range(17)]
    return np.array_equal(times, 0.5 * np.arange(17))


@pytest.mark.interpreted
def test_a_damaged_frame_stops_a_resumption_and_loses_nothing(tmp_path, complete, unfinished):
    path = tmp_path / "run.nc"
    partial, checkpoint = unfinished
    spoilt = bytearray(partial)
    spoilt[len(partial) * 3 // 4] ^= 1
    partial_path(path).write_bytes(spoilt)
    checkpoint_path(path).write_bytes(checkpoint)
    with pytest.raises(gp.SceneError, match=r"frame \d+ is damaged: .*overwrite=True"):
        gp.resume(path)
    assert partial_path(path).read_bytes() == spoilt
    assert gp.run(*RECIPE, path, overwrite=True).read_bytes() == complete


def test_a_checkpoint_with_a_pickle_inside_is_not_loaded(tmp_path, unfinished):
    class Payload:
        def __reduce__(self):
            return Path(tmp_path / "owned").touch, ()

    partial, _ = unfinished
    path = partial_path(tmp_path / "run.nc")
    path.write_bytes(partial)
    header = read_recipe(path).header("")
    checkpoint = tmp_path / "x.npz"
    recording.write_checkpoint(checkpoint, header, 1, {"rows": np.array([Payload()], dtype=object)})
    assert read_checkpoint(checkpoint, header) is None
    assert not (tmp_path / "owned").exists()


@pytest.mark.interpreted
def test_a_run_without_a_first_byte_is_named_as_such(tmp_path, capsys):
    (tmp_path / "run.nc.partial").touch()
    for command in ("resume", "info"):
        assert main([command, str(tmp_path / "run.nc")]) == 2
        output = capsys.readouterr().err
        assert "nothing was written to it yet; start the run again with `gaspart run`" in output
    assert main(["run", *map(str, scene_and_options(tmp_path))]) == 0


def test_paths_that_name_no_file(capsys):
    for command in ("resume", "info", "check"):
        for path in ("", ".", "/"):
            assert complains(capsys, command, path)


def test_names_that_are_not_utf_8(tmp_path, complete):
    path = Path(str(tmp_path) + "/a\udcff.nc")
    path.write_bytes(complete)
    with gp.open_trajectory(path) as data:
        assert data.sizes["frame"] == 17
    for command in (["info", path], ["check", path], ["export", path, "-o", tmp_path / "state.data"]):
        done = subprocess.run(
            [sys.executable, "-m", "gaspart", *command], capture_output=True,
            env={**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)},
        )  # fmt: skip
        notes = [line for line in done.stderr.splitlines() if b"in other programs: " not in line]
        assert done.returncode == 0 and not notes
        assert command[0] == "export" or os.fsencode(path) in done.stdout
