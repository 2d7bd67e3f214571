"""Contents of an archive except its tables: sources, results, captions."""

from __future__ import annotations

import os
import posixpath
import re
from collections.abc import Iterator
from contextlib import chdir
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from gaspart.errors import SceneError
from gaspart.files import resolve_path
from gaspart.reproduction.claims import table
from gaspart.reproduction.claims.table import fill_caption
from gaspart.reproduction.config import check, is_own, keep_efforts, merged_with_default
from gaspart.reproduction.points.point import TRAJECTORIES, Point
from gaspart.reproduction.points.points import figure_points
from gaspart.reproduction.points.trust import require_own
from gaspart.reproduction.registry import caption
from gaspart.yaml_text import read_yaml


def leads_out(name: str) -> bool:
    """Return True for the name of a file that is not below the folder of an archive."""
    return name.startswith("/") or "\\" in name or ".." in name.split("/")


def scene_files(config: Any) -> list[str]:
    """Return the distinct normalised paths of all scene files (`scene` in points and grids) of a merged
    config.
    """
    paths: dict[str, None] = {}
    blocks = [config.get("experiments") if isinstance(config, dict) else None]
    while blocks:
        block = blocks.pop()
        if isinstance(block, dict):
            named = block.get("scene")
            names = named if isinstance(named, list) else [named]
            paths |= {posixpath.normpath(name): None for name in names if isinstance(name, str)}
        blocks += block.values() if isinstance(block, dict) else block if isinstance(block, list) else []
    return list(paths)


_BASE = Path("config/config.yaml")
_WORKFLOWS = ("workflow/Snakefile", "Snakefile")
_WHOLE = {"experiments", "figures"}
"""Keys of a config that is complete by itself; other configs are merged over a default config."""


@dataclass(frozen=True)
class Finished:
    """Finished run: merged config, its files, and points of figures and films. All paths are relative to
    `root`, the folder of the workflow. `results` is `results` or `results/<run>`, in the folder of the
    module's prefix if there is a prefix.
    """

    root: Path
    results: str
    config: dict[str, Any]
    points: list[Point]
    configs: list[str]

    @property
    def workflow(self) -> str:
        """Path of the Snakefile."""
        return next(name for name in _WORKFLOWS if (self.root / name).is_file())

    @property
    def is_copy(self) -> bool:
        """True if `root` is a copy of the project, and not a workflow that uses it as a module."""
        return (self.root / "workflow/rules/common.smk").is_file()

    @property
    def figures(self) -> list[str]:
        """Names of the figures."""
        return list(self.config["figures"])

    @property
    def report(self) -> str:
        """Path of the report."""
        return f"{self.results}/report.html"

    def outputs(self) -> Iterator[str]:
        """Yield the results in every archive; figures in a journal's width, a third of all, are left out."""
        folder = self.results
        yield f"{folder}/tables/claims.csv"
        if self.config.get("opening"):
            yield f"{folder}/play.html"
        for figure in self.figures:
            yield from (
                f"{folder}/figures/{name}" for name in (f"{figure}.png", f"{figure}.svg", f"key/{figure}.png")
            )
            yield from (f"{folder}/claims/{figure}.csv", f"{folder}/measurements/{figure}.nc")
        for film, block in self.config.get("animations", {}).items():
            if block:
                yield from (f"{folder}/animations/{film}.{kind}" for kind in ("mp4", "jpg"))
        yield from (point.path for point in self.points if point.job != TRAJECTORIES)

    def trajectories(self) -> Iterator[tuple[Point, str]]:
        """Yield the point and the path of each trajectory."""
        for point in self.points:
            if point.job == TRAJECTORIES:
                yield from ((point, path) for path in point.replica_paths)


def find_finished(results: str | Path, config: str | Path | None = None) -> Finished:
    """Find the finished run whose results are in the folder `results` or `results/<run>`. By default,
    `config` is the one config of the project with the name of this run. If another workflow uses this one as
    a module, the project is that of the other workflow. Raises SceneError if results are missing, or if
    trajectories were made with settings that differ from the config.
    """
    folder = resolve_path(results)
    if not (folder / "tables/claims.csv").is_file():
        rule = "holds no results of a finished run: tables/claims.csv is missing"
        raise SceneError("results", str(results), rule)
    named = folder.name != "results"
    parent = folder.parents[1] if named else folder.parent
    root = _project_of(parent)
    if (named and folder.parent.name != "results") or root is None:
        rule = "must be the folder results of a project, or that of a run in it, results/<run>"
        raise SceneError("results", str(results), rule)
    name = folder.name if named else None
    file = _config_of(root, name) if config is None else Path(config)
    merged, files = merged_with_default(file, root / _BASE)
    if merged.get("run") != name:
        raise SceneError("run", merged.get("run"), f"must be {name or 'absent'}, as {results} is", str(file))
    prefix = parent.relative_to(root)
    inside = [str(path.relative_to(root)) for path in files if path.is_relative_to(root)]
    keep_efforts(merged, parent / str(merged.get("points")))
    with chdir(root):  # folder from which scene files are read
        points = _select_points(merged, check(merged, files))
        points = [replace(point, root=str(prefix / point.root)) for point in points]
        run = Finished(root, str(folder.relative_to(root)), merged, points, inside)
        _check(run, file, results)
    return run


def _project_of(folder: Path) -> Path | None:
    """Return the nearest folder with a workflow, `folder` or a parent, or None."""
    for candidate in (folder, *folder.parents):
        if any((candidate / name).is_file() for name in _WORKFLOWS):
            return candidate
    return None


