"""What the README shows in Python runs to its end as printed, and so does its scene with other seeds."""

import re
from pathlib import Path

import numpy as np
import pytest

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
    energy, dissipated = map(float, printed[1].split()[:2])
    assert energy + dissipated == pytest.approx(names["sim"].initial_state.energy, rel=1e-9)
    assert dissipated > 0.0
    assert names["sim"].time == 1000.0


@pytest.mark.parametrize("seed", range(2, 12))
def test_the_second_scene_runs_with_other_seeds(names, seed):
    gp = names["gp"]
    sim = gp.Simulation(names["scene"], gp.EventDriven(), seed=seed)
    sim.advance(duration=1000.0)
    sim.check_invariants()
    assert np.isfinite(sim.state.positions).all()
