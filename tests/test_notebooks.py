"""The tutorials run from top to bottom; what they claim is asserted in their own cells."""

import os
from pathlib import Path

import nbformat
import pytest
from nbclient import NotebookClient

pytestmark = pytest.mark.thorough

ROOT = Path(__file__).parents[1]
NOTEBOOKS = sorted((ROOT / "docs/notebooks").glob("*.ipynb"))


SERIES = ["first_gas", "pressure", "barometer", "accuracy", "sweep"]
CLASSICS = ["pi_by_billiards", "loschmidt_echo"]


def test_the_series_is_in_order_and_each_tutorial_leads_to_the_next():
    index = (ROOT / "docs/notebooks/index.md").read_text(encoding="utf-8").split()
    listed = [word for word in index if word in {path.stem for path in NOTEBOOKS}]
    assert listed == [*SERIES, *CLASSICS] and len(NOTEBOOKS) == len(listed)
    for n, name in enumerate(SERIES):
        cells = nbformat.read(ROOT / f"docs/notebooks/{name}.ipynb", as_version=4).cells
        assert cells[0].source.startswith(f"# {n + 1}. ")
        for neighbour in (n - 1, n + 1):
            if 0 <= neighbour < len(SERIES):
                assert f"({SERIES[neighbour]}.ipynb)" in cells[-1].source


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_a_notebook_runs_and_is_kept_without_output(path, tmp_path):
    notebook = nbformat.read(path, as_version=4)
    code = [cell for cell in notebook.cells if cell.cell_type == "code"]
    assert all(not cell.outputs and cell.execution_count is None for cell in code)
    environment = {key: value for key, value in os.environ.items() if key != "MPLBACKEND"}
    environment["PYTHONPATH"] = str(ROOT / "src")
    client = NotebookClient(
        notebook, timeout=300, kernel_name="python3", resources={"metadata": {"path": tmp_path}}
    )
    client.execute(env=environment)
    assert any("image/png" in output.get("data", {}) for cell in code for output in cell.outputs)
