"""`ro-crate-metadata.json`: a run of the workflow by the profile Workflow Run Crate 0.5 (RO-Crate 1.1).

https://www.researchobject.org/workflow-run-crate/profiles/workflow_run_crate/
"""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from datetime import datetime, timedelta
from mimetypes import MimeTypes
from pathlib import Path, PurePosixPath
from typing import Any, NamedTuple

from gaspart.errors import SceneError, optional
from gaspart.reproduction.archive import contents, tables
from gaspart.yaml_text import read_yaml


class Citation(NamedTuple):
    """Title, creators (entities of the metadata), licence at spdx.org, and address of a project, or ""."""

    title: str
    creators: list[dict[str, str]]
    licence: str
    keywords: list[str]
    url: str


def read_citation(path: Path) -> Citation:
    """Read a CITATION.cff, version 1.2.0; raise SceneError without a key that an archive needs."""
    content = read_yaml(path)
    for key in ("title", "authors", "license"):
        if not (isinstance(content, dict) and content.get(key)):
            raise SceneError(key, None, "is required for an archive", str(path))
    authors, licence = content["authors"], content["license"]
    if not (isinstance(authors, list) and all(isinstance(author, dict) for author in authors)):
        raise SceneError("authors", authors, "must be a list of persons and organisations", str(path))
    creators = []
    for n, author in enumerate(authors):
        parts = [author.get(key) for key in ("given-names", "name-particle", "family-names")]
        creator = {
            "@id": author.get("orcid") or author.get("website") or f"#creator-{n + 1}",
            "@type": "Organization" if author.get("name") else "Person",
            "name": author.get("name") or " ".join(str(part) for part in parts if part),
            "affiliation": author.get("affiliation"),
        }
        creators.append({key: str(value) for key, value in creator.items() if value})
    return Citation(
        str(content["title"]),
        creators,
        str(licence[0] if isinstance(licence, list) else licence),
        [str(keyword) for keyword in content.get("keywords", [])],
        str(content.get("repository-code") or content.get("url") or ""),
    )


METADATA = "ro-crate-metadata.json"
_PROFILES = {
    "https://w3id.org/ro/wfrun/process/0.5": ("Process Run Crate", "0.5"),
    "https://w3id.org/ro/wfrun/workflow/0.5": ("Workflow Run Crate", "0.5"),
    "https://w3id.org/workflowhub/workflow-ro-crate/1.0": ("Workflow RO-Crate", "1.0"),
}
_TERMS = "https://w3id.org/ro/terms/workflow-run/context"
"""Context of JSON-LD that defines `sha256`."""
_BIOSCHEMAS = "https://bioschemas.org/profiles/{}/1.0-RELEASE"
_ENCODINGS = MimeTypes().types_map[True] | {  # all other files are text/plain
    ".cff": "application/yaml",
    ".md": "text/markdown",
    ".rst": "text/x-rst",
    ".toml": "application/toml",
    ".yaml": "application/yaml",
}
_MEANINGS = {
    tables.CONFIG: "the config of this run, merged: what was simulated, measured and drawn",
    tables.POINTS: "the files of all points with the digests of each",
    tables.CLAIMS: "the claims with the digests of the data that each is made of",
    tables.JOBS: "time and memory of each job",
    tables.RUN: "versions, git revisions and the machine",
    contents.LOCKED: "the locked environment",
}


@dataclass(frozen=True)
class Described:
    """Sources of the metadata."""

    run: contents.Finished
    files: Mapping[str, tuple[int, str]]  # size and digest by path
    summary: Mapping[str, Any]  # `run.json`
    jobs: Sequence[tables.JobTime]
    captions: Mapping[str, str]  # by path
    claims: int


def metadata(described: Described, citation: Citation) -> str:
    """Return the text of `ro-crate-metadata.json`."""
    crate = optional("rocrate.rocrate", "archive", "archives").ROCrate(version="1.1")
    crate.metadata.extra_contexts.append(_TERMS)
    creators = _single([crate.add_jsonld(dict(creator)) for creator in citation.creators])
    _describe_root(crate, described, citation, creators)
    files = {
        path: _add_file(crate, path, described)
        for path in described.files
        if path != described.run.workflow and path.partition("/")[0] not in contents.FOLDERS
    }  # folders of sources are described as a whole, not file by file
    folders = [
        crate.add_dataset(
            dest_path=f"{name}/", properties={"name": name, "description": contents.FOLDERS[name]}
        )
        for name in contents.folders(described.run)
    ]
    workflow = _add_workflow(crate, described, citation, files)
    workflow["creator"] = creators
    run = _add_run(crate, workflow, described)
    run["agent"] = creators
    run["object"] = [files[path] for path in (tables.CONFIG, contents.LOCKED) if path in files] + folders
    run["result"] = [file for path, file in files.items() if path.startswith(f"{described.run.results}/")]
    return json.dumps(crate.metadata.generate(), indent=1, ensure_ascii=False) + "\n"


