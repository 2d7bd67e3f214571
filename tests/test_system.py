"""Locks of paths, also on file systems without locks."""

import errno
import os

import pytest

from gaspart import files


def test_a_path_belongs_to_one_process_and_its_lock_is_removed(tmp_path):
    path, lock = tmp_path / "run.nc.partial", tmp_path / "run.nc.partial.lock"
    with files.only_process(path):
        assert lock.exists()
        with pytest.raises(BlockingIOError), files.only_process(path):
            pass
        assert lock.exists()
    assert not lock.exists()


def test_a_lock_that_its_holder_removed_is_taken_anew(tmp_path, monkeypatch):
    lock, flock = tmp_path / "run.nc.lock", files.fcntl.flock
    descriptors = []

    def locked_too_late(descriptor, flags):
        if not descriptors:
            lock.unlink()
        descriptors.append(descriptor)
        flock(descriptor, flags)

    monkeypatch.setattr(files.fcntl, "flock", locked_too_late)
    with files.only_process(tmp_path / "run.nc"):
        assert len(descriptors) == 2 and lock.samefile(f"/proc/self/fd/{descriptors[1]}")


@pytest.mark.parametrize("code", [errno.ENOLCK, errno.ENOSYS, errno.EOPNOTSUPP])
def test_without_locks_a_run_is_written_with_a_warning(tmp_path, monkeypatch, code):
    def refuse(descriptor, flags):
        raise OSError(code, os.strerror(code))

    monkeypatch.setattr(files.fcntl, "flock", refuse)
    before = len(os.listdir("/proc/self/fd"))
    with (
        pytest.warns(UserWarning, match=r"^gaspart: .*run.nc: cannot be locked"),
        files.only_process(tmp_path / "run.nc"),
    ):
        (tmp_path / "run.nc").touch()
    assert os.listdir(tmp_path) == ["run.nc"] and len(os.listdir("/proc/self/fd")) == before


def test_a_file_that_is_no_lock_is_kept(tmp_path):
    lock = tmp_path / "run.nc.lock"
    lock.write_text("my notes")
    with pytest.raises(files.SceneError, match="is not a lock"), files.only_process(tmp_path / "run.nc"):
        pass
    assert lock.read_text() == "my notes"
