"""What a run gives is computed in one place, from which all others take it."""

import re
from pathlib import Path

import pytest

import gaspart

SOURCES = Path(gaspart.__file__).parent
PLACES = {
    # a histogram: `analysis.flow.Grid`
    r"\bhistogram(dd|2d)?\(": set(),
    # Z and the collisions' virial; `mixtures` compares the virial with that of each pair
    r'increments\("virial_sum"\)': {"analysis/series.py", "reproduction/figures/mixtures.py"},
    # impulses over the area of the moment; forces that a balance of momentum needs, without an area
    r'"wall_impulse"': {"analysis/series.py", "reproduction/figures/_columns.py"},
}


@pytest.mark.parametrize("pattern", PLACES)
def test_it_is_computed_in_no_other_place(pattern):
    folders = ("analysis", "inspection", "accuracy", "cli", "reproduction")
    files = [path for folder in folders for path in (SOURCES / folder).rglob("*.py")]
    found = {str(path.relative_to(SOURCES)) for path in files if re.search(pattern, path.read_text())}
    assert len(files) > 100 and found == PLACES[pattern]
