"""The size of functions without their docstrings. The rule of ruff counts statements, not lines."""

import ast
from pathlib import Path

PACKAGE = Path(__file__).parents[1] / "src" / "gaspart"
MOST_LINES = 60


def lines_of_code(function):
    """Return the number of lines of a function without those of its docstring."""
    first = function.body[0]
    docstring = first.end_lineno - first.lineno + 1 if ast.get_docstring(function) is not None else 0
    return function.end_lineno - function.lineno + 1 - docstring


def long_functions(text):
    """Return the names of the functions in a module's text that are longer than the limit."""
    functions = (node for node in ast.walk(ast.parse(text)) if isinstance(node, ast.FunctionDef))
    return [function.name for function in functions if lines_of_code(function) > MOST_LINES]


def test_the_limit_is_noticed():
    assert long_functions("def short():" + "\n    pass" * (MOST_LINES - 1)) == []
    assert long_functions("def long():" + "\n    pass" * MOST_LINES) == ["long"]
    documented = 'def f():\n    """Return it.\n\n    Notes.\n    """' + "\n    pass" * (MOST_LINES - 1)
    assert long_functions(documented) == [] and long_functions(documented + "\n    pass") == ["f"]


def test_functions_are_short():
    texts = {path: path.read_text(encoding="utf-8") for path in PACKAGE.rglob("*.py")}
    assert {path: names for path, text in texts.items() if (names := long_functions(text))} == {}
