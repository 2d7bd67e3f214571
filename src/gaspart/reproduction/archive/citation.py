"""Title, creators and licence of an archive, from the project's CITATION.cff."""

from __future__ import annotations

from pathlib import Path
from typing import Any, NamedTuple

from gaspart.errors import SceneError
from gaspart.yaml_text import read_yaml

_REQUIRED = ("title", "authors", "license", "version")
_IDENTITIES = ("orcid", "website")


class Creator(NamedTuple):
    """A person or an organisation. identity: an ORCID or another address; "" if there is none."""

    name: str
    is_person: bool
    identity: str
    affiliation: str


class Citation(NamedTuple):
    """Data of CITATION.cff. licence: its identifier at spdx.org, such as BSD-3-Clause; url: of the
    project, "" if there is none."""

    title: str
    creators: list[Creator]
    licence: str
    version: str
    keywords: list[str]
    url: str


def read_citation(path: Path) -> Citation:
    """Read a CITATION.cff, version 1.2.0. Raises SceneError for a file that cannot be read or lacks a key
    that an archive needs."""
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
        [str(word) for word in content.get("keywords", [])],
        str(content.get("repository-code") or content.get("url") or ""),
    )


def _creator(author: Any, where: str, path: Path) -> Creator:
    """An author: an entity has a `name`, a person `given-names` and `family-names`."""
    known = author if isinstance(author, dict) else {}
    identity = next((str(known[key]) for key in _IDENTITIES if known.get(key)), "")
    affiliation = str(known.get("affiliation", ""))
    if known.get("name"):
        return Creator(str(known["name"]), False, identity, affiliation)
    parts = [str(known[key]) for key in ("given-names", "name-particle", "family-names") if known.get(key)]
    if not parts:
        raise SceneError(where, author, "must have a name, or given-names and family-names", str(path))
    return Creator(" ".join(parts), True, identity, affiliation)
