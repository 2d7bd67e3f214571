"""The size of functions, for which ruff has no rule: it counts statements, not lines."""

import ast
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