def _add_work(crate: Any, identity: str, name: str, **properties: str) -> Any:
    """Add a creative work, such as a profile, to which other entities refer."""
    return crate.add_jsonld({"@id": identity, "@type": "CreativeWork", "name": name, **properties})


def _single(entities: list[Any]) -> Any:
    """Return a single entity without a list, as RO-Crate recommends, or several as a list."""
    return entities[0] if len(entities) == 1 else entities


def _describe_root(crate: Any, described: Described, citation: Citation, creators: Any) -> None:
    """Add title, creators, licence and profiles of the archive."""
    summary = described.summary
    crate.name = f"{citation.title}: {summary['title']}"
    crate.description = (
        f"A run of gaspart's workflow: {summary['figures']} figures, {described.claims} claims with their "
        "verdicts, and the data that they are made of. `gaspart verify` recomputes the digests, and "
        "simulates points again."
    )
    crate.datePublished = datetime.fromisoformat(summary["archived"])
    crate.creator, crate.root_dataset["author"] = creators, creators
    crate.keywords = citation.keywords
    licence = f"https://spdx.org/licenses/{citation.licence}"
    crate.license = _add_work(crate, licence, citation.licence, url=licence)
    crate.root_dataset["conformsTo"] = [
        _add_work(crate, address, name, version=version) for address, (name, version) in _PROFILES.items()
    ]


def _sizes(described: Described, path: str) -> dict[str, str]:
    """Return the entries size, digest and encoding of a file."""
    size, digest = described.files[path]
    encoding = _ENCODINGS.get(PurePosixPath(path).suffix, "text/plain")
    return {"contentSize": str(size), "sha256": digest, "encodingFormat": encoding}


def _add_file(crate: Any, path: str, described: Described) -> Any:
    file_path = PurePosixPath(path)
    properties = {"name": file_path.name, **_sizes(described, path)}
    caption = f"{described.run.results}/captions/{file_path.stem}.rst"
    if path in _MEANINGS:
        properties["description"] = _MEANINGS[path]
    elif "figures" in file_path.parts and caption in described.captions:
        properties["description"] = described.captions[caption]
    file = crate.add_file(dest_path=path, properties=properties)
    if path == contents.README:
        file["about"] = crate.root_dataset
    return file


def _add_workflow(crate: Any, described: Described, citation: Citation, files: Mapping[str, Any]) -> Any:
    """Add the Snakefile as main entity, with its input and output in this run."""
    summary, results, path = described.summary, described.run.results, described.run.workflow
    version = f"{summary['gaspart']} ({summary['revision']})" if summary["revision"] else summary["gaspart"]
    properties = {"name": citation.title, "version": version, **_sizes(described, path)}
    workflow = crate.add_workflow(
        dest_path=path,
        main=True,
        lang="snakemake",
        lang_version=summary["machine"]["packages"].get("snakemake"),
        properties=properties | ({"url": citation.url} if citation.url else {}),
    )
    workflow["license"] = crate.license
    kinds = "ComputationalWorkflow", "FormalParameter"
    workflow["conformsTo"], _ = (
        _add_work(crate, _BIOSCHEMAS.format(kind), kind, version="1.0-RELEASE") for kind in kinds
    )
    roles = {
        "input": {"config": tables.CONFIG},
        "output": {"claims": f"{results}/tables/claims.csv", "report": f"{results}/report.html"},
    }
    for role, parameters in roles.items():
        added = []
        for name, file in parameters.items():
            parameter = crate.add_formal_parameter(name, "File", f"#{name}", valueRequired=role == "input")
            parameter["workExample"], files[file]["exampleOfWork"] = files[file], parameter
            added.append(parameter)
        workflow[role] = _single(added)
    return workflow


def _add_run(crate: Any, workflow: Any, described: Described) -> Any:
    """Add the run, which begins when its first job ended, less the CPU time of this job."""
    jobs = sorted((datetime.fromisoformat(job.ended), float(job.cpu_seconds)) for job in described.jobs)
    archived = datetime.fromisoformat(described.summary["archived"])
    first, seconds = jobs[0] if jobs else (archived, 0.0)  # no jobs if the logs were deleted
    machine = described.summary["machine"]
    properties = {
        "name": f"Run of the workflow: {described.summary['title']}",
        "description": f"{len(described.jobs)} jobs; archived on {machine['processor']}, "
        f"{machine['processors']} processors, {machine['system']}",
        "startTime": (first - timedelta(seconds=seconds)).isoformat(timespec="milliseconds"),
        "endTime": (jobs[-1][0] if jobs else archived).isoformat(timespec="milliseconds"),
    }
    run = crate.root_dataset["mentions"] = crate.add_action(workflow, "#run", properties=properties)
    return run
