"""What the README shows runs to its end as printed, and so does its scene with other seeds."""

import json
import re
import shlex
from ast import literal_eval
from pathlib import Path

import numpy as np
import pytest

from gaspart.cli import commands, main

README = Path(__file__).parents[1] / "README.md"


@pytest.fixture(scope="module")
def names():
    """What the blocks of the README define."""
    return {}


def test_the_examples_run(names, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    examples = re.findall(r"```python\n(.*?)```", README.read_text(encoding="utf-8"), re.DOTALL)
    assert len(examples) == 2
    printed = []
    for example in examples:
        exec(compile(example, str(README), "exec"), names)
        printed.append(capsys.readouterr().out)
        assert "advance(" in example  # a scene is not only made but run
    assert (tmp_path / "run.nc").exists()
    assert int(printed[0].split()[0]) > 0
    assert (tmp_path / "run.mp4").stat().st_size > 10_000
    energy, dissipated = map(float, printed[1].split()[:2])
    assert energy + dissipated == pytest.approx(names["sim"].initial_state.energy, rel=1e-9)
    assert dissipated > 0.0
    assert names["sim"].time == 1000.0


def test_the_first_film(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    block = re.search(r"## A first film\n\n```sh\n(.*?)```", README.read_text(encoding="utf-8"), re.DOTALL)[1]
    for line in block.splitlines():
        program, *arguments = shlex.split(line)
        assert program == "gaspart" and main(arguments) == 0, line
    assert (tmp_path / "gas.mp4").stat().st_size > 100_000


def test_it_is_short():
    assert len(README.read_text(encoding="utf-8").split()) <= 900


def test_the_targets_of_make_and_the_commands_exist():
    text = README.read_text(encoding="utf-8")
    rules = re.findall(r"^([\w-]+):", (README.parent / "Makefile").read_text(encoding="utf-8"), re.MULTILINE)
    assert set(re.findall(r"`make ([\w-]+)`", text)) <= set(rules)
    assert set(re.findall(r"^make (\w+)", text, re.MULTILINE)) == {"first", "test"}
    named = text[text.index("Commands: ") : text.index("has an example in its")]
    assert set(commands()) <= set(re.findall(r"`(?:gaspart )?(\w+)`", named))


@pytest.mark.parametrize("seed", range(2, 12))
def test_the_second_scene_runs_with_other_seeds(names, seed):
    gp = names["gp"]
    sim = gp.Simulation(names["scene"], gp.EventDriven(), seed=seed)
    sim.advance(duration=1000.0)
    sim.check_invariants()
    assert np.isfinite(sim.state.positions).all()


WORDS = ["no", "one", "two", "three", "four", "five", "six", "seven", "eight", "nine", "ten"]


def test_numbers_on_pages_are_those_of_the_project():
    root = README.parent
    pages = {path.name: path.read_text(encoding="utf-8") for path in (root / "docs").glob("*.md")}
    text, changes = README.read_text(encoding="utf-8"), (root / "CHANGELOG.md").read_text(encoding="utf-8")
    table = re.search(
        r"^\| packing fraction \| to 10 %.*?\n\n", pages["accuracy.md"], re.DOTALL | re.MULTILINE
    )
    rows = [re.findall(r"[\d.]+", line) for line in table[0].splitlines()[2:] if line]
    highest = max(float(cost) for _, *costs in rows for cost in costs)
    assert f"can cost {highest:g} times as much" in text
    shown = re.search(r"^SHOWN = (.*)", (root / "docs/contact_sheet.py").read_text("utf-8"), re.MULTILINE)[1]
    assert f"![{WORDS[len(literal_eval(shown))].capitalize()} scenes: " in text
    exact = json.loads((root / "tests/exact/values.json").read_text(encoding="utf-8"))
    assert f"exact values ({len(exact)} kinds of scenes)" in changes
