"""What the README shows in Python runs as it stands there."""

import re
from pathlib import Path

README = Path(__file__).parents[1] / "README.md"


def test_the_examples_run(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    names = {}
    examples = re.findall(r"```python\n(.*?)```", README.read_text(encoding="utf-8"), re.DOTALL)
    assert len(examples) == 2
    for example in examples:
        exec(compile(example, str(README), "exec"), names)
    assert (tmp_path / "run.nc").exists()
    assert int(capsys.readouterr().out.split()[0]) > 0
    names["gp"].Simulation(names["scene"], names["gp"].EventDriven(), seed=1).advance(max_events=20)
