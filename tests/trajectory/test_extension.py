"""Finished runs that go on: the bytes of one run in one go, from the state at the end or from the start."""

from dataclasses import replace

import pytest
from scenes import gas

import gaspart as gp
from gaspart.trajectory import recording, run
from gaspart.trajectory import run as extension
from gaspart.trajectory.opening import checkpoint_path, partial_path
from gaspart.trajectory.recipe import read_recipe

MIXTURE = gp.Scene(
    gp.Container((12.0, 12.0), "periodic"),
    [gp.Species(20, 0.5, temperature=1.0), gp.Species(10, 0.8, mass=3.0, temperature=1.0)],
)
FALLING = gp.Scene(
    gp.Container((20.0, 20.0), ("periodic", "wall")),
    [gp.Species(30, 0.5, temperature=1.0)],
    gravity=(0.0, -0.5),
    restitution=gp.Restitution(0.9, 0.5),
    faces={"y_low": gp.Thermal(1.0)},
)
RUNS = {
    "event": (gas(3, 50, 0.2), gp.EventDriven(), {"displacements": True}),
    "event, in a box": (FALLING, gp.EventDriven(), {"follow": 7}),
    "event, correlations": (gas(3, 40, 0.3), gp.EventDriven(), {"correlations": gp.Correlations(0.125, 8)}),
    "event, stress": (
        gas(3, 40, 0.3),
        gp.EventDriven(),
        {"correlations": gp.Correlations(0.125, 8, stress=True)},
    ),
    "event, pairs": (MIXTURE, gp.EventDriven(), {"pairs": True}),
    "step": (gas(3, 50, 0.2), gp.TimeStepped(time_step=0.03125), {"displacements": True}),
    "DSMC": (gas(3, 200, 0.01), gp.DSMC(time_step=0.125, cells_per_side=4), {}),
}


class Cut(BaseException):
    """A kill."""


CANONICAL = "event", "step", "DSMC"


@pytest.fixture(
    params=[pytest.param(name, marks=() if name in CANONICAL else pytest.mark.thorough) for name in RUNS]
)
def asked(request):
    scene, engine, options = RUNS[request.param]
    return (scene, engine, 5), options


@pytest.mark.parametrize("keep", [True, False], ids=["from the end", "from the start"])
def test_an_extended_run_has_the_bytes_of_one_in_one_go(tmp_path, asked, keep):
    recipe, options = asked
    whole = gp.run(*recipe, 4.0, 0.5, tmp_path / "whole.nc", **options).read_bytes()
    path = gp.run(*recipe, 1.5, 0.5, tmp_path / "run.nc", keep_checkpoint=keep, **options)
    assert checkpoint_path(path).exists() == keep
    for duration in (2.0, 4.0):
        assert gp.resume(path, duration=duration) == path
        assert checkpoint_path(path).exists() == keep and not partial_path(path).exists()
    assert path.read_bytes() == whole


@pytest.mark.interpreted
def test_it_goes_on_from_the_end_and_not_from_the_start(tmp_path, monkeypatch):
    """Only the new frames are computed."""
    path = gp.run(gas(2, 20, 0.3), gp.EventDriven(), 1, 2.0, 0.5, tmp_path / "run.nc", keep_checkpoint=True)
    times, frame = [], recording.Recording._frame
    monkeypatch.setattr(
        recording.Recording, "_frame", lambda self, state: times.append(state.time) or frame(self, state)
    )
    gp.resume(path, duration=3.0)
    assert times == [2.5, 3.0]


def test_a_run_until_it_was_accurate_goes_on(tmp_path):
    scene, path = gas(3, 50, 0.2), tmp_path / "run.nc"
    gp.run(scene, gp.EventDriven(), 1, None, 0.25, path, until=gp.Accuracy("Z", 0.5), keep_checkpoint=True)
    with gp.open_trajectory(path) as data:
        reached = float(data["time"][-1])
    gp.resume(path, duration=reached + 1.0)
    whole = gp.run(scene, gp.EventDriven(), 1, reached + 1.0, 0.25, tmp_path / "whole.nc")
    assert path.read_bytes() == whole.read_bytes()


