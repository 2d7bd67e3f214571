"""The size of functions, for which ruff has no rule: it counts statements, not lines."""

import ast
from pathlib import Path

PACKAGE = Path(__file__).parents[1] / "src" / "gaspart"
MOST_LINES = 60


def long_functions(text):
    """Names of the functions in a module's text that are longer than the limit, docstrings included."""
    functions = (node for node in ast.walk(ast.parse(text)) if isinstance(node, ast.FunctionDef))
    return [one.name for one in functions if one.end_lineno - one.lineno + 1 > MOST_LINES]


def test_the_limit_is_noticed():
    assert long_functions("def short():" + "\n    pass" * (MOST_LINES - 1)) == []
    assert long_functions("def long():" + "\n    pass" * MOST_LINES) == ["long"]


def test_functions_are_short():
    texts = {path: path.read_text(encoding="utf-8") for path in PACKAGE.rglob("*.py")}
    assert {path: names for path, text in texts.items() if (names := long_functions(text))} == {}
