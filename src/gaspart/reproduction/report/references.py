"""The numbered references of the page: where a text cites one of them, its number follows as a link.

A text cites by authors and year, as in "Haff 1983", "Yeh & Hummer, J. Phys. Chem. B 108, 15873 (2004)" or
"Fernandez and others 2012".
"""

from __future__ import annotations

import html
import re
import unicodedata
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

from gaspart.yaml_text import read_yaml

_JOIN = r"(?:,|,?\s+and|\s+(?:&amp;|&))\s+"
_UP_TO_YEAR = r"[^;<>]{0,60}?\b"
_OTHERS = r"(?:\s+and\s+others|\s+et\s+al\.|,\s[^;()<>]{0,60}?)"


@dataclass(frozen=True)
class Reference:
    """number: from 1; authors: surnames, the last perhaps "others"; where: journal, volume, page, or a title;
    doi: "" if there is none; called: another name under which texts cite it, such as "source A"."""

    number: int
    authors: tuple[str, ...]
    year: int
    where: str
    doi: str = ""
    called: str = ""

    @property
    def text(self) -> str:
        """As the list of references has it, without the DOI."""
        *first, last = self.authors
        names = f"{', '.join(first)} and {last}" if first else last
        return f"{names}, {self.where} ({self.year})" + (f": {self.called}" if self.called else "")

    @cached_property
    def pattern(self) -> re.Pattern[str]:
        """Matches a citation in HTML."""
        names = [_spelt(name) for name in self.authors if name != "others"]
        others = _OTHERS if "others" in self.authors else ""
        found = rf"\b{_JOIN.join(names)}{others}{_UP_TO_YEAR}{self.year}\)?"
        return re.compile(rf"{found}|\b(?i:{re.escape(self.called)})\b" if self.called else found)


def _spelt(name: str) -> str:
    """A pattern of a name with and without its accents, and over the end of a line."""
    plain = "".join(unicodedata.normalize("NFD", letter)[0] for letter in name)
    letters = (a if a == b else f"[{a}{b}]" for a, b in zip(name, plain, strict=True))
    return r"\s+".join("".join(letters).split())


def read_references(path: str | Path) -> list[Reference]:
    """The references of a file, numbered in its order. Raises SceneError if it is not YAML."""
    entries = read_yaml(path)
    return [
        Reference(**{**entry, "number": number, "authors": tuple(entry["authors"])})
        for number, entry in enumerate(entries, 1)
    ]


def linked(text: str, references: Sequence[Reference]) -> str:
    """HTML in which the first citation of each reference is followed by its number, a link into the list."""
    places = []
    for reference in references:
        found = reference.pattern.search(text)
        if found:
            places.append((found.end(), reference))
    for end, one in sorted(places, key=lambda place: place[0], reverse=True):
        link = f'<a href="#reference-{one.number}" title="{html.escape(one.text)}">[{one.number}]</a>'
        text = f"{text[:end]}\N{NO-BREAK SPACE}{link}{text[end:]}"
    return text