@pytest.mark.parametrize("keep", [True, False], ids=["from the end", "from the start"])
@pytest.mark.parametrize("command", [{"duration": 4.0}, {}], ids=["extended again", "resumed"])
@pytest.mark.parametrize("moment", ["begun", "copying", "copied", "checkpoint", "under way", "placed"])
def test_a_kill_at_any_moment_loses_nothing(tmp_path, monkeypatch, moment, command, keep):
    recipe = gas(2, 20, 0.3), gp.EventDriven(), 1
    whole = gp.run(*recipe, 4.0, 0.5, tmp_path / "whole.nc").read_bytes()
    path = gp.run(*recipe, 2.0, 0.5, tmp_path / "run.nc", keep_checkpoint=keep)
    before, calls = path.read_bytes(), []

    def cut(original, after):
        def or_cut(*arguments, **options):
            calls.append(arguments)
            if len(calls) > after:
                raise Cut
            return original(*arguments, **options)

        return or_cut

    owner, name, after = {
        "begun": (run, "_carry_out", 0),
        "copying": (extension.Frames, "append_bytes", 2),
        "copied": (extension, "write_checkpoint", 0),
        "checkpoint": (recording.Recording, "finish", 0),
        "under way": (recording.Recording, "_finish_frame", 2),
        "placed": (run, "place", 0),
    }[moment]
    with monkeypatch.context() as patched:
        patched.setattr(owner, name, cut(getattr(owner, name), after))
        if moment == "copied" and not keep:
            gp.resume(path, duration=4.0)  # nothing is copied
        else:
            with pytest.raises(Cut):
                gp.resume(path, duration=4.0)
            assert path.read_bytes() == before and partial_path(path).exists()
    if partial_path(path).exists():
        assert gp.resume(path, **command) == path
    assert path.read_bytes() == whole
    assert not partial_path(path).exists()


def test_what_cannot_be_extended_is_refused_in_one_line(tmp_path):
    recipe, path = (gas(2, 20, 0.3), gp.EventDriven(), 1), tmp_path / "run.nc"
    gp.run(*recipe, 2.0, 0.5, path, keep_checkpoint=True)
    before = {file.name: file.read_bytes() for file in tmp_path.iterdir()}

    def refused(rule, duration=4.0, path=path):
        with pytest.raises(gp.SceneError, match=rule) as error:
            gp.resume(path, duration=duration)
        assert "\n" not in str(error.value)

    for duration in (1.0, 2.0, 2.0 + 1e-12, float("nan")):
        refused("duration = .*: must be longer than the 2 that run.nc has", duration)
    refused("duration = 2.25: must be a whole multiple of sample_interval", 2.25)
    assert {file.name: file.read_bytes() for file in tmp_path.iterdir()} == before
    refused("cannot be read: No such file", path=tmp_path / "other.nc")
    foreign = tmp_path / "foreign.nc"
    foreign.write_bytes(b"CDF\x01" + bytes(2000))
    refused("is not a trajectory written by gaspart", path=foreign)
    path.write_bytes(before["run.nc"][:-9] + b"9" + before["run.nc"][-8:])
    refused("frame 4 is damaged")
    path.write_bytes(before["run.nc"])
    gp.run(*recipe, 8.0, 0.5, tmp_path / "longer.nc").rename(partial_path(path))
    refused("run.nc.partial.*is of another unfinished run, or to another duration")
    path.unlink()
    refused("is unfinished: resume it without a duration")


@pytest.mark.interpreted
def test_a_file_of_another_version_is_not_extended(tmp_path, monkeypatch):
    path = gp.run(gas(2, 20, 0.3), gp.EventDriven(), 1, 2.0, 0.5, tmp_path / "run.nc")
    versions = run.provenance.versions()
    monkeypatch.setattr(run.provenance, "versions", lambda: {**versions, "numpy_version": "0.1"})
    with pytest.raises(gp.SceneError, match="was made by another version of gaspart, Python or a package"):
        gp.resume(path, duration=4.0)
    assert [*tmp_path.iterdir()] == [path]


def test_only_a_run_being_extended_gives_way_to_a_longer_one(tmp_path):
    """A run of another duration is refused as before, unless it was asked for with `resume`."""
    recipe, path = (gas(2, 20, 0.3), gp.EventDriven(), 1), tmp_path / "run.nc"
    gp.run(*recipe, 2.0, 0.5, path, keep_checkpoint=True)
    with pytest.raises(gp.SceneError, match=r"run\.nc'?: exists, with a shorter duration; continue it"):
        gp.run(*recipe, 4.0, 0.5, path)
    short = read_recipe(path)
    assert extension.is_beginning(path, replace(short, duration=4.0))
    other = replace(short, duration=4.2, sample_interval=0.3)  # which the file's own recipe cannot have
    assert not extension.is_beginning(path, other)
    gp.run(*recipe, 4.2, 0.3, path, overwrite=True)
    gp.run(*recipe, 2.0, 0.5, path, overwrite=True)
    for change in (
        {"duration": 2.0},
        {"duration": 4.0, "seed": 2},
        {"duration": 4.0, "sample_interval": 0.25},
    ):
        assert not extension.is_beginning(path, replace(short, **change))
