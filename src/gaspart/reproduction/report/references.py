"""The numbered references of the page, and the citations of them.

A text cites a reference by its key in square brackets: "the law of [Haff 1983]", "figure 4 of [source A]".
"""

from __future__ import annotations

import html
import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from pathlib import Path

from gaspart.yaml_text import read_yaml

CITATION = re.compile(r"\[([^][<>]+)\]")


@dataclass(frozen=True)
class Reference:
    """number: from 1; key: by which texts cite it; authors: surnames, the last perhaps "others"; where:
    journal, volume, page, or a title; doi: "" if there is none."""

    number: int
    key: str
    authors: tuple[str, ...]
    year: int
    where: str
    doi: str = ""

    @property
    def is_source(self) -> bool:
        """Whether its key is a name, such as "source A", instead of an author and a year."""
        return str(self.year) not in self.key

    @property
    def text(self) -> str:
        """As the list of references has it, without the DOI."""
        *first, last = self.authors
        names = f"{', '.join(first)} and {last}" if first else last
        return f"{names}, {self.where} ({self.year})" + (f": {self.key}" if self.is_source else "")

    @property
    def short(self) -> str:
        """As a text cites it: by one or two authors and the year."""
        names = self.authors if len(self.authors) < 3 else (self.authors[0], "others")
        return f"{' and '.join(names)} {self.year}"


def read_references(path: str | Path) -> dict[str, Reference]:
    """The references of a file by key, numbered in its order. Raises SceneError if it is not YAML."""
    return {
        key: Reference(**{**entry, "number": number, "key": key, "authors": tuple(entry["authors"])})
        for number, (key, entry) in enumerate(read_yaml(path).items(), 1)
    }


def cited(citation: re.Match[str], references: Mapping[str, Reference]) -> Reference | None:
    """The reference that a match of `CITATION` cites; None for other texts in square brackets."""
    key = " ".join(citation[1].split())
    return references.get(key) or references.get(key[0].lower() + key[1:])


def used(texts: Iterable[str], references: Mapping[str, Reference]) -> dict[str, Reference]:
    """The references that some texts cite, by key and in the same order, numbered from 1."""
    found = (cited(citation, references) for text in texts for citation in CITATION.finditer(text))
    keys = {reference.key for reference in found if reference is not None}
    kept = (reference for key, reference in references.items() if key in keys)
    return {one.key: replace(one, number=number) for number, one in enumerate(kept, 1)}


def linked(text: str, references: Mapping[str, Reference]) -> str:
    """HTML in which each citation has become names and a numbered link into the list."""

    def link(citation: re.Match[str]) -> str:
        reference = cited(citation, references)
        if reference is None:
            return citation[0]
        name = citation[1] if reference.is_source else html.escape(reference.short)
        title = html.escape(reference.text)
        anchor = f'<a href="#reference-{reference.number}" title="{title}">[{reference.number}]</a>'
        return f"{name}\N{NO-BREAK SPACE}{anchor}"

    return CITATION.sub(link, text)
