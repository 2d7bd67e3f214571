"""Digests: of the numbers in a trajectory, whatever its attributes state, and of sets of files."""

import shutil

import pytest

import gaspart as gp
from gaspart.reproduction.archive.digests import digest_of_file, digest_of_numbers, joint_digest


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    """Writes a trajectory of one disc with some seed."""
    folder = tmp_path_factory.mktemp("run")
    scene = gp.Scene(
        container=gp.Container(lengths=(4.0, 4.0)), species=[gp.Species(count=1, radius=0.5, temperature=1.0)]
    )

    def write(name, seed):
        path = folder / name
        gp.run(scene, gp.EventDriven(), seed=seed, duration=2.0, sample_interval=1.0, path=path)
        return path

    return write


def test_the_digest_of_numbers_depends_on_the_bits_and_not_on_the_revision(run, monkeypatch):
    first = run("first.nc", 1)
    monkeypatch.setattr("gaspart.trajectory.provenance.git_revision", lambda: "another revision")
    second, third = run("second.nc", 1), run("third.nc", 2)
    assert digest_of_file(first) != digest_of_file(second)
    assert digest_of_numbers(first) == digest_of_numbers(second) != digest_of_numbers(third)


def test_a_damaged_trajectory_has_no_digest(run):
    path = shutil.copy(run("whole.nc", 1), run("cut.nc", 1).with_name("damaged.nc"))
    path.write_bytes(path.read_bytes()[:-8])
    with pytest.raises(gp.SceneError, match="is truncated"):
        digest_of_numbers(path)


def test_a_joint_digest_is_that_of_the_files_and_their_paths():
    known = {"a/x": "1", "a/y": "2", "ab": "3"}
    assert (
        joint_digest(["a"], known) == joint_digest(["a/y", "a/x"], known) == joint_digest(["a", "a/x"], known)
    )
    assert joint_digest(["a"], known) != joint_digest(["a", "ab"], known)
    assert joint_digest(["a"], known) != joint_digest(["a"], known | {"a/y": "4"})
    with pytest.raises(KeyError):
        joint_digest(["b"], known)
