"""The workflow as a module of another one, in a folder that has nothing but a config and a Snakefile."""

import re

import pytest
from workspace import ROOT, Workspace

from gaspart.reproduction.points.overlay import laid_over
from gaspart.yaml_text import parse_yaml, write_yaml

pytestmark = pytest.mark.workflow

SNAKEFILE = f"""
configfile: "settings.yaml"

module gaspart:
    snakefile: "{ROOT / "Snakefile"}"
    config: config

use rule * from gaspart
"""
FIGURE = "wall_pressure"
OWN = re.search(
    r"^```yaml\n(# my_gas\.yaml\n.*?)^```$",
    (ROOT / "docs/adding-a-figure.md").read_text(encoding="utf-8"),
    re.MULTILINE | re.DOTALL,
)


def test_another_workflow_uses_it_as_a_module(tmp_path):
    config, _ = laid_over(ROOT / "config/smoke.yaml")
    experiments = config["figures"][FIGURE]["experiments"]
    config |= {
        "run": None,
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


STAGES = {"warm": 1, "simulate": 3, "measure": 1, "judge": 1, "draw": 1}


def test_a_module_may_have_figures_of_its_own_only(tmp_path):
    """The config of docs/adding-a-figure.md, with what a whole one needs."""
    assert OWN
    config = {"title": "my gas", "seed": 1, "points": "results/points", **parse_yaml(OWN[1])}
    write_yaml(tmp_path / "settings.yaml", config)
    (tmp_path / "Snakefile").write_text(SNAKEFILE)
    here = Workspace(tmp_path)
    assert here.plan("all", source=ROOT) == {**STAGES, "claims": 1, "report": 1, "all": 1}
    write_yaml(tmp_path / "settings.yaml", config | {"figures": {}})
    assert here.plan("points", source=ROOT) == {"warm": 1, "simulate": 3, "points": 1}


def test_a_figure_of_ones_own_is_laid_over_the_config_in_a_run_with_a_name(fresh, tmp_path):
    own = tmp_path / "my_gas.yaml"
    own.write_text("run: mine\n" + OWN[1])
    targets = ["results/mine/figures/my_gas.png", "results/mine/claims/my_gas.csv"]
    assert fresh.plan(*targets, "--configfile", str(own)) == STAGES
