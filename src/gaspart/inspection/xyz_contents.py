"""The contents of an XYZ file, plain or extended, https://github.com/libAtoms/extxyz (specification)."""

from __future__ import annotations

import math
import re
from collections import deque
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from gaspart.errors import SceneError
from gaspart.inspection.contents import Contents, Given

_PAIR = re.compile(r"""([^\s="'{}\[\],]+)\s*=\s*("[^"]*"|'[^']*'|\{[^}]*\}|\[.*?\](?=\s|$)|\S+)""")
_NUMBER = re.compile(r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eEdD][-+]?\d+)?")
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
"""Names of columns, in small letters, by which programs call the fields that are used."""
_FIELDS = {name: field for field, names in _NAMES.items() for name in names}
_PLAIN = {"species": (0, 1), "pos": (1, 3)}
_TRUE, _FALSE = ("t", "true", "1"), ("f", "false", "0")


def read_xyz(path: Path, given: Given) -> Contents:
    """All frames, or the last. Raises SceneError for contents that cannot be checked, ValueError for other
    text."""
    frames = deque(enumerate(_frames(path)), maxlen=1 if given.last else None)
    parts = [_read_frame(n, *frame, path) for n, frame in frames]
    if not parts:
        raise SceneError("file", str(path), "cannot be read: it has no frame")
    counts = [len(part["pos"]) for part in parts]
    for n, part in enumerate(parts):
        if counts[n] != counts[0]:
            rule = f"has {counts[n]} particles in frame {n} and {counts[0]} in frame 0"
            raise SceneError("file", str(path), f"{rule}: a changing number cannot be checked")
        if part.keys() != parts[0].keys():
            name = min(part.keys() ^ parts[0].keys())
            raise SceneError("file", str(path), f"states {name} in some frames only, not in 0 or not in {n}")
        if part.get("boundary") != parts[0].get("boundary"):
            rule = f"of frame {n} differs from that of frame 0"
            raise SceneError("pbc", part.get("boundary"), rule, str(path))
    columns = {name: np.array([part[name] for part in parts]) for name in parts[0] if name != "boundary"}
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
        boundary=parts[0].get("boundary"),
        plain=not any(name in columns and columns[name].any() for name in ("charge", "forces", "fixed")),
        resolution=_resolution(columns["pos"], int(columns["digits"].max())),
        time_resolution=float(columns["time_digit"].max()) if "time" in columns else 0.0,
    )


def _velocities(columns: dict[str, np.ndarray], path: Path) -> np.ndarray | None:
    """(T, N, d), from momenta if need be."""
    if "velo" in columns or "momenta" not in columns:
        return columns.get("velo")
    if "mass" not in columns:
        raise SceneError("file", str(path), "states momenta without masses: add a column velo or mass")
    return columns["momenta"] / columns["mass"][:, :, None]


def _frames(path: Path) -> Iterator[tuple[str, list[list[str]]]]:
    """Comment and words of the lines of each frame; blank lines before a frame are passed over."""
    lines = path.read_text(encoding="utf-8").split("\n")
    at = frame = 0
    while at < len(lines):
        if not lines[at].strip():
            at += 1
            continue
        count = int(lines[at])
        rows = [line.split() for line in lines[at + 2 : at + 2 + max(count, 0)]]
        while rows and not rows[-1]:
            rows.pop()
        if len(rows) < count or count < 1:
            raise SceneError("file", str(path), f"is truncated: frame {frame} has {len(rows)} particles")
        yield lines[at + 1], rows
        at, frame = at + 2 + count, frame + 1


