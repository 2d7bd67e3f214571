"""The size of the code: functions are short, have few arguments, and few modules lie at the top level."""

import ast
from pathlib import Path

PACKAGE = Path(__file__).parents[1] / "src" / "gaspart"
MOST_LINES = 60
MOST_ARGUMENTS = 8
MOST_MODULES = 8
EXCEPTIONS = {
    "trajectory.run.run": "public: six positional arguments, and the others are keywords",
    "rendering.films.film": "public: two positional arguments, and the others are keywords",
}
"""Functions that exceed a limit, each with the reason."""


def is_too_large(function):
    """Whether a function exceeds a limit, its docstring included."""
    arguments = function.args
    count = len(arguments.posonlyargs) + len(arguments.args) + len(arguments.kwonlyargs)
    lines = function.end_lineno - function.lineno + 1
    return lines > MOST_LINES or count > MOST_ARGUMENTS


def large_functions(text):
    """Names of the functions in a module's text that exceed a limit."""
    functions = (node for node in ast.walk(ast.parse(text)) if isinstance(node, ast.FunctionDef))
    return [function.name for function in functions if is_too_large(function)]


def test_the_limits_are_noticed():
    names = ", ".join(f"a{n}" for n in range(MOST_ARGUMENTS))
    assert large_functions(f"def few({names}): pass") == []
    assert large_functions(f"def many({names}, *, b): pass") == ["many"]
    assert large_functions("def short():" + "\n    pass" * (MOST_LINES - 1)) == []
    assert large_functions("def long():" + "\n    pass" * MOST_LINES) == ["long"]


def test_functions_are_short_and_have_few_arguments():
    found = set()
    for path in PACKAGE.rglob("*.py"):
        module = ".".join(path.relative_to(PACKAGE).with_suffix("").parts)
        found |= {f"{module}.{name}" for name in large_functions(path.read_text(encoding="utf-8"))}
    assert found == EXCEPTIONS.keys(), "the second set has entries that are not needed any more"


def test_there_are_few_modules_at_the_top_level():
    assert len(list(PACKAGE.glob("*.py"))) <= MOST_MODULES
