"""Content of the report's page for its template."""

from __future__ import annotations

import base64
import math
import mimetypes
import re
from collections import Counter
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from io import BytesIO
from pathlib import Path
from typing import TYPE_CHECKING, Any

from gaspart.reproduction.claims import counts
from gaspart.reproduction.claims.judging import FAMILY_LEVEL
from gaspart.reproduction.claims.table import fill_caption
from gaspart.reproduction.registry import chapter

if TYPE_CHECKING:
    from docutils import nodes


# Claims on an axis of deviations: position and look of each dot.


LIMIT = 5.0
"""Standard deviations at the ends of the axis; claims beyond are drawn at the end."""
_BAND = 3.0
_WIDTH = 0.24
"""Distance in standard deviations below which two dots would overlap."""
_LEVELS = 4


@dataclass(frozen=True)
class Dot:
    """Claim on the axis of deviations.

    row : row of the claims table.
    position : position in percent of the axis.
    level : height 0, 1, ... of the dot, so that dots do not hide one another.
    """

    row: dict[str, Any]
    position: float
    level: int


def deviation(row: dict[str, Any]) -> float:
    """Return the position of a claim in standard deviations. The position of a value is its deviation. For a
    measured number between two bounds, the bounds are at -3 and 3, and the number is at its relative position
    between them. Without a deviation the position is 0.
    """
    low, high, measured = row["lowest"], row["highest"], row["measured"]
    if math.isfinite(low) and math.isfinite(high) and math.isfinite(measured) and high > low:
        return _BAND * (2.0 * measured - low - high) / (high - low)
    sigma = row["deviation_sigma"]
    return sigma if not math.isnan(sigma) else 0.0


def dots(rows: Iterable[dict[str, Any]]) -> list[Dot]:
    """Return the dots of some claims, from the lowest deviation to the highest."""
    last = [-math.inf] * _LEVELS
    placed = []
    for row in sorted(rows, key=deviation):
        at = min(max(deviation(row), -LIMIT), LIMIT)
        free = [level for level in range(_LEVELS) if at - last[level] >= _WIDTH]
        level = free[0] if free else min(range(_LEVELS), key=last.__getitem__)
        last[level] = at
        placed.append(Dot(row, 50.0 * (1.0 + at / LIMIT), level))
    return placed


# Parts of a caption: its finding, the instructions to read the figure, and folded details. A caption is
# reStructuredText. Its first words, in bold, are the finding. The rest of this paragraph, and the paragraph
# that begins with *Panels.*, explain how to read the figure.


_FINDING = re.compile(r"\*\*(?=[^\s*])(.+?)\*\*\s*", re.DOTALL)
_SCHEME = re.compile(r"([a-z][a-z0-9+.-]*):")
_SCHEMES = ("http", "https", "mailto", "doi")
"""Schemes that an address in a caption may have, unless it is an address in the report."""
_SETTINGS = {
    "file_insertion_enabled": False,
    "raw_enabled": False,
    "math_output": "MathML",
    "warning_stream": False,  # docutils raises faults as errors
    "halt_level": 5,
}
_HTML: dict[str, Any] = {"writer": "html5", "settings_overrides": _SETTINGS}
_SEEN = "*Panels.*"


@dataclass(frozen=True)
class Caption:
    """Caption of a figure.

    finding : inline HTML.
    plain : the finding as plain text.
    reading, details : HTML; `details` may be empty.
    """

    finding: str
    plain: str
    reading: str
    details: str


def split_caption(text: str) -> Caption:
    """Return the parts of a caption. Raises ValueError if the caption does not begin with words in bold, or
    if `html_of` raises it.
    """
    paragraphs = re.split(r"\n\s*\n", text.strip())
    finding = _FINDING.match(paragraphs[0])
    if not finding:
        raise ValueError("a caption begins with its finding, in bold")
    opening = paragraphs[0][finding.end() :]
    seen = [paragraph for paragraph in paragraphs[1:] if paragraph.startswith(_SEEN)]
    others = [paragraph for paragraph in paragraphs[1:] if not paragraph.startswith(_SEEN)]
    reading = [opening, *(paragraph.removeprefix(_SEEN).strip() for paragraph in seen)]
    reading = [re.sub(r"^\(", r"\\(", paragraph) for paragraph in reading]  # "(a)" is not the start of a list
    title = _inline(finding[1]).rstrip(".")
    return Caption(
        finding=title,
        plain=re.sub(r"<[^>]+>", "", title),
        reading=html_of("\n\n".join(reading)),
        details=html_of("\n\n".join(others)),
    )


