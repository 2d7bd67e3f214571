"""Typical mistakes on the command line: one line states what to do, with exit code 2."""

import pytest

from gaspart.cli import main

GAS = """\
container: {lengths: [12.0, 12.0], boundary: wall}
species:
- {count: 20, radius: 0.5, temperature: 1.0}
"""
SPHERES = GAS.replace("[12.0, 12.0]", "[12.0, 12.0, 12.0]")
CONFIG = """\
title: a
seed: 1
points: results/a
experiments:
  gas:
    point: {dimension: 2, count: 50, packing_fraction: 0.1, boundary: periodic, collisions_per_particle: 5}
figures: {wall_pressure: {experiments: [gas]}}
"""
RESERVOIR = "{kind: open, activity: 0.1, temperature: 1.0}"
KEPT = ["--keep", "positions"]
RUN = ["run", "scene.yaml", "-o", "run.nc", "--duration", "1", "--sample-interval", "0.5"]
CHECK = ["check", "scene.yaml"]


def scene(old, new, text=GAS):
    """A mistake in a scene file."""
    assert old in text
    return text.replace(old, new), CHECK


def config(old, new):
    """A mistake in a config."""
    assert old in CONFIG
    return CONFIG.replace(old, new), CHECK


def added(line, text=GAS):
    """A line too many in a scene file."""
    return f"{text}{line}\n", CHECK


def line(*arguments):
    """A mistake on the command line, with a correct scene file."""
    return GAS, list(arguments)


MISTAKES = {
    # words
    "no command": (line(), "the following arguments are required"),
    "misspelt command": (line("rnu"), "'rnu': unknown command; did you mean run?"),
    "unknown command": (line("fly"), "unknown command; known are new, run, resume"),
    "scene instead of a trajectory": (
        line("measure", "scene.yaml", "pressure"),
        "must be a trajectory; run a scene first: gaspart run scene.yaml -o scene.nc",
    ),
    "accuracy of what ends no run": (
        line(*RUN[:4], "--until", "temperature=1e-2"),
        "'temperature': does not end a run; use Z, pressure",
    ),
    "misspelt option": (line(*RUN, "--sede", "1"), "--sede: unknown option; did you mean --seed?"),
    "option without value": (line(*RUN, "--seed"), "--seed: expected one argument"),
    "two scenes": (line("run", "a.yaml", *RUN[1:]), "too many arguments; see `gaspart run --help`"),
    "no output": (line("run", "scene.yaml", "--duration", "1"), "required: -o/--output"),
    "duration is a word": (line(*RUN, "--duration", "long"), "--duration: invalid float value: 'long'"),
    "interval does not fit": (line(*RUN, "--sample-interval", "0.3"), "must be a whole multiple of sample"),
    "seed is a fraction": (line(*RUN, "--seed", "1.5"), "--seed: '1.5' must be a whole number"),
    "unknown engine": (
        line(*RUN, "--engine", "md"),
        "--engine: 'md': must be one of ('event', 'step', 'dsmc')",
    ),
    "step without a step": (line(*RUN, "--engine", "step"), "--time-step: is required"),
    "step of the event engine": (line(*RUN, "--time-step", "1"), "has no meaning with --engine event"),
    "interval below the step": (
        line(*RUN, "--engine", "step", "--time-step", "0.7"),
        "sample_interval = 0.5: must be a whole multiple of time_step, 0.7",
    ),
    "following too many": (
        line(*RUN, "--follow", "21"),
        "follow = 21: must be at most 20, the number of particles",
    ),
    "correlations without lags": (line(*RUN, "--correlations", "0.5"), "--correlations: must be an interval"),
    "no such scene": (line("check", "gas.yaml"), "gas.yaml"),
    "no such folder": (line(*RUN, "-o", "out/run.nc"), "must be a file in an existing folder"),
    "unknown observable": (line("measure", "run.nc", "friction"), "'friction': unknown name; known are Z"),
    "table of two": (line("measure", "run.nc", "Z", "D", "-o", "a.csv"), "-o takes one observable"),
    "unknown quantity of theory": (line("theory", "pressure", "--eta", "0.1"), "'pressure': unknown name"),
    "accuracy in percent": (line(*RUN[:4], "--until", "Z=1%"), "as Z=1e-3 for 0.1 %"),
    "budget of a scene": (line("budget", "scene.yaml"), "is a scene, and must be a config of the workflow"),
    "unknown part to keep": (line(*RUN, "--keep", "speeds"), "must be one of ('positions', 'velocities')"),
    "piston beyond the gas": (
        (GAS + "faces: {x_low: {kind: piston, speed: 1.5}}\n", [*RUN[:4], "--duration", "9", *RUN[6:]]),
        "must be before 7.",
    ),
    "theory without density": (line("theory", "Z"), "required: --eta"),
    "advice on nothing": (line("advise"), "give a scene or --config, and not both"),
    "unknown shell": (line("completion", "fish"), "'fish': unknown name; known are bash, zsh, tcsh"),
    # scene files
    "empty file": (("", CHECK), "must be a mapping"),
    "tab": (("container:\n\tlengths: [9, 9]\n", CHECK), "indent with spaces, not with tabs"),
    "older name": (added("bodies: []"), "bodies = []: unknown key; did you mean particles?"),
    "no radius": (scene("radius: 0.5, ", ""), "species[0].radius = None: is required"),
    "gravity along a periodic axis": (
        (GAS.replace("wall", "periodic") + "gravity: [0.0, -1.0]\n", CHECK),
        "gravity",
    ),
    "too dense": (
        scene("count: 20", "count: 150"),
        "scene.yaml: species[0].count = 150: does not fit by random insertion",
    ),
    "wall below zero temperature": (
        added("walls: [{start: [6.0, 0.0], end: [6.0, 12.0], temperature: -2}]"),
        "walls[0].temperature = -2: must be positive",
    ),
    "face of a periodic axis": (
        (GAS.replace("wall", "periodic") + "faces: {x_low: {kind: thermal, temperature: 1.0}}\n", CHECK),
        "a periodic axis has no faces",
    ),
    "face of the other dimension": (added("faces: {z_low: {kind: sticky, momentum: 1.0}}"), "faces"),
    "wall in three dimensions": (
        added("walls: [{start: [1.0, 1.0], end: [2.0, 2.0]}]", SPHERES),
        "walls[0].start = [1.0, 1.0]: unknown key; known are corner, edges",
    ),
    # configs
    "misspelt key of a point": (config("count", "cuont"), "unknown key; did you mean count?"),
    "missing key of a point": (config("dimension: 2, ", ""), "dimension"),
    "unknown figure": (config("wall_pressure", "wall_presure"), "did you mean wall_pressure?"),
}


