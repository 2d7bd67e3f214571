"""The parts of a caption: its finding, how to read the figure, and what is folded below.

A caption is reStructuredText. Its first words, in bold, are the finding. The rest of that paragraph and the
paragraph that begins with *What is seen.* state how to read the figure.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from docutils import nodes

_FINDING = re.compile(r"\*\*(?=[^\s*])(.+?)\*\*\s*", re.DOTALL)
_SCHEME = re.compile(r"([a-z][a-z0-9+.-]*):")
_SCHEMES = ("http", "https", "mailto", "doi")
"""Beginnings that an address in a caption may have, unless it is within the report."""
_SETTINGS = {
    "file_insertion_enabled": False,
    "raw_enabled": False,
    "math_output": "MathML",
    "warning_stream": False,  # faults are raised
    "halt_level": 5,
}
_HTML: dict[str, Any] = {"writer": "html5", "settings_overrides": _SETTINGS}
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

    Raises ValueError if it does not begin with words in bold, and as `html_of`.
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
    """reStructuredText as a fragment of HTML.

    Raises ValueError for marks that are not closed and other faults, and for an address whose scheme is not
    one of the web or of mail: `javascript:` would run where the report is read.
    """
    from docutils.core import publish_doctree, publish_parts

    try:
        fault = _fault(publish_doctree(text, settings_overrides=_SETTINGS))
        body = "" if fault else str(publish_parts(text, **_HTML)["body"]).strip()
    except Exception as error:  # docutils 0.22 raises AttributeError and others for formulas
        raise ValueError(f"cannot be read as reStructuredText: {type(error).__name__}: {error}") from None
    if fault:
        raise ValueError(fault)
    if '<aside class="system-message">' in body:  # of a formula, which is read when it is written
        raise ValueError("holds a formula that cannot be read")
    return body


def _fault(tree: nodes.document) -> str:
    """The fault of a text that was read; "" if there is none."""
    from docutils import nodes

    said = [*tree.findall(nodes.system_message), *tree.parse_messages, *tree.transform_messages]
    serious = [message for message in said if message["level"] > 1]
    if serious:
        return str(serious[0].children[0].astext() if serious[0].children else serious[0].astext())
    for node in tree.findall(nodes.Element):
        for address in (node.get("refuri"), node.get("uri")):
            if address and not _is_safe(address):
                return f"the address {address} must begin with {', '.join(_SCHEMES)} or lie in the report"
    return ""


def _is_safe(address: str) -> bool:
    """Whether an address is one of the web, of mail, or relative. Browsers skip white space and control
    characters within a scheme."""
    scheme = _SCHEME.match("".join(c for c in address if c.isprintable() and c != " ").lower())
    return scheme is None or scheme[1] in _SCHEMES
