"""The workflow as a module of another one, in a folder that has nothing but a config and a Snakefile."""

import pytest
from workspace import ROOT, Workspace

from gaspart.reproduction.points.overlay import laid_over
from gaspart.yaml_text import write_yaml

pytestmark = pytest.mark.workflow

SNAKEFILE = f"""
configfile: "settings.yaml"

module gaspart:
    snakefile: "{ROOT / "Snakefile"}"
    config: config

use rule * from gaspart
"""
FIGURE = "wall_pressure"


def test_another_workflow_uses_it_as_a_module(tmp_path):
    config, _ = laid_over(ROOT / "config/smoke.yaml")
    experiments = config["figures"][FIGURE]["experiments"]
    config |= {
        "experiments": {name: config["experiments"][name] for name in experiments},
        "figures": {FIGURE: config["figures"][FIGURE]},
        "animations": {},
    }
    write_yaml(tmp_path / "settings.yaml", config)
    (tmp_path / "Snakefile").write_text(SNAKEFILE)
    here = Workspace(tmp_path)
    result = here.snakemake("--cores", "1", "claims", f"results/figures/{FIGURE}.png", source=ROOT)
    assert result.returncode == 0, result.stdout[-3000:]
    assert (tmp_path / f"results/figures/{FIGURE}.png").read_bytes().startswith(b"\x89PNG")
    assert f"{FIGURE}," in (tmp_path / "results/tables/claims.csv").read_text()
    assert sorted(path.name for path in tmp_path.iterdir() if path.name[0] != ".") == [
        "Snakefile",
        "results",
        "settings.yaml",
    ]
    report = here.snakemake("--dry-run", "--cores", "1", "report", source=ROOT)
    assert report.returncode == 0, report.stdout[-2000:]
