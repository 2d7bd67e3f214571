"""Modules that each stage of the workflow uses, found from imports.

A digest of these modules is a parameter of the rules of a stage. If a module is edited, only the stages that
use it are run again. If modules were inputs of rules, ten thousand points would have half a million input
files. Imports are found by text search, because parsing the whole package would take most of the planning
time. A test compares the result with that from a parser. Some packages load a name on first use
(`gaspart.public`). Such a name represents the module that defines it. If such a package is imported as a
whole, it represents all of these modules.
"""

from __future__ import annotations

import ast
import hashlib
import re
from functools import cache
from pathlib import Path

from gaspart.kernels.compile.sources import file_digests, tree_digest
from gaspart.public import read_stub
from gaspart.reproduction.points.point import TRAJECTORIES, Point, variant

PACKAGE = Path(__file__).parents[2]
_TYPES = re.compile(r"^if TYPE_CHECKING:\n(?:[ \t]+.*\n|\n)+", re.MULTILINE)
_FROM = re.compile(r"^[ \t]*from (gaspart[\w.]*) import (\([^)]*\)|[^\n]*)", re.MULTILINE)
_PLAIN = re.compile(r"^[ \t]*import (gaspart[\w.]*)", re.MULTILINE)


@cache
def closure(*roots: str | Path) -> frozenset[Path]:
    """Return the files of the package that modules or scripts need, directly or indirectly. Modules are given
    by dotted names, and scripts by paths. Tables in a folder `data` next to a module that names it are
    included.
    """
    files: set[Path] = set()
    queue = [root if isinstance(root, Path) else _file(root) for root in roots]
    queue = [path for path in queue if path is not None]
    files |= {path for path in queue if path.is_relative_to(PACKAGE)}
    while queue:
        for path in find_imports(queue.pop()) - files:
            files.add(path)
            queue.append(path)
    return frozenset(files.union(*map(_tables, files)))


@cache
def _tables(path: Path) -> frozenset[Path]:
    """Return the tables that a module reads."""
    reads = '"data"' in path.read_text(encoding="utf-8")
    return frozenset(path.parent.glob("data/*.csv") if reads else ())


@cache
def find_imports(path: Path) -> frozenset[Path]:
    """Return the files that a file of the package imports directly, with their packages."""
    return frozenset(_imports_in(_TYPES.sub("", path.read_text(encoding="utf-8"))))


def _imports_in(text: str) -> set[Path]:
    """Return the files that a piece of code imports, with their packages."""
    names = set(_PLAIN.findall(text))
    for base, items in _FROM.findall(text):
        names.add(base)
        listed = (item.split("#")[0].strip().split(" as ")[0] for item in items.strip("()").split(","))
        for name in filter(None, listed):
            names |= {f"{base}.{name}", *_homes(f"{base}.{name}").values()}
            names |= {_homes(base)[name]} if name in _homes(base) else set()
    parents = {name.rsplit(".", depth)[0] for name in names for depth in range(1, name.count(".") + 1)}
    return {file for name in names | parents if (file := _file(name)) is not None}


@cache
def _homes(package: str) -> dict[str, str]:
    """Return the module of each name that a package loads on first use."""
    stub = PACKAGE.joinpath(*package.split(".")[1:], "__init__.pyi")
    return read_stub(str(stub)) if stub.is_file() else {}


@cache
def _file(module: str) -> Path | None:
    """Return the file of a module of the package; None if there is no such module."""
    top, *below = module.split(".")
    path = PACKAGE.joinpath(*below)
    if top != PACKAGE.name:
        return None
    for file in (path / "__init__.py", path.with_suffix(".py")):
        if file.is_file():
            return file
    return None


@cache
def digest(*roots: str | Path) -> str:
    """Return a short digest of the files of a closure; a user's module has a path that ends in .py.
    Docstrings and comments do not change the digest.
    """
    own = {str(root): Path(root) for root in roots if isinstance(root, str) and root.endswith(".py")}
    rest = (own.get(str(root), root) for root in roots)
    return _digest_of([*_in_order(closure(*rest)), *own.values()])


