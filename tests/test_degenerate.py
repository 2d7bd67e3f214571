"""Every command and observable of valid scenes in which little happens: a result or one line, no more."""

import math
import re
import warnings

import numpy as np
import pytest
from degenerate import SCENES, degenerate

import gaspart as gp
from gaspart.analysis.observables import OBSERVABLES
from gaspart.cli import main

DURATIONS = {"two frames": (0.2, 0.2), "few collisions": (4.0, 0.1)}
FEW = [
    (2, 1, "rest", "wall", False),
    (2, 20, "equal speeds", "wall", False),
    (3, 2, "equal speeds", "periodic", False),
    (3, 20, "parallel", "periodic", False),
]
"""Scenes of `make test`: each value of each property; fixed particles have kernels of their own."""
EACH = [
    pytest.param(kind, marks=() if kind in FEW else pytest.mark.thorough, id=str(kind)) for kind in SCENES
]


@pytest.fixture(autouse=True)
def _no_warning():
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        warnings.filterwarnings("ignore", "gaspart: all particles are at rest")  # as some are on purpose
        yield


def ran(tmp_path, scene, length):
    duration, interval = DURATIONS[length]
    return gp.run(scene, gp.EventDriven("direct"), 1, duration, interval, tmp_path / "a.nc")


def printed(capsys, *words):
    """What a command prints: a result, or one line that names what is wrong."""
    code = main([*map(str, words)])
    out, err = capsys.readouterr()
    err = re.sub(r"(?m)^gaspart: in other programs: .*\n", "", err)  # a remark, not a mistake
    assert code in (0, 2), (words, out, err)
    assert (err == "") == (code == 0) and err.count("\n") == (code == 2), (words, err)
    assert "WRONG" not in out
    return out or err


def sensible(line):
    """Whether a line of results has finite numbers, and no meaningless deviation."""
    deviation = re.search(r"(\S+) standard deviations", line)
    return not re.search(r"\b(nan|inf)\b", line) and (not deviation or abs(float(deviation[1])) < 100.0)


@pytest.mark.parametrize("length", DURATIONS)
@pytest.mark.parametrize("kind", EACH)
def test_a_degenerate_scene_is_measured_or_refused_in_one_line(kind, length, tmp_path, capsys):
    path = ran(tmp_path, degenerate(*kind), length)
    for command in ("info", "check"):
        printed(capsys, command, path)
    for name in OBSERVABLES:
        lines = printed(capsys, "measure", path, name).splitlines()
        assert lines, name
        if lines[0].startswith(f"{name} = "):
            assert sensible(lines[0]), lines[0]


@pytest.mark.parametrize("kind", EACH[2 :: len(SCENES) // 7])
def test_other_commands_take_a_degenerate_scene(kind, tmp_path, capsys):
    scene = degenerate(*kind)
    path, written = ran(tmp_path, scene, "two frames"), tmp_path / "scene.yaml"
    scene.to_file(written)
    for words in (
        ("check", written),
        ("run", written, "-o", tmp_path / "b.nc", "--duration", 0.2, "--sample-interval", 0.1),
        ("resume", path),
        ("export", path, "-o", tmp_path / "a.data"),
        ("render", path, "-o", tmp_path / "a.png"),
        ("view", path, "-o", tmp_path / "a.html"),
        ("measure", path, "temperature", "--start", 0.0, "-o", tmp_path / "a.csv"),
        ("advise", written, "--observable", "Z", "--accuracy", 0.1, "--pilot", 0.05),
    ):
        printed(capsys, *words)


def test_a_scene_without_particles_is_refused(tmp_path, capsys):
    written = tmp_path / "scene.yaml"
    gp.Scene(gp.Container((4.0, 4.0)), [gp.Species(0, 0.5)]).to_file(written)
    assert "0 particles" in printed(capsys, "check", written)
    line = printed(capsys, "run", written, "-o", tmp_path / "a.nc", "--duration", 1, "--sample-interval", 1)
    assert "a run needs at least one particle" in line


def test_z_of_a_run_without_collisions_is_refused(tmp_path, capsys):
    path = ran(tmp_path, degenerate(3, 2, "parallel", "periodic", False), "few collisions")
    for name in ("Z", "collision_rate"):
        assert "collisions = 0: none happened in the measured part" in printed(capsys, "measure", path, name)
    assert "0 collisions per particle; no sample of the pressure" in printed(capsys, "info", path)


def test_a_quantity_that_does_not_change_has_no_deviation(tmp_path):
    found = gp.analysis.order_parameter(
        ran(tmp_path, degenerate(2, 20, "rest", "periodic", False), "few collisions")
    )
    assert float(found.error) == 0.0 and math.isfinite(float(found.estimate))
    with_theory = found.assign(order_parameter_theory=found.estimate + 1.0, order_parameter_theory_error=0.0)
    assert np.isnan(with_theory.deviation)
