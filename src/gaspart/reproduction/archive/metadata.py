"""`ro-crate-metadata.json`: a run of the workflow by the profile Workflow Run Crate 0.5 (RO-Crate 1.1).

https://www.researchobject.org/workflow-run-crate/profiles/workflow_run_crate/
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass
from datetime import datetime, timedelta
from pathlib import Path, PurePosixPath
from typing import TYPE_CHECKING, Any, NamedTuple

from gaspart.errors import SceneError, optional
from gaspart.reproduction.archive import contents, tables
from gaspart.yaml_text import read_yaml

if TYPE_CHECKING:
    from collections.abc import Sequence

    from rocrate.model.contextentity import ContextEntity
    from rocrate.rocrate import ROCrate


# Title, creators and licence of an archive, from the project's CITATION.cff.


_REQUIRED = ("title", "authors", "license", "version")
_IDENTITIES = ("orcid", "website")


class Creator(NamedTuple):
    """Person or organisation; `identity` is an ORCID or another address, or ""."""

    name: str
    is_person: bool
    identity: str
    affiliation: str


class Citation(NamedTuple):
    """Data of CITATION.cff.

    licence : its identifier at spdx.org, such as BSD-3-Clause.
    url : address of the project, or "".
    """

    title: str
    creators: list[Creator]
    licence: str
    version: str
    keywords: list[str]
    url: str


def read_citation(path: Path) -> Citation:
    """Read a CITATION.cff, version 1.2.0.

    Raises SceneError for a file that cannot be read or lacks a key that an archive needs.
    """
    content = read_yaml(path)
    for key in _REQUIRED:
        if not (isinstance(content, dict) and content.get(key)):
            raise SceneError(key, None, "is required for an archive", str(path))
    if not isinstance(content["authors"], list):
        raise SceneError("authors", content["authors"], "must be a list", str(path))
    creators = [_creator(author, f"authors[{n}]", path) for n, author in enumerate(content["authors"])]
    licence = content["license"]
    return Citation(
        str(content["title"]),
        creators,
        str(licence[0] if isinstance(licence, list) else licence),
        str(content["version"]),
        [str(keyword) for keyword in content.get("keywords", [])],
        str(content.get("repository-code") or content.get("url") or ""),
    )


def _creator(author: Any, where: str, path: Path) -> Creator:
    """Read an author: an entity has a `name`, a person `given-names` and `family-names`."""
    fields = author if isinstance(author, dict) else {}
    identity = next((str(fields[key]) for key in _IDENTITIES if fields.get(key)), "")
    affiliation = str(fields.get("affiliation", ""))
    if fields.get("name"):
        return Creator(str(fields["name"]), False, identity, affiliation)
    parts = [str(fields[key]) for key in ("given-names", "name-particle", "family-names") if fields.get(key)]
    if not parts:
        raise SceneError(where, author, "must have a name, or given-names and family-names", str(path))
    return Creator(" ".join(parts), True, identity, affiliation)


METADATA = "ro-crate-metadata.json"
_PROFILES = {
    "https://w3id.org/ro/wfrun/process/0.5": ("Process Run Crate", "0.5"),
    "https://w3id.org/ro/wfrun/workflow/0.5": ("Workflow Run Crate", "0.5"),
    "https://w3id.org/workflowhub/workflow-ro-crate/1.0": ("Workflow RO-Crate", "1.0"),
}
_TERMS = "https://w3id.org/ro/terms/workflow-run/context"
"""The context that defines `sha256`."""
_COMPUTATIONAL = "https://bioschemas.org/profiles/ComputationalWorkflow/1.0-RELEASE"
_PARAMETER = "https://bioschemas.org/profiles/FormalParameter/1.0-RELEASE"
_ENCODINGS = {  # of other files: text/plain
    ".cff": "application/yaml",
    ".csv": "text/csv",
    ".html": "text/html",
    ".jpg": "image/jpeg",
    ".json": "application/json",
    ".md": "text/markdown",
    ".mp4": "video/mp4",
    ".nc": "application/x-netcdf",
    ".pdf": "application/pdf",
    ".png": "image/png",
    ".rst": "text/x-rst",
    ".svg": "image/svg+xml",
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
    """Sources of the metadata.

    files : (size, digest) of each file of the archive, by path.
    summary : content of `run.json`.
    jobs : rows of `jobs.csv`.
    captions : captions by path.
    claims : number of claims.
    workflow : path of the Snakefile.
    folders : folders of sources.
    """

    files: Mapping[str, tuple[int, str]]
    summary: Mapping[str, Any]
    jobs: Sequence[tables.JobTime]
    captions: Mapping[str, str]
    claims: int
    workflow: str
    folders: Sequence[str]


def metadata(described: Described, citation: Citation) -> str:
    """Return the text of the file; raise SceneError if the package rocrate is missing."""
    rocrate = optional("rocrate.rocrate", "archive", "archives")
    crate = rocrate.ROCrate(version="1.1")
    crate.metadata.extra_contexts.append(_TERMS)
    creators = _add_creators(crate, citation)
    _describe_root(crate, described, citation, creators)
    listed = [path for path in described.files if _is_listed(path) and path != described.workflow]
    files = {path: _add_file(crate, path, described) for path in listed}
    folders = [_add_folder(crate, folder) for folder in described.folders]
    workflow = _add_workflow(crate, described, citation, creators)
    results = [file for path, file in files.items() if path.startswith(f"{described.summary['results']}/")]
    used = [files[path] for path in (tables.CONFIG, contents.LOCKED) if path in files] + folders
    _add_parameters(crate, workflow, described, files)
    _add_run(crate, workflow, described, creators, (used, results))
    return json.dumps(crate.metadata.generate(), indent=1, ensure_ascii=False) + "\n"


def _is_listed(path: str) -> bool:
    """Return True if a file is described by itself.

    Files in folders of sources are described by their folder.
    """
    return path.partition("/")[0] not in contents.FOLDERS


def _entity(crate: ROCrate, identity: str, **properties: Any) -> ContextEntity:
    """Add a contextual entity; `type` stands for @type."""
    from rocrate.model.contextentity import ContextEntity

    kind = properties.pop("type")
    return crate.add(ContextEntity(crate, identity, properties={"@type": kind, **properties}))


def _single(entities: list[Any]) -> Any:
    """Return one entity by itself, as RO-Crate recommends, or several as a list."""
    return entities[0] if len(entities) == 1 else entities


def _add_creators(crate: ROCrate, citation: Citation) -> list[ContextEntity]:
    added = []
    for n, creator in enumerate(citation.creators, 1):
        more = {"affiliation": creator.affiliation} if creator.affiliation else {}
        kind = "Person" if creator.is_person else "Organization"
        added.append(
            _entity(crate, creator.identity or f"#creator-{n}", type=kind, name=creator.name, **more)
        )
    return added


def _describe_root(
    crate: ROCrate, described: Described, citation: Citation, creators: list[ContextEntity]
) -> None:
    """Add title, creators, licence and profiles of the archive."""
    summary = described.summary
    crate.name = f"{citation.title}: {summary['title']}"
    crate.description = (
        f"A run of gaspart's workflow: {summary['figures']} figures, {described.claims} claims with their "
        "verdicts, and the data that they are made of. `gaspart verify` recomputes the digests, and "
        "simulates points again."
    )
    crate.datePublished = datetime.fromisoformat(summary["archived"])
    crate.creator, crate.keywords = _single(creators), citation.keywords
    crate.root_dataset["author"] = _single(creators)
    licence = f"https://spdx.org/licenses/{citation.licence}"
    crate.license = _entity(crate, licence, type="CreativeWork", name=citation.licence, url=licence)
    crate.root_dataset["conformsTo"] = [
        _entity(crate, address, type="CreativeWork", name=name, version=version)
        for address, (name, version) in _PROFILES.items()
    ]


def _add_file(crate: ROCrate, path: str, described: Described) -> Any:
    size, digest = described.files[path]
    file_path = PurePosixPath(path)
    properties = {"name": file_path.name, "contentSize": str(size), "sha256": digest}
    properties["encodingFormat"] = _ENCODINGS.get(file_path.suffix, "text/plain")
    caption = f"{described.summary['results']}/captions/{file_path.stem}.rst"
    if path in _MEANINGS:
        properties["description"] = _MEANINGS[path]
    elif "figures" in file_path.parts and caption in described.captions:
        properties["description"] = described.captions[caption]
    file = crate.add_file(dest_path=path, properties=properties)
    if path == contents.README:
        file["about"] = crate.root_dataset
    return file


def _add_folder(crate: ROCrate, folder: str) -> Any:
    properties = {"name": folder, "description": contents.FOLDERS[folder]}
    return crate.add_dataset(dest_path=f"{folder}/", properties=properties)


def _add_workflow(
    crate: ROCrate, described: Described, citation: Citation, creators: list[ContextEntity]
) -> Any:
    """Add the main entity, the Snakefile, and return it."""
    size, digest = described.files[described.workflow]
    workflow = crate.add_workflow(
        dest_path=described.workflow,
        main=True,
        lang="snakemake",
        lang_version=described.summary["machine"]["packages"].get("snakemake"),
    )
    workflow["name"], workflow["version"] = citation.title, _version(described)
    workflow["contentSize"], workflow["sha256"] = str(size), digest
    workflow["encodingFormat"] = "text/plain"
    if citation.url:
        workflow["url"] = citation.url
    workflow["creator"], workflow["license"] = _single(creators), crate.license
    workflow["conformsTo"] = _entity(
        crate, _COMPUTATIONAL, type="CreativeWork", name="ComputationalWorkflow", version="1.0-RELEASE"
    )
    return workflow


def _version(described: Described) -> str:
    """Return the version of gaspart, with the git revision that was run."""
    summary = described.summary
    return f"{summary['gaspart']} ({summary['revision']})" if summary["revision"] else summary["gaspart"]


def _add_parameters(crate: ROCrate, workflow: Any, described: Described, files: Mapping[str, Any]) -> None:
    """Add input and output of the workflow, with their files in this run."""
    results = described.summary["results"]
    profile = _entity(crate, _PARAMETER, type="CreativeWork", name="FormalParameter", version="1.0-RELEASE")
    named = {
        "input": {"config": tables.CONFIG},
        "output": {"claims": f"{results}/tables/claims.csv", "report": f"{results}/report.html"},
    }
    for role, parameters in named.items():
        added = []
        for name, path in parameters.items():
            parameter = _entity(crate, f"#{name}", type="FormalParameter", additionalType="File", name=name)
            parameter["conformsTo"], parameter["workExample"] = profile, files[path]
            files[path]["exampleOfWork"] = parameter
            added.append(parameter)
        workflow[role] = _single(added)


def _add_run(
    crate: ROCrate,
    workflow: Any,
    described: Described,
    creators: list[ContextEntity],
    files: tuple[list[Any], list[Any]],
) -> None:
    """Add the run, from its first job to the end of its last.

    `files` are the files that it used, and the files that it made.
    """
    ends = [
        (datetime.fromisoformat(job.ended), timedelta(seconds=float(job.seconds))) for job in described.jobs
    ]
    machine = described.summary["machine"]
    run = _entity(
        crate,
        "#run",
        type="CreateAction",
        name=f"Run of the workflow: {described.summary['title']}",
        description=f"{len(described.jobs)} jobs; archived on {machine['processor']}, "
        f"{machine['processors']} processors, {machine['system']}",
        startTime=min(end - took for end, took in ends).isoformat(timespec="milliseconds"),
        endTime=max(end for end, _ in ends).isoformat(timespec="milliseconds"),
    )
    run["instrument"], run["agent"] = workflow, _single(creators)
    run["object"], run["result"] = files
    crate.root_dataset["mentions"] = run
