"""Contents of a plain or extended XYZ file, https://github.com/libAtoms/extxyz (specification)."""

from __future__ import annotations

import math
import re
from collections import deque
from collections.abc import Iterable, Iterator
from io import TextIOWrapper
from itertools import islice
from pathlib import Path

import numpy as np

from gaspart.errors import SceneError
from gaspart.files import open_regular
from gaspart.inspection.contents import Contents, Overrides, require_same_count

_PAIR = re.compile(
    r"""(?<![^\s="'{}\[\],])([^\s="'{}\[\],]++)\s*+=\s*+"""
    r"""("[^"]*"|'[^']*'|\{[^}]{0,999}\}|\[.{0,999}?\](?=\s|$)|\S+)"""
)
"""Pattern of a key with its value, whose time is proportional to the length of the text."""
_EXPONENT = re.compile(r"[eE]\S*")
_NO_SIGNS = str.maketrans("", "", "+-.")
_NUMBER = re.compile(r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?")
_NAMES = {
    "pos": ("pos", "positions"),
    "velo": ("velo", "vel", "velocity", "velocities"),
    "momenta": ("momenta",),
    "radius": ("radius", "radii"),
    "diameter": ("diameter", "diameters"),
    "mass": ("mass", "masses"),
    "id": ("id", "ids"),
    "species": ("species", "element", "symbols", "type", "z", "numbers"),
    "charge": ("charge", "charges", "initial_charges", "q"),
    "forces": ("force", "forces"),
    "move_mask": ("move_mask",),
}
"""Lower-case names of columns under which programs store each field."""
_FIELDS = {name: field for field, names in _NAMES.items() for name in names}
_PLAIN = {"species": (0, 1), "pos": (1, 3)}
_SIZES = {"lattice": "sides from the second line", "radius": "radii from the fifth column"}
_TRUE, _FALSE = ("t", "true", "1"), ("f", "false", "0")


def read_xyz(path: Path, overrides: Overrides) -> Contents:
    """Read all frames, or the last frame; SceneError for unusable contents, ValueError for other text."""
    kinds: dict[str, int] = {}  # a number for each species name
    with open_regular(path) as file, TextIOWrapper(file, encoding="utf-8") as lines:
        frames = (
            _read_frame(n, *frame, kinds, overrides, path) for n, frame in enumerate(_frames(lines, path))
        )
        parts = list(deque(enumerate(frames), maxlen=1 if overrides.last else None))
    if not parts:
        raise SceneError("file", str(path), "cannot be read: it has no frame")
    reason = None if overrides.last else _drop_velocities([part for _, part in parts])
    _add_origins([part for _, part in parts])
    first = parts[0][1]
    require_same_count([len(part["pos"]) for _, part in parts], path)
    for n, part in parts:
        _require_same_fields(n, part, first, path)
    # fields are joined one after the other, and their parts are freed
    names = [name for name in first if name != "boundary"]
    boundary = first.get("boundary")
    columns = {name: np.array([part.pop(name) for _, part in parts]) for name in names}
    diameters = columns.get("diameter")
    return Contents(
        positions=columns["pos"],
        velocities=_velocities(columns, path),
        time=columns.get("time"),
        radii=columns.get("radius") if diameters is None else 0.5 * diameters,
        masses=columns.get("mass"),
        ids=columns.get("id"),
        species=columns.get("species"),
        lengths=columns.get("lattice"),
        origin=columns.get("origin"),
        boundary=boundary,
        plain=not any(name in columns and columns[name].any() for name in ("charge", "forces", "fixed")),
        resolution=_resolution(columns["pos"], int(columns["digits"].max())),
        time_resolution=float(columns["time_digit"].max()) if "time" in columns else 0.0,
        no_velocities=reason,
        # the format of a plain file does not define sizes
        note=" and ".join(text for name, text in _SIZES.items() if name in columns)
        if columns["plain"].all()
        else "",
    )


def _drop_velocities(parts: list[dict]) -> str | None:
    """Remove velocities that only some frames have; return the reason if they are removed."""
    for name in ("velo", "momenta"):
        stored = sum(name in part for part in parts)
        if 0 < stored < len(parts):
            for part in parts:
                part.pop(name, None)
            return f"velocities are stored in {stored} of {len(parts)} frames only"
    return None


def _add_origins(parts: list[dict]) -> None:
    """Set a missing lower corner to 0 if other frames have one, because OVITO omits a corner at 0."""
    stated = [part["origin"] for part in parts if "origin" in part]
    if stated:
        for part in parts:
            part.setdefault("origin", np.zeros_like(stated[0]))


def _require_same_fields(n: int, part: dict, first: dict, path: Path) -> None:
    """Raise SceneError if a frame has other fields or boundaries than the first."""
    if part.keys() != first.keys():
        name = min(part.keys() ^ first.keys())
        raise SceneError("file", str(path), f"states {name} in some frames only, not in 0 or not in {n}")
    if part.get("boundary") != first.get("boundary"):
        rule = f"of frame {n} differs from that of frame 0"
        raise SceneError("pbc", part.get("boundary"), f"{rule}: give --boundary", str(path))


def _velocities(columns: dict[str, np.ndarray], path: Path) -> np.ndarray | None:
    """Return the velocities (T, N, d), computed from momenta if necessary."""
    if "velo" in columns or "momenta" not in columns:
        return columns.get("velo")
    if "mass" not in columns:
        raise SceneError("file", str(path), "states momenta without masses: add a column velo or mass")
    return columns["momenta"] / columns["mass"][:, :, None]


def _frames(lines: Iterator[str], path: Path) -> Iterator[tuple[str, list[list[str]]]]:
    """Yield the comment of each frame, and the words of its lines; blank lines before it are skipped."""
    for frame, line in enumerate(line for line in lines if line.strip()):
        count = int(line)
        comment = next(lines, "")
        rows = [row.split() for row in islice(lines, max(count, 0))]
        while rows and not rows[-1]:
            rows.pop()
        if len(rows) < count or count < 1:
            raise SceneError("file", str(path), f"is truncated: frame {frame} has {len(rows)} particles")
        yield comment, rows


def _read_frame(
    n: int, comment: str, rows: list[list[str]], kinds: dict[str, int], overrides: Overrides, path: Path
) -> dict:
    """Return the fields of frame n by `_NAMES`, without the user's, and its comment's; extend `kinds`."""
    pairs = {key.lower(): value.strip("\"'") for key, value in _PAIR.findall(comment)}
    named = _columns(pairs["properties"], path) if "properties" in pairs else _plain_columns(rows)
    if "properties" not in pairs and (sides := _plain_sides(comment)):
        pairs["lattice"] = sides
    width = max(first + count for first, count in named.values())
    extended = "properties" in pairs
    for row in rows:
        if len(row) < width or (extended and len(row) != named[""][0]):
            rule = f"has a line of {len(row)} columns in frame {n}, where {width} are stated"
            raise SceneError("file", str(path), rule)
    fields: dict = {"plain": not extended}
    for name, (first, count) in named.items():
        if not name or (name in ("radius", "diameter") and overrides.radius is not None):
            continue
        tokens = [row[first : first + count] for row in rows]
        if name == "species":
            fields[name] = np.array(
                [kinds.setdefault(token[0], len(kinds)) for token in tokens], dtype=np.int32
            )
        elif name == "move_mask":
            fields["fixed"] = np.array([any(part.lower() in _FALSE for part in token) for token in tokens])
        else:
            values = np.array(tokens, dtype=float)
            fields[name] = values if name in ("pos", "velo", "momenta", "forces") else values[:, 0]
    first, count = named["pos"]
    fields["digits"] = _most_digits(token for row in rows for token in row[first : first + count])
    for name in ("velo", "momenta"):
        if name in fields and fields[name].shape[1] != count:
            rule = f"{name} must have {count} columns"
            raise SceneError("Properties", pairs["properties"], rule, str(path))
    return fields | _of_comment(pairs, count, overrides, path)


def _plain_columns(rows: list[list[str]]) -> dict[str, tuple[int, int]]:
    """Return the columns of a plain file; positive numbers in a fifth and last column are radii."""
    fifth = [row[4] for row in rows if len(row) == 5]
    radii = len(fifth) == len(rows) and all(_NUMBER.fullmatch(text) for text in fifth)
    if radii and (np.array(fifth, dtype=float) > 0.0).all():
        return {**_PLAIN, "radius": (4, 1)}
    return _PLAIN


def _plain_sides(comment: str) -> str:
    """Return two or three positive numbers, the whole comment of a plain file, as sides of the container."""
    tokens = _words(comment)
    if len(tokens) not in (2, 3) or not all(_NUMBER.fullmatch(token) for token in tokens):
        return ""
    return " ".join([*tokens, "0"][:3]) if all(float(token) > 0.0 for token in tokens) else ""


def _columns(properties: str, path: Path) -> dict[str, tuple[int, int]]:
    """Return first column and number of columns of each field that is used; under "" the total number."""
    parts, first, columns = properties.split(":"), 0, {}
    if len(parts) % 3 or not all(width.isdigit() and int(width) > 0 for width in parts[2::3]):
        raise SceneError("Properties", properties, "must be of the form name:type:columns:...", str(path))
    for name, width in zip(parts[::3], parts[2::3], strict=True):
        field = _FIELDS.get(name.lower())
        if field is not None and field not in columns:
            columns[field] = first, int(width)
        first += int(width)
    if columns.get("pos", (0, 0))[1] not in (2, 3):
        raise SceneError("Properties", properties, "must have pos of two or three columns", str(path))
    return {**columns, "": (first, 0)}


def _of_comment(pairs: dict[str, str], dimension: int, overrides: Overrides, path: Path) -> dict:
    """Return the container, boundary and time of a frame from its comment, without those of the user."""
    fields: dict = {}
    if "lattice" in pairs and (overrides.lengths is None or len(_words(pairs["lattice"])) in (3, 4, 9)):
        cell = _vector(pairs, "lattice", (3, 4, 9), "--lengths X,Y[,Z]", path)
        if len(cell) == 4:  # the two vectors in the plane
            cell = np.array([*cell[:2], 0.0, *cell[2:], 0.0, 0.0, 0.0, 0.0])
        matrix = np.diag(cell) if len(cell) == 3 else cell.reshape(3, 3)
        if np.any(matrix != np.diag(np.diag(matrix))):
            raise SceneError("Lattice", pairs["lattice"], "a tilted box cannot be checked", str(path))
        fields["lattice"] = np.diag(matrix)
    if "origin" in pairs and overrides.origin is None:
        fields["origin"] = _vector(pairs, "origin", (dimension, 3), "--origin X,Y[,Z]", path)
    if "pbc" in pairs and overrides.boundary is None:
        tokens = _words(pairs["pbc"].lower())
        tokens = tokens * 3 if len(tokens) == 1 else tokens
        if len(tokens) not in (dimension, 3) or not set(tokens) <= {*_TRUE, *_FALSE}:
            rule = f"must be T or F for each of {dimension} axes; give --boundary"
            raise SceneError("pbc", pairs["pbc"], rule, str(path))
        fields["boundary"] = tuple("periodic" if token in _TRUE else "wall" for token in tokens)
    if "time" in pairs and overrides.time_step is None:
        fields["time"] = _vector(pairs, "time", (1,), "--time-step", path)[0]
        decimals = len(pairs["time"].lower().partition("e")[0].partition(".")[2])
        exponent = pairs["time"].lower().partition("e")[2]
        fields["time_digit"] = float(f"1e{int(exponent or 0) - decimals}")
    return fields


def _words(text: str) -> list[str]:
    """Split a value into its words, removing brackets."""
    return re.findall(r"[^\s,\[\]{}]+", text)


def _vector(pairs: dict[str, str], key: str, sizes: tuple[int, ...], option: str, path: Path) -> np.ndarray:
    """Return the numbers of a value; if their count is none of `sizes`, the error names an `option`."""
    tokens = _words(pairs[key])
    if len(tokens) not in sizes or not all(_NUMBER.fullmatch(token) for token in tokens):
        rule = f"must be {' or '.join(map(str, dict.fromkeys(sizes)))} numbers; give {option}"
        raise SceneError(key, pairs[key], rule, str(path))
    return np.array(tokens, dtype=float)


def _most_digits(tokens: Iterable[str]) -> int:
    """Return the largest number of significant digits in some printed numbers."""
    text = " ".join(tokens)
    if _EXPONENT.search(text):
        text = _EXPONENT.sub("", text)
    return max((len(token.lstrip("0")) for token in text.translate(_NO_SIGNS).split(" ")), default=0)


def _resolution(positions: np.ndarray, digits: int) -> float:
    """Return the resolution of a printed coordinate, one unit of the last printed digit. The largest
    coordinate has `digits` digits. Numbers such as 0 or 2.5, whose trailing zeros were omitted, do not reduce
    the resolution of the others.
    """
    largest = float(np.abs(positions).max())
    if not 0.0 < largest < math.inf:
        return 0.0
    return 10.0 ** (math.floor(math.log10(largest)) + 1 - digits)