def html_of(text: str) -> str:
    """Convert reStructuredText to a fragment of HTML. Raises ValueError for unclosed marks and other faults.
    Raises ValueError also for an address whose scheme is not for web or mail: `javascript:` would run on the
    reader's machine.
    """
    from docutils.core import publish_doctree, publish_parts

    try:
        fault = _fault(publish_doctree(text, settings_overrides=_SETTINGS))
        body = "" if fault else str(publish_parts(text, **_HTML)["body"]).strip()
    except Exception as error:  # docutils 0.22 raises AttributeError and other errors for formulas
        raise ValueError(f"cannot be read as reStructuredText: {type(error).__name__}: {error}") from None
    if fault:
        raise ValueError(fault)
    if '<aside class="system-message">' in body:  # error in a formula, which is parsed when it is written
        raise ValueError("holds a formula that cannot be read")
    return body


def _fault(tree: nodes.document) -> str:
    """Return the error of a parsed text; "" if there is no error."""
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
    """Return True if an address is relative, or for web or mail. Browsers ignore white space and control
    characters in a scheme.
    """
    scheme = _SCHEME.match("".join(c for c in address if c.isprintable() and c != " ").lower())
    return scheme is None or scheme[1] in _SCHEMES


_PIXELS_PER_INCH = 96.0 * 1.5
"""Pixels of the page per inch of a figure. With this value, 8-point lettering of a figure is as large as the
text."""
CHAPTERS = (
    "Equation of state and structure",
    "Motion and its memory",
    "Gravity, heat and walls",
    "Granular matter",
    "Speed and accuracy",
    "Pictures and checks",
    "Own figures",
)
"""Chapters in the order of the page."""
_FEW = 6
"""Number of findings of a page without chosen ones."""
_KEY, _SHARPNESS = 360, 1.5
"""Width of a key picture in pixels, and resolution of pictures inside the page, in pixels per pixel of the
page."""


@dataclass(frozen=True)
class Section:
    """Figure on the page.

    family_name : family that has the functions of the figure.
    claims : rows of the figure in the claims table.
    films : names of the films.
    settings : settings of the measurement, as text.
    points : files of the simulations.
    """

    name: str
    family_name: str
    caption: Caption
    claims: list[dict[str, Any]]
    films: list[str]
    settings: str
    points: list[str]

    @property
    def dots(self) -> list:
        """Claims on the axis of deviations, without the joint test."""
        return dots(row for row in self.claims if row["kind"] != "family")

    @property
    def verdicts(self) -> dict[str, int]:
        """Number of claims with each verdict."""
        return verdicts(self.claims)

    @property
    def family(self) -> dict[str, Any] | None:
        """Joint test of the claims of the figure, if there are enough claims."""
        return next((row for row in self.claims if row["kind"] == "family"), None)


def by_chapter(sections: Iterable[Section]) -> dict[str, list[Section]]:
    """Return the sections of each chapter, in the order of the figures."""
    of_chapter: dict[str, list[Section]] = {title: [] for title in CHAPTERS}
    for section in sections:
        of_chapter[chapter(section.family_name)].append(section)
    return {title: members for title, members in of_chapter.items() if members}


def findings(chosen: Iterable[Mapping[str, str]], sections: Iterable[Section]) -> list[dict[str, str]]:
    """Return the key findings of the page, [{figure, text}], with measured numbers filled in. `chosen` are
    findings with placeholders for numbers, as in a caption. If their figures are not on the page, the
    findings of its first figures take their place.
    """
    present = {section.name: section for section in sections}
    shown = [
        {"figure": one["figure"], "text": _inline(fill_caption(one["text"], present[one["figure"]].claims))}
        for one in chosen
        if one["figure"] in present
    ]
    first = list(present.values())[:_FEW]
    return shown or [{"figure": one.name, "text": f"{one.caption.finding}."} for one in first]


