"""Departures of docstrings and names from the rules of the style that ruff and numpydoc do not have.

Each rule is a function of a module's syntax tree; `docs/contributing.md` has the rules with their reasons.
"""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

LONGEST_SUMMARY = 16
"""Maximum number of words in a summary line."""
_OPENINGS = re.compile(
    r"(Whether|What|How|One|Of|By|That|Those|With|Where|Which|When|As|So|Its|Their|The same|Let|From)\b"
)
_WORDS = re.compile(
    r"\b(that of|those of|over (?:that|those)|so many|beside|besides|likewise|as of|is none|are none|all else"
    r"|nothing else|in turn|by whatever|whatever it is|come to be|far from it)\b",
    re.IGNORECASE,
)
_ARGUMENT_IN_PROSE = re.compile(r"(?:^|[.;] )(?!http)[a-z_]+(?: \([^)]*\))?: [a-z]", re.MULTILINE)
_LIST_OF_ARGUMENTS = re.compile(r"^(Parameters|Attributes)$", re.MULTILINE)
_PARTICIPLE = re.compile(r"_?(?:as_)?[a-z]+(?:ed|own|ought|aken|iven|ound|eld|ept|een|rawn)$")
_NO_PARTICIPLES = {"bound", "field", "need", "seed", "speed"}
_VAGUE = {
    "asked", "found", "given", "known", "left", "made", "needed", "one", "place", "places", "shown", "taken",
    "thing", "wanted", "what", "whole", "why", "word",
}  # fmt: skip


@dataclass(frozen=True)
class Departure:
    """Violation of a rule at a line of a file."""

    rule: str
    path: Path
    line: int
    text: str

    def __str__(self) -> str:
        return f"{self.path}:{self.line}: {self.rule}: {self.text[:100]}"


def departures(path: Path) -> list[Departure]:
    """Return the violations of a module."""
    tree = ast.parse(path.read_text(encoding="utf-8"))
    rows = [*_of_docstrings(tree), *_of_constants(tree), *_of_variables(tree)]
    return [Departure(rule, path, line, text) for rule, line, text in rows]


def _of_docstrings(tree: ast.Module) -> Iterator[tuple[str, int, str]]:
    """Yield rule, line and text for the module, its classes, functions and properties."""
    for kind, node in _definitions(tree):
        text = ast.get_docstring(node) or ""
        line, name = getattr(node, "lineno", 1), getattr(node, "name", "")
        first = text.split("\n\n")[0].strip()
        summary = " ".join(first.split())
        if _OPENINGS.match(summary):
            yield "opening", line, summary
        if "\n" in first:
            yield "summary of several lines", line, summary
        elif len(summary.split()) > LONGEST_SUMMARY:
            yield "long summary", line, summary
        if match := _WORDS.search(text):
            yield "odd word", line, match[0]
        if (match := _ARGUMENT_IN_PROSE.search(text)) and not _LIST_OF_ARGUMENTS.search(text):
            yield "argument in prose", line, match[0].strip()
        if not isinstance(node, ast.FunctionDef) or kind == "property":
            continue
        if _PARTICIPLE.fullmatch(name) and name.strip("_") not in _NO_PARTICIPLES:
            yield "participle as a name", line, name


def _definitions(tree: ast.Module) -> Iterator[tuple[str, ast.Module | ast.ClassDef | ast.FunctionDef]]:
    """Yield the kind and the node of the module and of all classes and functions in it."""
    yield "module", tree
    for node in ast.walk(tree):
        if isinstance(node, ast.ClassDef):
            yield "class", node
        elif isinstance(node, ast.FunctionDef):
            is_property = any("property" in ast.unparse(mark) for mark in node.decorator_list)
            yield "property" if is_property else "function", node


def _of_constants(tree: ast.Module) -> Iterator[tuple[str, int, str]]:
    """Yield rule, line and text for the docstrings of module constants."""
    for first, second in zip(tree.body, tree.body[1:], strict=False):
        assigned = isinstance(first, ast.Assign | ast.AnnAssign)
        if assigned and isinstance(second, ast.Expr) and isinstance(second.value, ast.Constant):
            text = str(second.value.value).strip()
            if _OPENINGS.match(text):
                yield "opening", second.lineno, text


def _of_variables(tree: ast.Module) -> Iterator[tuple[str, int, str]]:
    """Yield rule, line and text for variables and arguments whose names say nothing."""
    for node in ast.walk(tree):
        if isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store) and node.id in _VAGUE:
            yield "vague variable", node.lineno, node.id
        elif isinstance(node, ast.arg) and node.arg in _VAGUE:
            yield "vague variable", node.lineno, node.arg
