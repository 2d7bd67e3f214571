"""The size of functions, for which ruff has no rule: it counts statements, not lines."""

import ast
import builtins
import dis
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


BY_SNAKEMAKE = {"config", "expand", "local", "report", "storage", "workflow"}
"""Names that Snakemake gives to the files of a workflow."""


def global_names(code):
    """The global names that a function reads, with the functions inside it."""
    inner = [one for one in code.co_consts if hasattr(one, "co_code")]
    read = {i.argval for i in dis.get_instructions(code) if i.opname in ("LOAD_GLOBAL", "LOAD_NAME")}
    return read.union(*map(global_names, inner)) - {code.co_name}


def test_functions_of_the_workflow_read_names_that_exist():
    """No linter reads them, and some run on a cluster only."""
    workflow = PACKAGE.parents[1] / "workflow"
    files = [*sorted(workflow.glob("rules/*.smk")), workflow / "Snakefile"]
    text = "\n".join(path.read_text(encoding="utf-8") for path in files)
    known = {*dir(builtins), *BY_SNAKEMAKE, *re.findall(r"^def (\w+)", text, re.M)}
    for line in re.findall(r"^ *(?:from [\w.]+ )?import (.+)", text, re.M):
        known |= {name.split(" as ")[-1].strip() for name in line.split(",")}
    for targets in re.findall(r"^ *(\w+(?:, \w+)*) = ", text, re.M):
        known |= set(targets.split(", "))
    functions = re.findall(r"^def .+\n(?:(?: .*)?\n)+", text, re.M)
    assert len(functions) > 20
    for function in functions:
        for code in compile(function, "workflow", "exec").co_consts:
            if hasattr(code, "co_code"):
                assert global_names(code) <= known, (code.co_name, global_names(code) - known)