def _read_frame(n: int, comment: str, rows: list[list[str]], path: Path) -> dict:
    """The fields of frame n, by the names of `_NAMES`, and of its comment."""
    pairs = {key.lower(): value.strip("\"'") for key, value in _PAIR.findall(comment)}
    named = _columns(pairs["properties"], path) if "properties" in pairs else _PLAIN
    width = max(first + count for first, count in named.values())
    extended = "properties" in pairs
    for row in rows:
        if len(row) < width or (extended and len(row) != named[""][0]):
            rule = f"has a line of {len(row)} columns in frame {n}, where {width} are stated"
            raise SceneError("file", str(path), rule)
    fields: dict = {}
    for name, (first, count) in named.items():
        if not name:
            continue
        words = [row[first : first + count] for row in rows]
        if name == "species":
            fields[name] = [word[0] for word in words]
        elif name == "move_mask":
            fields["fixed"] = [any(part.lower() in _FALSE for part in word) for word in words]
        else:
            values = _numbers(words)
            fields[name] = values if name in ("pos", "velo", "momenta", "forces") else values[:, 0]
    first, count = named["pos"]
    fields["digits"] = max(_significant(word) for row in rows for word in row[first : first + count])
    for name in ("velo", "momenta"):
        if name in fields and fields[name].shape[1] != count:
            rule = f"{name} must have {count} columns"
            raise SceneError("Properties", pairs["properties"], rule, str(path))
    return fields | _of_comment(pairs, path)


def _columns(properties: str, path: Path) -> dict[str, tuple[int, int]]:
    """First column and number of columns of each field that is used; of "" the number of all."""
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


def _numbers(words: list[list[str]]) -> np.ndarray:
    """Words as numbers, also with the exponents of Fortran. Raises ValueError."""
    try:
        return np.array(words, dtype=float)
    except ValueError:
        return np.array([[re.sub("[dD]", "e", word) for word in row] for row in words], dtype=float)


def _of_comment(pairs: dict[str, str], path: Path) -> dict:
    """Container, boundary and time of a frame, as its comment states them."""
    fields: dict = {}
    if "lattice" in pairs:
        cell = _vector(pairs, "lattice", (3, 9), path)
        matrix = np.diag(cell) if len(cell) == 3 else cell.reshape(3, 3)
        if np.any(matrix != np.diag(np.diag(matrix))):
            raise SceneError("Lattice", pairs["lattice"], "a tilted box cannot be checked", str(path))
        fields["lattice"] = np.diag(matrix)
    if "origin" in pairs:
        fields["origin"] = _vector(pairs, "origin", (3,), path)
    if "pbc" in pairs:
        words = re.findall(r"[^\s,\[\]{}]+", pairs["pbc"].lower())
        words = words * 3 if len(words) == 1 else words
        if len(words) != 3 or not set(words) <= {*_TRUE, *_FALSE}:
            raise SceneError("pbc", pairs["pbc"], "must be T or F for each of three axes", str(path))
        fields["boundary"] = tuple("periodic" if word in _TRUE else "wall" for word in words)
    if "time" in pairs:
        fields["time"] = _vector(pairs, "time", (1,), path)[0]
        decimals = len(pairs["time"].lower().partition("e")[0].partition(".")[2])
        exponent = pairs["time"].lower().partition("e")[2]
        fields["time_digit"] = 10.0 ** (int(exponent or 0) - decimals)
    return fields


def _vector(pairs: dict[str, str], key: str, sizes: tuple[int, ...], path: Path) -> np.ndarray:
    """The numbers of a value, of one of these counts."""
    words = re.findall(r"[^\s,\[\]{}]+", pairs[key])
    if len(words) not in sizes or not all(_NUMBER.fullmatch(word) for word in words):
        rule = f"must be {' or '.join(map(str, sizes))} numbers"
        raise SceneError(key, pairs[key], rule, str(path))
    return _numbers([words])[0]


def _significant(word: str) -> int:
    """Significant digits of a printed number."""
    mantissa = re.split("[eEdD]", word)[0].lstrip("+-").replace(".", "")
    return len(mantissa.lstrip("0"))


def _resolution(positions: np.ndarray, digits: int) -> float:
    """By how much a printed coordinate is off: one of the last of `digits` places of the largest one.

    Numbers such as 0 or 2.5, whose further digits were left out, do not make the others coarser.
    """
    largest = float(np.abs(positions).max())
    if not 0.0 < largest < math.inf:
        return 0.0
    return 10.0 ** (math.floor(math.log10(largest)) + 1 - digits)
