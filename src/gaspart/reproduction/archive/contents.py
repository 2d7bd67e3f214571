"""Contents of an archive beside the tables of its provenance: sources, results and captions."""

from __future__ import annotations

import os
import re
from collections.abc import Iterator
from pathlib import Path

from gaspart.errors import SceneError
from gaspart.reproduction.archive.finished import Finished
from gaspart.reproduction.archive.limits import name_fault
from gaspart.reproduction.archive.scenes import scene_files
from gaspart.reproduction.claims import table
from gaspart.reproduction.claims.captions import filled
from gaspart.reproduction.families.registry import caption

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
"""Folders of sources, and what they are."""
_OF_PACKAGE = Path(__file__).parents[4]
"""The project, where gaspart runs from a checkout of it."""


def sources(run: Finished) -> Iterator[str]:
    """The files of the project with which the run can be made again: the workflow, its config and scenes, the
    library, the locked environment. A workflow that uses this one as a module has what it has of these, and
    CITATION.cff. Raises SceneError if one that is needed is missing."""
    needed = (run.workflow, CITATION, *(_NEEDED if run.is_copy else ()))
    for name in needed:
        if not (run.root / name).is_file():
            raise SceneError("folder", str(run.root), f"has no {name}, which an archive needs")
        yield name
    yield from (
        name for name in (*_NEEDED, *_IF_PRESENT) if name not in needed and (run.root / name).is_file()
    )
    for folder in folders(run):
        yield from _files(run.root, folder)
    yield from run.configs
    for name in scene_files(run.config):
        if name_fault(name):
            raise SceneError("scene", name, "must be in the project's folder for an archive")
        yield name


def folders(run: Finished) -> list[str]:
    """The folders of sources that the project has."""
    return [folder for folder in FOLDERS if (run.root / folder).is_dir()]


def _files(root: Path, folder: str) -> Iterator[str]:
    """The files in a folder and below, without hidden ones and what Python and pip leave there."""
    for place, folders, names in os.walk(root / folder):
        folders[:] = sorted(name for name in folders if name != "__pycache__" and _is_kept(name))
        for name in sorted(filter(_is_kept, names)):
            path = Path(place, name)
            if path.is_file() and not path.is_symlink():
                yield str(path.relative_to(root))


def _is_kept(name: str) -> bool:
    return not name.startswith(".") and not name.endswith((".egg-info", ".pyc"))


def report(run: Finished) -> str:
    """The report without its pictures for narrow screens, which are not in the archive."""
    page = (run.root / run.report).read_text(encoding="utf-8")
    return re.sub(r'<source\b[^>]*\bsrcset="figures/journal/[^>]*>', "", page)


def captions(run: Finished) -> dict[str, str]:
    """{path in the archive: caption} of each figure, with its measured numbers."""
    rows = table.read(run.root / run.results / "tables/claims.csv")
    texts = {figure: _caption(run, figure) for figure in run.figures}
    return {
        f"{run.results}/captions/{figure}.rst": filled(text, [row for row in rows if row["figure"] == figure])
        for figure, text in texts.items()
        if text is not None
    }


def _caption(run: Finished, figure: str) -> str | None:
    """The caption of a figure, with places for its measured numbers; None where only the report has it: that
    of a module, whose files are elsewhere."""
    block = run.config["figures"][figure]
    if "kind" in block:
        return caption(block)
    for root in (run.root, _OF_PACKAGE):
        if (path := root / f"workflow/report/{figure}.rst").is_file():
            return path.read_text(encoding="utf-8")
    return None
