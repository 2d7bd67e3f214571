"""Scripts of findings/ have a row each, pin what they install, and stand by themselves."""

import re
from pathlib import Path

import pytest

FOLDER = Path(__file__).parents[1] / "findings"
SCRIPTS = sorted(FOLDER.glob("*.sh"))


def test_each_script_has_a_row():
    rows = re.findall(
        r"^\| \[(\w+)\]\((\w+)\.sh\) \|", (FOLDER / "README.md").read_text(encoding="utf-8"), re.M
    )
    assert len(rows) >= 10 and all(name == file for name, file in rows)
    assert sorted(name for name, _ in rows) == [path.stem for path in SCRIPTS]


@pytest.mark.parametrize("path", SCRIPTS, ids=[path.stem for path in SCRIPTS])
def test_a_finding_states_its_case_and_pins_its_packages(path):
    text = path.read_text(encoding="utf-8")
    head = text[: text.index("set -euo pipefail")]
    for part in ("# Usual guess: ", "# What happens: ", "# Way out: ", "# Seen with "):
        assert part in head
    packages = re.search(r"^packages=\((.+)\)$", text, re.M)[1].split()
    assert packages and all(re.fullmatch(r"[\w-]+==[\w.]+", package) for package in packages)
    assert "gaspart" not in text and '"the behaviour has changed"' in text
    compile(re.search(r"<<'PYTHON'\n(.*)\nPYTHON\n", text, re.S)[1], path.name, "exec")
