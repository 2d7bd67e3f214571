"""A copy of the project in another folder, and what Snakemake plans and does there."""

import os
import re
import shutil
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

from gaspart.reproduction.config import merged_with_default
from gaspart.yaml_text import read_yaml, write_yaml

ROOT = Path(__file__).parents[2]
PARTS = ["config", "profiles", "src", "workflow"]
SMOKE = ["--configfile", "config/smoke.yaml"]


@dataclass
class Workspace:
    """A checkout in which the workflow can be run and changed."""

    path: Path

    def snakemake(self, *arguments, within=(), source=None):
        """Run Snakemake here, by another command that isolates it; the result, whatever it exits with.

        source: the folder whose modules are used; by default this copy, wherever the installed ones are.
        """
        environment = {**os.environ, "PYTHONPATH": str((source or self.path) / "src")}
        return subprocess.run(
            [*within, sys.executable, "-m", "snakemake", *arguments],
            cwd=self.path,
            env=environment,
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
        )

    def plan(self, *arguments, source=None):
        """The jobs that a dry run would start: {rule: number}."""
        result = self.snakemake("--dry-run", "--cores", "2", *arguments, source=source)
        assert result.returncode == 0, result.stdout
        table = re.search(r"^Job stats:\n(.*?)^total", result.stdout, re.MULTILINE | re.DOTALL)
        if table is None:
            assert "Nothing to be done" in result.stdout
            return {}
        rows = re.findall(r"^(\w+) +(\d+)$", table[1], re.MULTILINE)
        return {rule: int(number) for rule, number in rows}

    @property
    def config(self):
        """The config of the smoke workflow here."""
        return merged_with_default(self.path / "config/smoke.yaml")[0]

    @property
    def figures(self):
        """The names of its figures."""
        return list(self.config["figures"])

    def edit(self, path, old, new):
        """Replace text in a file of this copy; returns a function that puts it back."""
        file = self.path / path
        before = file.read_text()
        assert old in before
        file.write_text(before.replace(old, new, 1))
        return lambda: file.write_text(before)


def copy_of_project(path):
    path.mkdir(exist_ok=True)
    for part in PARTS:
        source = ROOT / part
        if source.is_dir():
            shutil.copytree(source, path / part, ignore=shutil.ignore_patterns("__pycache__", "*.egg-info"))
        else:
            shutil.copy2(source, path / part)
    return Workspace(path)


def leave_one_figure(path, figure, **point):
    """Replace the config of a copy by that of one figure of the smoke config and the experiment of its name,
    with these settings of its points beside its own."""
    config, _ = merged_with_default(ROOT / "config/smoke.yaml")
    for kind in ("experiments", "figures"):
        config[kind] = {figure: config[kind][figure]}
    config["experiments"][figure]["point"].update(point)
    write_yaml(path / "config/config.yaml", config | {"animations": {}, "run": None})


def keep_figures(folder, figures):
    """Remove all figures but these from the configs of a copy, with their experiments."""
    config, _ = merged_with_default(folder / "config/smoke.yaml")
    experiments = {name for figure in figures for name in config["figures"][figure]["experiments"]}
    experiments |= {film["experiment"] for film in config["animations"].values() if film}
    for path in (folder / "config/figures").iterdir():
        content = read_yaml(path)
        for own in (content, content.get("smoke", {})):
            for kind, kept in (("figures", figures), ("experiments", experiments)):
                own[kind] = {name: block for name, block in own.get(kind, {}).items() if name in kept}
        write_yaml(path, content)
