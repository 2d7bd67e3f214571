"""What goes into an archive beside the tables of its provenance: sources, results and captions."""

from __future__ import annotations

import os
import re
from collections.abc import Iterator
from pathlib import Path

from gaspart.errors import SceneError
from gaspart.reproduction.archive.finished import Finished
from gaspart.reproduction.claims import table
from gaspart.reproduction.claims.captions import filled
from gaspart.reproduction.families.registry import caption

WORKFLOW = "Snakefile"
CITATION = "CITATION.cff"
LOCKED = "environment.txt"
README = "README.md"
_NEEDED = (WORKFLOW, CITATION, LOCKED, README, "LICENSE", "pyproject.toml")
_IF_PRESENT = ("Makefile", "CHANGELOG.md", "Containerfile")
FOLDERS = ("config", "workflow", "profiles", "src")
"""Folders of sources, with what they are in FOLDER_TITLES."""
FOLDER_TITLES = {
    "config": "configs and scenes",
    "workflow": "rules, scripts and captions of the workflow",
    "profiles": "Snakemake's settings for one machine and for a cluster",
    "src": "the library",
}


def sources(run: Finished) -> Iterator[str]:
    """The files of the project with which the run can be made again: the workflow, the library, the locked
    environment. Raises SceneError if one of them is missing."""
    for name in _NEEDED:
        if not (run.root / name).is_file():
            raise SceneError("folder", str(run.root), f"has no {name}, which an archive needs")
        yield name
    yield from (name for name in _IF_PRESENT if (run.root / name).is_file())
    for folder in FOLDERS:
        yield from _files(run.root, folder)


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
    return {
        f"{run.results}/captions/{figure}.rst": filled(
            _caption(run, figure), [row for row in rows if row["figure"] == figure]
        )
        for figure in run.figures
    }


def _caption(run: Finished, figure: str) -> str:
    """The caption of a figure, with places for its measured numbers."""
    block = run.config["figures"][figure]
    if "kind" in block:
        return caption(block)
    return (run.root / f"workflow/report/{figure}.rst").read_text(encoding="utf-8")
