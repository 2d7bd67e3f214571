"""Functions that write the archive of a finished run."""

from __future__ import annotations

import csv
import io
import json
import stat
import zipfile
from pathlib import Path
from typing import IO

from gaspart.errors import SceneError, optional
from gaspart.files import FileKind, output_path, writing
from gaspart.reproduction.archive import contents, tables
from gaspart.reproduction.archive.contents import Finished, find_finished
from gaspart.reproduction.archive.digests import digest
from gaspart.reproduction.archive.metadata import METADATA, Described, metadata, read_citation
from gaspart.yaml_text import dump_yaml

MANIFEST = "manifest-sha256.txt"
"""File with the digests of all other files of an archive, in the format of the program `sha256sum`."""
_TIME = (1980, 1, 1, 0, 0, 0)
"""Time stamp of all files. It is constant, so that the digest of an archive depends on its contents only."""
_LARGE = 1 << 31


def _is_archive(path: Path) -> bool:
    try:
        with zipfile.ZipFile(path) as file:
            return MANIFEST in file.namelist()
    except (zipfile.BadZipFile, RuntimeError, ValueError):
        return False


ARCHIVE = FileKind("an archive of a run", _is_archive)


def write_archive(
    results: str | Path,
    path: str | Path,
    config: str | Path | None = None,
    trajectories: bool = False,
    overwrite: bool = False,
) -> str:
    """Write the archive of a finished run, and return a line that describes its contents. The arguments are
    those of `find_finished`; with `trajectories`, they are included. Raises SceneError like `find_finished`,
    if a file or the package rocrate is missing, or if the path cannot be written.
    """
    optional("rocrate.rocrate", "archive", "archives")  # fails before the work starts
    if output_path(path).suffix != ".zip":
        raise SceneError("path", str(path), "must end in .zip")
    with writing(path, ARCHIVE, overwrite) as partial:
        run = find_finished(results, config)
        with zipfile.ZipFile(partial, "w", zipfile.ZIP_DEFLATED) as file:
            try:
                line = _Writer(file).write(run, trajectories)
            except (ValueError, LookupError, StopIteration, AttributeError, csv.Error) as error:
                if isinstance(error, SceneError):
                    raise
                rule = f"has a table or measurement that cannot be read: {error}"
                raise SceneError("results", str(results), rule) from None
    return f"{path}: {line}, {Path(path).stat().st_size / 1e6:.1f} MB"


class _Writer:
    """An archive during writing, with the size and digest of each file in it."""

    def __init__(self, file: zipfile.ZipFile) -> None:
        self._file = file
        self._files: dict[str, tuple[int, str]] = {}

    def write(self, run: Finished, trajectories: bool) -> str:
        """Write all contents, and return a description of them."""
        # folders have entries of their own, because the metadata describe them
        for folder in contents.folders(run):
            self._file.writestr(zipfile.ZipInfo(f"{folder}/", _TIME), b"")
        for name in [*contents.sources(run), *run.outputs()]:
            self._add_file(name, run.root / name)
        self._add_text(run.report, contents.report(run))
        captions = contents.captions(run)
        for name, text in captions.items():
            self._add_text(name, text)
        if trajectories:
            for _, name in run.trajectories():
                self._add_file(name, run.root / name)
        files, jobs = tables.point_files(run), tables.job_times(run)
        claims = tables.claim_rows(run, files)
        summary = tables.summary_of(run, files, trajectories)
        self._add_text(tables.POINTS, tables.text_of(files, tables.PointFile._fields))
        self._add_text(tables.CLAIMS, tables.text_of(claims, tables.ClaimData._fields))
        self._add_text(tables.JOBS, tables.text_of(jobs, tables.JobTime._fields))
        self._add_text(tables.CONFIG, dump_yaml(run.config))
        self._add_text(tables.RUN, json.dumps(summary, indent=1, ensure_ascii=False) + "\n")
        described = Described(run, dict(self._files), summary, jobs, captions, len(claims))
        self._add_text(METADATA, metadata(described, read_citation(run.root / contents.CITATION)))
        lines = [f"{value}  {name}\n" for name, (_, value) in sorted(self._files.items())]
        self._add_text(MANIFEST, "".join(lines))
        count = sum(1 for _ in run.trajectories())
        included = "with" if trajectories else "with the digests of"
        return f"{len(run.figures)} figures, {len(claims)} claims, {included} {count} trajectories"

    def _add_file(self, name: str, path: Path) -> None:
        status = path.stat()
        with path.open("rb") as source:
            self._add(name, source, status.st_size, stat.S_IMODE(status.st_mode))

    def _add_text(self, name: str, text: str) -> None:
        data = text.encode()
        self._add(name, io.BytesIO(data), len(data), 0o644)

    def _add(self, name: str, source: IO[bytes], size: int, mode: int) -> None:
        if name in self._files:
            return
        entry = zipfile.ZipInfo(name, _TIME)
        entry.compress_type, entry.external_attr = zipfile.ZIP_DEFLATED, (stat.S_IFREG | mode) << 16
        with self._file.open(entry, "w", force_zip64=size > _LARGE) as target:
            self._files[name] = (size, digest(source, target))
