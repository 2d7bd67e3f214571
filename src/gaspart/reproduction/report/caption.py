"""The parts of a caption: its finding, how to read the figure, and what is folded below.

A caption is reStructuredText. Its first words, in bold, are the finding. The rest of that paragraph and the
paragraph that begins with *What is seen.* state how to read the figure.
"""

from __future__ import annotations

import re
from dataclasses import dataclass

_FINDING = re.compile(r"\*\*(.+?)\*\*\s*", re.DOTALL)
_SEEN = "*What is seen.*"


@dataclass(frozen=True)
class Caption:
    """finding: inline HTML; plain: the same without marks, for places that hold text only; reading, details:
    HTML, the latter perhaps empty."""

    finding: str
    plain: str
    reading: str
    details: str


def divided(text: str) -> Caption:
    """The parts of a caption.

    Raises ValueError if it does not begin with words in bold.
    """
    paragraphs = re.split(r"\n\s*\n", text.strip())
    finding = _FINDING.match(paragraphs[0])
    if not finding:
        raise ValueError("a caption begins with its finding, in bold")
    opening = paragraphs[0][finding.end() :]
    seen = [paragraph for paragraph in paragraphs[1:] if paragraph.startswith(_SEEN)]
    others = [paragraph for paragraph in paragraphs[1:] if not paragraph.startswith(_SEEN)]
    reading = [opening, *(paragraph.removeprefix(_SEEN).strip() for paragraph in seen)]
    reading = [re.sub(r"^\(", r"\\(", paragraph) for paragraph in reading]  # "(a)" begins no list
    title = html_of(finding[1]).removeprefix("<p>").removesuffix("</p>").rstrip(".")
    return Caption(
        finding=title,
        plain=re.sub(r"<[^>]+>", "", title),
        reading=html_of("\n\n".join(reading)),
        details=html_of("\n\n".join(others)),
    )


def html_of(text: str) -> str:
    """reStructuredText as a fragment of HTML."""
    from docutils.core import publish_parts

    settings = {"file_insertion_enabled": False, "raw_enabled": False, "math_output": "MathML"}
    return str(publish_parts(text, writer="html5", settings_overrides=settings)["body"]).strip()