OF_RUNS = {
    "run that is longer": (
        ["run", "gas.yaml", "-o", "gas.nc", "--duration", "4", "--sample-interval", "0.5"],
        "exists, with a shorter duration; continue it: gaspart resume gas.nc --duration 4",
    ),
    "run of another seed": (
        ["run", "gas.yaml", "-o", "gas.nc", *RUN[4:], "--seed", "7"],
        "exists, of another run, which differs in seed 0, not 7; move it away",
    ),
    "run of another scene": (["run", "open.yaml", "-o", "gas.nc", *RUN[4:]], "which differs in scene"),
    "misspelt observable": (["measure", "gas.nc", "presure"], "did you mean pressure?"),
    "diffusion between walls": (["measure", "gas.nc", "D"], "displacements between walls are bounded"),
    "displacements of an open gas": (
        ["measure", "open.nc", "msd"],
        "lets particles enter and leave, and this observable follows particles that stay; defined here are",
    ),
    "speeds that are not kept": (
        ["measure", "places.nc", "speeds"],
        "the file holds only positions of the particles, and velocities are needed; run without keep",
    ),
}
"""Mistakes with the files of `runs`: those of a gas, of an open one, and of positions alone."""


@pytest.fixture(scope="module")
def runs(tmp_path_factory):
    """The folder of a few runs."""
    folder = tmp_path_factory.mktemp("runs")
    (folder / "gas.yaml").write_text(GAS)
    (folder / "open.yaml").write_text(f"{GAS}centres_to_walls: true\nfaces: {{x_low: {RESERVOIR}}}\n")
    for scene, name, options in (("gas", "gas", []), ("open", "open", []), ("gas", "places", KEPT)):
        output = ["-o", str(folder / f"{name}.nc"), "--quiet"]
        assert main(["run", str(folder / f"{scene}.yaml"), *output, *RUN[4:], *options]) == 0
    return folder


def refused(capsys, arguments, expected):
    """Carry out a command line that is refused in one line."""
    code = main(arguments)
    shown = capsys.readouterr()
    assert code == 2, shown
    assert shown.err.count("\n") == 1 and shown.err.startswith("gaspart: error: "), shown.err
    assert expected in shown.err and len(shown.err) < 400


@pytest.mark.interpreted
@pytest.mark.parametrize("name", OF_RUNS)
def test_a_mistake_with_a_run_is_one_line_that_states_what_to_do(name, runs, monkeypatch, capsys):
    monkeypatch.chdir(runs)
    before = {path.name: path.read_bytes() for path in runs.iterdir()}
    refused(capsys, *OF_RUNS[name])
    assert {path.name: path.read_bytes() for path in runs.iterdir()} == before


@pytest.mark.parametrize("name", MISTAKES)
def test_a_mistake_is_one_line_that_states_what_to_do(name, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    (text, arguments), expected = MISTAKES[name]
    (tmp_path / "scene.yaml").write_text(text)
    refused(capsys, arguments, expected)
    assert [path.name for path in tmp_path.iterdir()] == ["scene.yaml"]
    assert (tmp_path / "scene.yaml").read_text() == text