@cache
def measuring_digest(module: str, figure: str) -> str:
    """Return a short digest of the code with which the module of a figure measures. This code is what its
    function `measure` needs: definitions in the module, and files that these import. Claims and drawing are
    no part of it.
    """
    path = Path(module) if module.endswith(".py") else _file(module)
    assert path is not None, module
    tree = ast.parse(_TYPES.sub("", path.read_text(encoding="utf-8")))
    definitions: dict[str, list[ast.stmt]] = {}
    for node in tree.body:
        for name in _names_bound(node):
            definitions.setdefault(name, []).append(node)
    measure = _measure_of(definitions["FIGURES"], figure)
    needed, queue = {measure}, [measure]
    while queue:
        used = {part.id for part in ast.walk(queue.pop()) if isinstance(part, ast.Name)}
        new = {node for name in used for node in definitions.get(name, ())} - needed
        needed |= new
        queue += new
    text = "\n".join(ast.unparse(node) for node in (measure, *tree.body) if node in needed)
    files = closure(*sorted(_imports_in(text)))
    both = tree_digest(text.encode()) + _digest_of(_in_order(files))
    return hashlib.sha256(both.encode()).hexdigest()[:12]


def _names_bound(node: ast.stmt) -> list[str]:
    """Return the names that a statement of a module defines."""
    if isinstance(node, ast.FunctionDef | ast.ClassDef):
        return [node.name]
    if isinstance(node, ast.Import | ast.ImportFrom):
        return [(alias.asname or alias.name).split(".")[0] for alias in node.names]
    return [
        part.id for part in ast.walk(node) if isinstance(part, ast.Name) and isinstance(part.ctx, ast.Store)
    ]


def _measure_of(statements: list[ast.stmt], figure: str) -> ast.AST:
    """Return `measure` in the `Parts` of a figure, or of all figures if it is not stated there."""
    nodes = list(ast.walk(ast.Module(statements, [])))
    tables = [node for node in nodes if isinstance(node, ast.Dict)]
    entries = [entry for table in tables for entry in zip(table.keys, table.values, strict=True)]
    own = [value for key, value in entries if isinstance(key, ast.Constant) and key.value == figure]
    calls = [node for node in own or nodes if isinstance(node, ast.Call)]
    stated = [call for call in calls if ast.unparse(call.func).endswith("Parts")]
    measures = [keyword.value for call in stated for keyword in call.keywords if keyword.arg == "measure"]
    measures += [call.args[1] for call in stated if len(call.args) > 1]
    return ast.Module([ast.Expr(measure) for measure in measures] or statements, [])


@cache
def kernel_digest(*roots: str | Path) -> str:
    """Return a short digest of the modules in a closure that `warm` may compile. Jobs that need equal modules
    share their stamps.
    """
    modules = closure(*roots) & closure("gaspart.reproduction.points.point")
    return _digest_of([path for path in _in_order(modules) if path.is_relative_to(PACKAGE / "kernels")])


def stage_sources(scripts: Path, stage: str) -> list[Path]:
    """Return the scripts of a stage of the workflow, which import the modules that it uses."""
    return [scripts / "_job.py", scripts / f"{stage}.py"]


def point_sources(point: Point, scripts: Path) -> list[str | Path]:
    """Return the script that does the job of a point, and the modules that it imports by name."""
    stage = "simulate" if point.job == TRAJECTORIES else "compute"
    return [*stage_sources(scripts, stage), *point.modules]


def stamp(point: Point, scripts: Path) -> str:
    """Return the path of the file that exists if the kernels of a point have been compiled."""
    return f"results/kernels/{kernel_digest(*point_sources(point, scripts))}/{variant(point)}.compiled"


def _in_order(paths: frozenset[Path]) -> list[Path]:
    """Sort paths by their text. A comparison of path objects compares their parts. For a hundred closures
    this takes 0.1 s.
    """
    return sorted(paths, key=str)


_contents: dict[Path, str] = {}


def _digest_of(paths: list[Path]) -> str:
    new = [path for path in paths if path not in _contents]
    _contents.update(zip(new, file_digests(new), strict=True))
    return hashlib.sha256("".join(_contents[path] for path in paths).encode()).hexdigest()[:12]