def statements(documents: Iterable[Mapping[str, Any]], rows: list[dict[str, Any]]) -> list[dict[str, Any]]:
    """Return the statements of the sources, with the measured numbers of their figures filled in. Each has
    the source, the place `at`, the verdict, the figure or "", and `says` and `why` as HTML.
    """
    shown = []
    for document in documents:
        for entry in document["statements"]:
            own = [row for row in rows if row["figure"] == entry.get("figure")]
            texts = {key: _inline(fill_caption(entry[key], own)) for key in ("says", "why")}
            shown.append({"figure": "", "source": document["source"], **entry, **texts})
    return shown


def _inline(text: str) -> str:
    return html_of(text).removeprefix("<p>").removesuffix("</p>")


def headline(rows: list[dict[str, Any]]) -> dict[str, Any]:
    """Return the result of all claims: numbers by verdict, by kind and verdict, and disagreements. Families
    are counted too, so that the numbers of all kinds add up to the total. `chance` is a bound on the
    probability that any claim disagrees if all are true: the sum over all that is judged together, which are
    the tests and reproductions of a figure, and each other claim with an uncertainty.
    """
    found = verdicts(rows)
    judged = [row for row in rows if row["uncertainty"] > 0.0 and row["verdict"] != "no verdict"]
    together = {(row["figure"], _is_tested_alone(row) and row["claim"]) for row in judged}
    return {
        "agree": found.get("agrees", 0) + found.get("reproduced", 0),
        "open": found.get("inconclusive", 0),
        "kinds": counts(rows),
        "disagree": [row for row in rows if row["verdict"] == "disagrees"],
        "chance": min(1.0, FAMILY_LEVEL * len(together)),
    }


def _is_tested_alone(row: dict[str, Any]) -> bool:
    return row["kind"] in ("identity", "family")


def verdicts(rows: Iterable[dict[str, Any]]) -> dict[str, int]:
    """Count the claims with each verdict."""
    return dict(Counter(row["verdict"] for row in rows))


@dataclass(frozen=True)
class Picture:
    """Addresses of a figure's picture: full size, in one column for narrow screens, and key picture. The
    first two have sizes in pixels of the page, so that the page does not move while they are loaded.
    """

    large: str
    narrow: str
    small: str
    size: tuple[int, int]
    narrow_size: tuple[int, int]


def picture(path: Path, one_file: bool) -> Picture:
    """Return the picture of a figure whose PNG is `path`. The SVG is in the same folder. The picture in one
    column is in the subfolder journal/, the key picture in key/. If `one_file`, pictures are stored in the
    page as WebP, with a third of the size.
    """
    column, key = path.parent / "journal" / path.name, path.parent / "key" / path.name
    size, narrow = _size(path), _size(column)
    if one_file:
        sharp = round(_SHARPNESS * size[0]), round(_SHARPNESS * narrow[0])
        addresses = _webp(path, sharp[0]), _webp(column, sharp[1]), _webp(key, _KEY)
    else:
        addresses = (
            address(path.with_suffix(".svg")),
            f"figures/journal/{path.name}",
            f"figures/key/{path.name}",
        )
    return Picture(*addresses, size, narrow)


def _size(path: Path) -> tuple[int, int]:
    """Return width and height of a PNG, in pixels of the page."""
    from PIL import Image

    with Image.open(path) as image:
        scale = _PIXELS_PER_INCH / float(image.info["dpi"][0])
        return round(image.width * scale), round(image.height * scale)


def address(path: Path, one_file: bool = False) -> str:
    """Return the address of a file in results/, relative to the page. If `one_file` is True, the address
    contains the data of the file.
    """
    if one_file:
        return _data(mimetypes.guess_type(path.name)[0] or "", path.read_bytes())
    return f"{path.parent.name}/{path.name}"


def _data(kind: str, content: bytes) -> str:
    return f"data:{kind};base64,{base64.b64encode(content).decode()}"


def _webp(path: Path, width: int) -> str:
    """Return an address that contains a picture of limited width, in pixels."""
    from PIL import Image

    content = BytesIO()
    with Image.open(path) as image:
        image = image.convert("RGB")
        image.thumbnail((width, 10 * width))
        image.save(content, "WEBP", quality=68)
    return _data("image/webp", content.getvalue())


def make_caption(text: str, rows: list[dict[str, Any]]) -> Caption:
    """Return the caption of a figure, with its measured numbers filled in."""
    return split_caption(fill_caption(text, rows))
