"""Replicas of a run: the bits of each, whatever the order in which they come so far, and their mean."""

import pytest
from scenes import gas

import gaspart as gp
from gaspart.accuracy.reached import Examiner
from gaspart.cli import main
from gaspart.trajectory import run as trajectory
from gaspart.trajectory.opening import partial_path
from gaspart.trajectory.recipe import Recipe
from gaspart.trajectory.replicas import find_replicas, in_replicas
from gaspart.trajectory.run import WriteOptions, examination
from gaspart.trajectory.run_options import Until

GAS = gas(3, 32, 0.2)
ASKED = Until((gp.Accuracy("Z", 0.03),))
RECIPES = in_replicas(Recipe(GAS, gp.EventDriven(), 1, None, 0.4, until=ASKED), 2)
RUN = ["run", "scene.yaml", "-o", "run.nc", "--seed", "1", "--sample-interval", "0.4", "--quiet"]


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """Two replicas, in processes that import nothing from the working folder."""
    folder = tmp_path_factory.mktemp("replicas")
    (folder / "queue.py").write_text("raise SystemExit('this file was executed')")
    GAS.to_file(folder / "scene.yaml")
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(folder)
        assert main([*RUN, "--until", "Z=0.03", "--replicas", "2"]) == 0
    return folder


@pytest.fixture
def whole(folder):
    return [path.read_bytes() for path in gp.replica_paths(folder / "run.nc", 2)]


def make(folder, number):
    """Make a replica in this process, beside another one that has gone as far."""
    path = gp.replica_paths(folder / "run.nc", 2)[number]
    return trajectory.record(RECIPES[number], path, WriteOptions(examiner=Examiner())).read_bytes()


@pytest.mark.parametrize("made", [0, 1])
@pytest.mark.parametrize("finished", [False, True])
def test_each_has_its_bits_whether_the_other_one_is_complete_or_under_way(tmp_path, whole, made, finished):
    other = gp.replica_paths(tmp_path / "run.nc", 2)[1 - made]
    (other if finished else partial_path(other)).write_bytes(whole[1 - made])
    assert make(tmp_path, made) == whole[made]


def test_replicas_that_were_cut_short_end_in_the_same_bits(tmp_path, whole):
    """One is complete, and the other has lost all."""
    first, second = gp.replica_paths(tmp_path / "run.nc", 2)
    first.write_bytes(whole[0])
    gp.resume(first)
    assert [first.read_bytes(), second.read_bytes()] == whole


def test_they_wait_for_the_one_that_is_behind_and_count_no_other_run(tmp_path, whole):
    files = gp.replica_paths(tmp_path / "run.nc", 2)
    wanted = list(zip(files, RECIPES, strict=True))
    files[0].write_bytes(whole[0])
    assert find_replicas(wanted, 64) is None
    gp.run(GAS, gp.EventDriven(), 7, 40.0, 0.4, files[1])
    assert find_replicas(wanted, 64) is None
    partial_path(files[1]).write_bytes(whole[1])
    assert find_replicas(wanted, 64) == [files[0], partial_path(files[1])]
    with gp.open_trajectory(files[0]) as run:
        most = run.sizes["frame"]
    assert find_replicas(wanted, most) and find_replicas(wanted, most + 1) is None


def test_a_replica_that_is_cut_while_it_is_read_is_waited_for(tmp_path, whole):
    """As by its own process, which goes on from an earlier checkpoint after a kill."""
    first, second = gp.replica_paths(tmp_path / "run.nc", 2)
    for path, data in zip((first, second), whole, strict=True):
        partial_path(path).write_bytes(data)

    def cutting(runs, until, frames):
        partial_path(second).write_bytes(whole[1] if kept else b"")
        raise gp.SceneError("file", str(second), "frame 3 is damaged")

    kept = False
    assert examination(RECIPES[0], partial_path(first), cutting)(64) is None
    partial_path(second).write_bytes(whole[1])
    kept = True
    with pytest.raises(gp.SceneError, match="frame 3 is damaged"):
        examination(RECIPES[0], partial_path(first), cutting)(64)


