"""Several processes that write to one path at random moments: one result, and one line of each other."""

import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import gaspart as gp
from gaspart.analysis.collisions import record_collisions
from gaspart.trajectory.opening import TRAJECTORY
from gaspart.trajectory.provenance import git_revision

GAS = """\
container: {lengths: [12.0, 12.0], boundary: wall}
species:
- {count: 20, radius: 0.5, temperature: 1.0}
"""
RUN = ["run", "scene.yaml", "--duration", "2", "--sample-interval", "0.5", "--checkpoint-seconds", "0"]
WRITERS = {
    "out.nc": [
        [*RUN, "--seed", "1", "-o", "out.nc"],
        [*RUN, "--seed", "1", "-o", "out.nc"],
        [*RUN, "--seed", "2", "-o", "out.nc"],
        ["resume", "out.nc"],
        ["collisions", "scene.yaml", "--count", "50", "-o", "out.nc"],
    ],
    "out.gsd": [["export", "run.nc", "-o", "out.gsd", "--frame", str(frame)] for frame in (0, 1, 2)],
    "out.data": [["export", "run.nc", "-o", "out.data", "--frame", str(frame)] for frame in (0, 1, 2)],
}
# Forked where all is loaded, kernels too: the processes differ by the given times, not by those of loading.
FORKING = """
    import os, sys, time
    import gaspart.trajectory.export, gsd.hoomd, gaspart.analysis.collisions, gaspart.trajectory.run
    from gaspart.cli import main

    gas = gaspart.Scene.from_file("scene.yaml")
    gaspart.collision_data(gas, 1)
    gaspart.Simulation(gas, gaspart.EventDriven(), 1).advance(1.0)

    def carry_out(line, delay, number):
        for name, stream in (("out", 1), ("err", 2)):
            os.dup2(os.open(f"log/{number}.{name}", os.O_CREAT | os.O_WRONLY | os.O_TRUNC), stream)
        time.sleep(delay)
        code = main(line)
        sys.stdout.flush()
        os._exit(code)

    for round in sys.stdin:
        children = []
        for number, (line, delay) in enumerate(eval(round)):
            child = os.fork()
            if not child:
                carry_out(line, delay, number)
            children.append(child)
        print([os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) for child in children], flush=True)
"""


@pytest.fixture(scope="module")
def no_revision():
    """No revision in any file: the checkout may be edited during the test."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("GIT_DIR", os.devnull)
        git_revision.cache_clear()
        yield
    git_revision.cache_clear()


@pytest.fixture(scope="module")
def folder(tmp_path_factory, no_revision):
    """A folder with a scene, a trajectory, and what each of the writers would write alone."""
    folder = tmp_path_factory.mktemp("writers")
    (folder / "scene.yaml").write_text(GAS)
    scene = gp.Scene.from_file(folder / "scene.yaml")
    for seed in (1, 2):
        gp.run(scene, gp.EventDriven(), seed, 2.0, 0.5, folder / f"alone-{seed}.nc")
    gp.run(scene, gp.EventDriven(), 1, 1.0, 0.5, folder / "run.nc")
    for frame in (0, 1, 2):
        for suffix in ("gsd", "data"):
            gp.export(folder / "run.nc", folder / f"alone-{frame}.{suffix}", frame)
    record_collisions(scene, folder / "alone.nc", 50)
    (folder / "log").mkdir()
    return folder


@pytest.fixture(scope="module")
def process(folder):
    """A process that carries out rounds of commands at once."""
    import textwrap

    environment = {key: value for key, value in os.environ.items() if not key.startswith("COVERAGE")}
    environment["PYTHONPATH"] = os.pathsep.join(sys.path)
    code = [sys.executable, "-W", "ignore", "-c", textwrap.dedent(FORKING)]
    with subprocess.Popen(
        code, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True, cwd=folder, env=environment
    ) as process:
        yield process
        process.stdin.close()


def play(folder, process, generator):
    """One round, of one path and its writers: what is there afterwards, and what was printed."""
    output = str(generator.choice(list(WRITERS)))
    alone = [path.read_bytes() for path in folder.glob(f"alone*{Path(output).suffix}")]
    before = {path.name for path in folder.iterdir()}
    writers = [(line, generator.uniform(0.0, 0.05)) for line in WRITERS[output]]
    process.stdin.write(repr(writers) + "\n")
    process.stdin.flush()
    codes = eval(process.stdout.readline())
    printed = [(folder / f"log/{number}.err").read_text() for number in range(len(writers))]
    outcome = list(zip(codes, printed, writers, strict=True))
    assert set(codes) <= {0, 2} and 0 in codes, outcome
    for code, text, _ in outcome:
        line = "gaspart: error" if code else "gaspart: in other programs: "
        assert text.count("\n") == text.count(line) == 1 or (text == "" and code == 0), outcome
    path = folder / output
    assert path.read_bytes() in alone, outcome
    left = {path.name for path in folder.iterdir()} - before
    if not TRAJECTORY.recognises(path):  # the trajectory could not replace it, and can be finished elsewhere
        left -= {"out.nc.partial", "out.nc.checkpoint.npz"}
    assert left == {output}, outcome
    for name in (output, "out.nc.partial", "out.nc.checkpoint.npz"):
        (folder / name).unlink(missing_ok=True)
    return sum(code == 0 for code in codes)


def test_writers_at_the_same_time(folder, process):
    generator = np.random.default_rng(14)
    assert sum(play(folder, process, generator) for _ in range(12)) >= 12


@pytest.mark.thorough
def test_many_writers_at_the_same_time(folder, process):
    generator = np.random.default_rng()
    assert sum(play(folder, process, generator) for _ in range(300)) >= 300
