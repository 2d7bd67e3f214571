"""The size of functions, for which ruff has no rule: it counts statements, not lines."""

import ast
import re
from pathlib import Path

PACKAGE = Path(__file__).parents[1] / "src" / "gaspart"
MOST_LINES = 60


WITH_DOCSTRING = ast.FunctionDef | ast.AsyncFunctionDef | ast.ClassDef


def code_lines(function):
    """Return the number of lines of a function without docstrings: with them the limit forbids numpydoc."""
    texts = [node.body[0] for node in ast.walk(function) if isinstance(node, WITH_DOCSTRING)]
    texts = [text for text in texts if isinstance(text, ast.Expr) and isinstance(text.value, ast.Constant)]
    lines = function.end_lineno - function.lineno + 1
    return lines - sum(text.end_lineno - text.lineno + 1 for text in texts)


def long_functions(text):
    """Names of the functions in a module's text that are longer than the limit."""
    functions = (node for node in ast.walk(ast.parse(text)) if isinstance(node, ast.FunctionDef))
    return [one.name for one in functions if code_lines(one) > MOST_LINES]


def test_the_limit_is_noticed_and_counts_no_docstring():
    text = '    """Do nothing.\n' + "\n" * MOST_LINES + '    """\n'
    assert long_functions(f"def short():\n{text}" + "    pass\n" * (MOST_LINES - 1)) == []
    assert long_functions(f"def long():\n{text}" + "    pass\n" * MOST_LINES) == ["long"]


def test_functions_are_short():
    texts = {path: path.read_text(encoding="utf-8") for path in PACKAGE.rglob("*.py")}
    assert {path: names for path, text in texts.items() if (names := long_functions(text))} == {}


def homes(texts):
    """{function or class: names of the modules and packages that have it}, and other names in docstrings: of
    modules, of what classes have, and of what other libraries have."""
    at, others = {}, {path.stem for path in texts} | {"field", "resolve"}
    for path, text in texts.items():
        tree = ast.parse(text)
        for node in tree.body:
            if isinstance(node, WITH_DOCSTRING):
                at.setdefault(node.name, {"gp"}).update(("gaspart", *path.parts[:-1], path.stem))
        for node in ast.walk(tree):
            inner = node.body if isinstance(node, ast.ClassDef) else ()
            others |= {
                getattr(part, "name", getattr(getattr(part, "target", None), "id", "")) for part in inner
            }
    return at, others


def dead_references(text, at, others):
    """Names `module.function` in backticks whose module does not have the function."""
    dotted = re.findall(r"(?<!`)`(?:\w+\.)*(\w+)\.(\w+)`(?!`)", text)
    functions = at.keys() - others
    return [f"{first}.{last}" for first, last in dotted if last in functions and first not in at[last]]


def test_docstrings_name_functions_where_they_are():
    """A module that was joined to another leaves its name in texts, which no tool reads."""
    files = {path.relative_to(PACKAGE): path.read_text(encoding="utf-8") for path in PACKAGE.rglob("*.py")}
    at, others = homes(files)
    text = "See `boltzmann.tagged_paths`, not `homogeneous.tagged_paths`."
    assert dead_references(text, at, others) == ["homogeneous.tagged_paths"]
    dead = {path: names for path, text in files.items() if (names := dead_references(text, at, others))}
    assert dead == {}