def test_they_are_independent_and_their_mean_is_as_accurate_as_required(folder):
    path = folder / "run.nc"
    (known,) = gp.reached_accuracy(path)
    files = gp.replica_paths(path, 2)
    assert [known] == gp.reached_accuracy(files[1])
    mean = gp.analysis.replicas("Z", files)
    assert known.value == pytest.approx(float(mean.estimate), rel=1e-12) and known.met
    each = [float(gp.analysis.compressibility_factor(file).error) for file in files]
    assert known.error >= 0.999 * (each[0] ** 2 + each[1] ** 2) ** 0.5 / 2.0
    assert known.error < min(each) and known.freedom > 15.0
    exact = float(gp.theory.compressibility_factor(0.2, 3))
    assert abs(known.value - exact) < 4.0 * known.error + 0.02 * exact  # of 32 spheres


def test_the_command_that_reproduces_them_and_what_resumes_them(folder, monkeypatch, capsys, whole):
    monkeypatch.chdir(folder)
    assert main(["info", "run-2.nc"]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert ", replica 2 of 2, " in lines[0] and "interval" in lines[2]
    (command,) = [line.split() for line in lines if line.startswith("    gaspart run scene.yaml")]
    assert command[2:10] == ["scene.yaml", "-o", "run.nc", "--engine", "event", "--seed", "1", "--until"]
    assert command[command.index("--replicas") + 1] == "2"
    for name in ("run.nc", "run-1.nc"):
        assert main(["resume", name]) == 2
        assert "path = 'run.nc': is already complete, in all of its replicas" in capsys.readouterr().err


def test_commands_take_the_name_of_a_replicated_run(folder, monkeypatch, capsys, whole):
    monkeypatch.chdir(folder)
    assert main(["measure", "run.nc", "Z"]) == 0
    of_name = capsys.readouterr().out
    assert main(["measure", "run-1.nc", "run-2.nc", "Z"]) == 0
    assert of_name == capsys.readouterr().out
    assert main(["info", "run.nc"]) == 0
    assert "run-1.nc: 32 hard spheres, replica 1 of 2" in capsys.readouterr().out
    assert main(["check", "run.nc"]) in (0, 1)
    lines = capsys.readouterr().out.splitlines()
    assert [line.split(":")[0] for line in lines if "spheres in" in line] == ["run-1.nc", "run-2.nc"]
    assert main(["export", "run.nc", "-o", "run.gsd"]) == 2
    assert "'run.nc': is a run of several replicas; name one of them, as run-1.nc" in capsys.readouterr().err


def test_a_missing_replica_is_named(tmp_path, whole):
    first, second = gp.replica_paths(tmp_path / "run.nc", 2)
    first.write_bytes(whole[0])
    with pytest.raises(gp.SceneError, match=f"{second.name}': is not there: it is one of 2 replicas"):
        gp.reached_accuracy(tmp_path / "run.nc")
    assert main(["info", str(first)]) == 0


def test_what_would_be_one_run_is_refused(tmp_path):
    state = gp.Simulation(GAS, gp.EventDriven(), 1).initial_state
    settings = {"duration": 8.0, "sample_interval": 0.4, "path": tmp_path / "run.nc"}
    with pytest.raises(gp.SceneError, match="replicas = 2: would be one run, bit for bit"):
        gp.run(GAS, gp.EventDriven(), 1, **settings, initial=state, replicas=2)
    with pytest.raises(gp.SceneError, match="replicas = 0: must be"):
        gp.run(GAS, gp.EventDriven(), 1, **settings, replicas=0)
    assert not list(tmp_path.iterdir())
    assert (
        len(in_replicas(Recipe(GAS, gp.DSMC(), 1, 8.0, 0.4, initial=state), 2)) == 2
    )  # which draws partners
