"""The page: what the template is filled with."""

from __future__ import annotations

import base64
import mimetypes
from collections import Counter
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from io import BytesIO
from pathlib import Path
from typing import Any

from gaspart.reproduction.claims import counts
from gaspart.reproduction.claims.captions import filled
from gaspart.reproduction.families.registry import chapter
from gaspart.reproduction.report.caption import Caption, divided, html_of
from gaspart.reproduction.report.strip import dots

_PIXELS_PER_INCH = 96.0 * 1.5
"""Pixels of the page per inch of a figure, so that its lettering of 8 points is as large as the text."""
CHAPTERS = (
    "Equation of state and structure",
    "Motion and its memory",
    "Gravity, heat and walls",
    "Granular matter",
    "Speed and accuracy",
    "Pictures and checks",
    "Own figures",
)
"""In the order of the page."""
_THUMBNAIL, _SHARPNESS = 360, 1.6
"""Width of a thumbnail, and pixels of a picture for each of the page, in a page that holds its pictures."""
HEADLINE = ("test", "identity", "reproduction")
"""The kinds of claims that are counted on the first screen, apart from one another."""


@dataclass(frozen=True)
class Section:
    """A figure on the page. family_name: of its functions; claims: its rows of the claims table;
    films: their names; settings: of its measurement, as text; points: the files of its simulations."""

    name: str
    family_name: str
    caption: Caption
    claims: list[dict[str, Any]]
    films: list[str]
    settings: str
    points: list[str]

    @property
    def dots(self) -> list:
        """Its claims on the axis of deviations, but for the joint test of the others."""
        return dots(row for row in self.claims if row["kind"] != "family")

    @property
    def verdicts(self) -> dict[str, int]:
        """How many of its claims have each verdict."""
        return verdicts(self.claims)

    @property
    def family(self) -> dict[str, Any] | None:
        """The joint test of its claims, if there are enough of them."""
        return next((row for row in self.claims if row["kind"] == "family"), None)


def by_chapter(sections: Iterable[Section]) -> dict[str, list[Section]]:
    """The sections of each chapter, in the order of the figures."""
    of_chapter: dict[str, list[Section]] = {title: [] for title in CHAPTERS}
    for section in sections:
        of_chapter[chapter(section.family_name)].append(section)
    return {title: members for title, members in of_chapter.items() if members}


def findings(chosen: Iterable[Mapping[str, str]], rows: list[dict[str, Any]]) -> list[dict[str, str]]:
    """The key findings of the figures that have claims, with their measured numbers filled in: [{figure,
    text}]. chosen: the same with places for numbers as in a caption."""
    present = {row["figure"] for row in rows}
    return [
        {
            "figure": finding["figure"],
            "text": html_of(
                filled(finding["text"], [row for row in rows if row["figure"] == finding["figure"]])
            ),
        }
        for finding in chosen
        if finding["figure"] in present
    ]


def headline(rows: list[dict[str, Any]]) -> dict[str, Any]:
    """The claims on the first screen: how many there are of each kind with each verdict, and those
    that disagree."""
    numbers = counts(rows)
    return {
        "kinds": {kind: numbers[kind] for kind in HEADLINE if kind in numbers},
        "disagree": [row for row in rows if row["verdict"] == "disagrees"],
    }


def verdicts(rows: Iterable[dict[str, Any]]) -> dict[str, int]:
    """How many claims have each verdict."""
    return dict(Counter(row["verdict"] for row in rows))


@dataclass(frozen=True)
class Picture:
    """Addresses of a figure's picture, as it is read, in one column for narrow screens, and as a thumbnail;
    and the sizes of the first two in pixels of the page, which so does not move while they are loaded."""

    large: str
    narrow: str
    small: str
    size: tuple[int, int]
    narrow_size: tuple[int, int]


def picture(path: Path, one_file: bool) -> Picture:
    """The picture of a figure, of which `path` is the PNG. The SVG lies beside it, and the picture in one
    column below in journal/.

    one_file: the page is to hold its pictures; they are then WebP, a third of their size.
    """
    column = path.parent / "journal" / path.name
    size, narrow = _size(path), _size(column)
    if one_file:
        sharp = round(_SHARPNESS * size[0]), round(_SHARPNESS * narrow[0])
        addresses = _webp(path, sharp[0]), _webp(column, sharp[1]), _webp(path, _THUMBNAIL)
    else:
        addresses = address(path.with_suffix(".svg")), f"figures/journal/{path.name}", address(path)
    return Picture(*addresses, size, narrow)


def _size(path: Path) -> tuple[int, int]:
    """Width and height of a PNG, in pixels of the page."""
    from PIL import Image

    with Image.open(path) as image:
        scale = _PIXELS_PER_INCH / float(image.info["dpi"][0])
        return round(image.width * scale), round(image.height * scale)


def address(path: Path, one_file: bool = False) -> str:
    """The address of a file of results/: relative to the page, or one that holds the file."""
    if one_file:
        return _data(mimetypes.guess_type(path.name)[0] or "", path.read_bytes())
    return f"{path.parent.name}/{path.name}"


def films(paths: list[Path], one_file: bool) -> dict[str, str]:
    """Name and address of each film that the page shows. One that is to hold them holds the first one only:
    all films together are larger than everything else."""
    return {path.stem: address(path, one_file) for path in (paths[:1] if one_file else paths)}


def _data(kind: str, content: bytes) -> str:
    return f"data:{kind};base64,{base64.b64encode(content).decode()}"


def _webp(path: Path, width: int) -> str:
    """The address that holds a picture of this width in pixels at most."""
    from PIL import Image

    content = BytesIO()
    with Image.open(path) as image:
        image = image.convert("RGB")
        image.thumbnail((width, 10 * width))
        image.save(content, "WEBP", quality=68)
    return _data("image/webp", content.getvalue())


def captioned(text: str, rows: list[dict[str, Any]]) -> Caption:
    """The caption of a figure with its measured numbers."""
    return divided(filled(text, rows))
