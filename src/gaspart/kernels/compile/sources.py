"""Hashes of source files that do not change with docstrings and comments.

A Python file is represented by its syntax tree without docstrings. The tree is converted to text here,
because `ast.dump` differs between versions of Python. The conversion takes about 3 ms per file, so the hashes
of all known contents are stored in the cache folder.
"""

from __future__ import annotations

import ast
import hashlib
import json
import os
import re
import sys
from collections.abc import Iterable, Iterator
from functools import cache
from pathlib import Path
from typing import Any

from gaspart.files import scratch_beside
from gaspart.kernels.compile.cache import cache_directory, obstacle
from gaspart.system import is_own

STORE = "trees.json"
_IMPORT = re.compile(r"^[ \t]*from (gaspart\.kernels[\w.]*) import (\([^)]*\)|[^\n]*)", re.MULTILINE)
KERNELS = Path(__file__).parents[1]
MOST_STORED = 20_000
"""Maximum number of stored hashes, about thirty versions of the package."""
_DIGEST = re.compile(r"[0-9a-f]{32}")


def file_digests(paths: Iterable[Path]) -> list[str]:
    """Return the hash of each file: of its syntax tree for Python, of its bytes for any other."""
    stored, added, digests = _read_stored(), {}, []
    for path in paths:
        content = path.read_bytes()
        digest = _digest(content)
        if path.suffix == ".py":
            key = _digest(b"%d.%d:" % sys.version_info[:2] + content)
            if key not in stored:
                stored[key] = added[key] = tree_digest(content)
            digest = stored[key]
        digests.append(digest)
    if added:
        _store(added)
    return digests


@cache
def source_digest() -> str:
    """Return a short hash of all modules of `kernels`; docstrings and comments do not change it."""
    return hashlib.sha256("".join(closure_digests().values()).encode()).hexdigest()[:16]


@cache
def closure_digests(folder: Path = KERNELS) -> dict[str, str]:
    """Return for each file of `kernels` the hash of all modules of `kernels` that it needs, itself included.
    Only these modules can change the machine code of its functions.
    """
    paths = sorted(folder.rglob("*.py"))
    names = [".".join(("gaspart.kernels", *path.relative_to(folder).with_suffix("").parts)) for path in paths]
    own = dict(zip(names, file_digests(paths), strict=True))
    imports = {name: _imports(path) & own.keys() for name, path in zip(names, paths, strict=True)}
    result = {}
    for name, path in zip(names, paths, strict=True):
        needed, queue = {name}, [name]
        while queue:
            new = imports[queue.pop()] - needed
            needed |= new
            queue.extend(new)
        text = "".join(f"{module} {own[module]} " for module in sorted(needed))
        result[str(path)] = hashlib.sha256(text.encode()).hexdigest()[:16]
    return result


def _imports(path: Path) -> set[str]:
    """Return the modules of `kernels` that a file imports, and all names that could be such modules."""
    modules = set()
    for base, names in _IMPORT.findall(path.read_text(encoding="utf-8")):
        modules |= {base, *(f"{base}.{name}" for name in re.findall(r"\w+", names))}
    return modules


def tree_digest(source: bytes) -> str:
    """Return the hash of Python source's syntax tree, or of its bytes if parsing fails."""
    try:
        tree = ast.parse(source)
    except (SyntaxError, ValueError):
        return _digest(source)
    return _digest("\0".join(_words(tree)).encode("utf-8", "surrogatepass"))


def _words(node: Any) -> Iterator[str]:
    """Yield a syntax tree's text without empty fields, which depend on the version of Python."""
    if isinstance(node, ast.AST):
        yield f"({type(node).__name__}"
        for name, value in ast.iter_fields(node):
            if value is not None and value != []:
                yield name
                yield from _words(value)
        yield ")"
    elif isinstance(node, list):
        yield "["
        for item in node:
            if not _is_text(item):
                yield from _words(item)
        yield "]"
    else:
        yield f"{type(node).__name__} {node!r}"


def _is_text(node: Any) -> bool:
    """Return True if a statement is only a string, such as a docstring, also of a constant."""
    if not isinstance(node, ast.Expr) or not isinstance(node.value, ast.Constant):
        return False
    return isinstance(node.value.value, str)


def _digest(content: bytes) -> str:
    return hashlib.sha256(content).hexdigest()[:32]


@cache
def _read_stored() -> dict[str, str]:
    """Return the stored hashes of trees by the hashes of the file contents."""
    try:
        with open(_folder() / STORE, "rb") as file:
            content = json.load(file) if is_own(os.fstat(file.fileno())) else None
    except (OSError, ValueError, RuntimeError):  # RecursionError is a RuntimeError
        return {}
    if not isinstance(content, dict):
        return {}
    is_whole = all(isinstance(value, str) and _DIGEST.fullmatch(value) for value in content.values())
    return content if is_whole else {}


def _store(added: dict[str, str]) -> None:
    """Add hashes to the stored hashes in the cache folder, if it can be written."""
    try:
        folder = _folder()
        _read_stored.cache_clear()
        kept = [*(_read_stored() | added).items()][-MOST_STORED:]
        with scratch_beside(folder / STORE) as scratch:
            scratch.write_text(json.dumps(dict(kept)))
            scratch.replace(folder / STORE)
    except (OSError, RuntimeError):
        pass


def _folder() -> Path:
    """Return the folder of the stored hashes; RuntimeError if others may, or this user cannot, write
    to it.
    """
    folder = cache_directory() / "sources"
    if obstacle(folder):
        raise RuntimeError
    return folder