def _select_points(config: dict, planned: dict[str, dict[str, Point]]) -> list[Point]:
    """Return the distinct points of figures and films, which are those that the rule `all` makes."""
    points = [point for figure in config["figures"] for point in figure_points(config, figure, planned)]
    films = [block for block in config.get("animations", {}).values() if block]
    points += [next(iter(planned[block["experiment"]].values())) for block in films]
    return list({point.path: point for point in points}.values())


def _config_of(root: Path, name: str | None) -> Path:
    """Return the only config of a run, whose name may be None; raise SceneError for none or several."""
    if name is None and (root / _BASE).is_file():
        return root / _BASE
    files = [*sorted((root / "config").glob("*.y*ml")), *sorted(root.glob("*.y*ml"))]
    having = [file for file in files if _is_config_of(file, name)]
    if len(having) != 1:
        rule = f"is the run of {len(having)} configs in {root / 'config'} and {root}: name its config"
        raise SceneError("run", name, f"{rule} (--config FILE)")
    return having[0]


def _is_config_of(file: Path, name: str | None) -> bool:
    """Return True for a config with this value of `run`; without a name it must be complete."""
    try:
        content = read_yaml(file)
    except SceneError:
        return False
    if not isinstance(content, dict) or (name is None and not content.keys() >= _WHOLE):
        return False
    return content.get("run") == name


def _check(run: Finished, file: Path, results: str | Path) -> None:
    """Raise SceneError for points outside the project's folder, missing results, or different settings."""
    folder = Path(run.config.get("points", "results/points"))
    if folder.is_absolute() or ".." in folder.parts:
        raise SceneError("points", str(folder), "must be in the project's folder for an archive", str(file))
    paths = [run.report, *run.outputs(), *(path for _, path in run.trajectories())]
    missing = [path for path in paths if not (run.root / path).is_file()]
    if missing:
        others = f" and {len(missing) - 1} other files are missing" if missing[1:] else " is missing"
        rule = f"is not complete: {missing[0]}{others}; run the workflow to its end"
        raise SceneError("results", str(results), rule)
    for point in run.points:
        require_own(point)


CITATION = "CITATION.cff"
LOCKED = "environment.txt"
README = "README.md"
_NEEDED = (LOCKED, README, "LICENSE", "pyproject.toml")
_IF_PRESENT = ("Makefile", "CHANGELOG.md", "Containerfile")
FOLDERS = {
    "config": "configs and scenes",
    "workflow": "rules, scripts and captions of the workflow",
    "profiles": "Snakemake's settings for one machine and for a cluster",
    "src": "the library",
}
"""Folders of sources, with their descriptions."""
_OF_PACKAGE = Path(__file__).parents[4]
"""Folder of the project, if gaspart runs from a checkout."""


def sources(run: Finished) -> Iterator[str]:
    """Yield the files of the project with which the run can be repeated. If another workflow uses this one as
    a module, it has some of these files, and CITATION.cff. Raises SceneError if a necessary file is missing.
    """
    required = (run.workflow, CITATION, *(_NEEDED if run.is_copy else ()))
    for name in required:
        if not (run.root / name).is_file():
            raise SceneError("folder", str(run.root), f"has no {name}, which an archive needs")
        yield name
    yield from (
        name for name in (*_NEEDED, *_IF_PRESENT) if name not in required and (run.root / name).is_file()
    )
    for folder in folders(run):
        yield from _files(run.root, folder)
    yield from run.configs
    yield from (block["module"] for block in run.config["figures"].values() if "module" in block)
    for name in scene_files(run.config):
        if leads_out(name):
            raise SceneError("scene", name, "must be in the project's folder for an archive")
        yield name


def folders(run: Finished) -> list[str]:
    """Return the folders of sources that exist in the project."""
    return [folder for folder in FOLDERS if (run.root / folder).is_dir()]


def _files(root: Path, folder: str) -> Iterator[str]:
    """Yield the files in a folder and its subfolders, except hidden files and caches of Python and pip."""
    for parent, folders, names in os.walk(root / folder):
        folders[:] = sorted(name for name in folders if name != "__pycache__" and _is_kept(name))
        for name in sorted(filter(_is_kept, names)):
            path = Path(parent, name)
            if path.is_file() and not path.is_symlink():
                yield str(path.relative_to(root))


def _is_kept(name: str) -> bool:
    return not name.startswith(".") and not name.endswith((".egg-info", ".pyc"))


def report(run: Finished) -> str:
    """Return the report without its pictures for narrow screens; the archive has no such pictures."""
    page = (run.root / run.report).read_text(encoding="utf-8")
    return re.sub(r'<source\b[^>]*\bsrcset="figures/journal/[^>]*>', "", page)


def captions(run: Finished) -> dict[str, str]:
    """Return {path in the archive: caption} of each figure, with its measured numbers."""
    rows = table.read(run.root / run.results / "tables/claims.csv")
    texts = {figure: _caption(run, figure) for figure in run.figures}
    claims = {figure: [row for row in rows if row["figure"] == figure] for figure in texts}
    return {
        f"{run.results}/captions/{figure}.rst": fill_caption(text, claims[figure])
        for figure, text in texts.items()
        if text is not None
    }


def _caption(run: Finished, figure: str) -> str | None:
    """Return the caption of a figure with placeholders, or None if it is in the folder of a module."""
    block = run.config["figures"][figure]
    if is_own(block):
        return caption(block)
    for root in (run.root, _OF_PACKAGE):
        if (path := root / f"workflow/report/{figure}.rst").is_file():
            return path.read_text(encoding="utf-8")
    return None
