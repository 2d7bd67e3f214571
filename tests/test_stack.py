"""Surprises of numba, Snakemake, scipy, xarray and freud: each search for one finds a planted one."""

import ast
import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
PACKAGE, RULES = ROOT / "src/gaspart", ROOT / "workflow/rules"
UNSIGNED = "uint64"


def texts(folder, pattern="*.py"):
    return {path.relative_to(ROOT): path.read_text(encoding="utf-8") for path in folder.rglob(pattern)}


def in_all(search, folder, pattern="*.py"):
    """What a search finds in the files of a folder, by file."""
    return {str(path): found for path, text in texts(folder, pattern).items() if (found := search(text))}


def name_of(call):
    """The last part of the name of a function that is called."""
    return getattr(call.func, "attr", getattr(call.func, "id", ""))


def is_negative(node):
    return isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.USub)


# numba


def negated_parallel_indices(text):
    """Lines with -i, of the index of a `for i in prange(...)`: it is unsigned there, and -1 is 2^64 - 1."""
    loops = [one for one in ast.walk(ast.parse(text)) if isinstance(one, ast.For)]
    parallel = [one for one in loops if isinstance(one.iter, ast.Call) and name_of(one.iter) == "prange"]
    return [
        node.lineno
        for loop in parallel
        for node in ast.walk(loop)
        if is_negative(node) and isinstance(node.operand, ast.Name) and node.operand.id == loop.target.id
    ]


def negative_powers_of_integers(text):
    """Lines with x ** -n: of an integer x it is not a fraction in compiled code. Powers of floats that are
    written with a point are none of these."""
    powers = (one for one in ast.walk(ast.parse(text)) if isinstance(one, ast.BinOp))
    return [
        one.lineno
        for one in powers
        if isinstance(one.op, ast.Pow)
        and is_negative(one.right)
        and not (isinstance(one.left, ast.Constant) and isinstance(one.left.value, float))
        and not (isinstance(one.right.operand, ast.Constant) and isinstance(one.right.operand.value, float))
    ]


def unsigned_with_literals(text):
    """Lines that add a plain literal to a variable that is made by uint64(...): the result is a float."""
    found = []
    for function in (one for one in ast.walk(ast.parse(text)) if isinstance(one, ast.FunctionDef)):
        made = {
            target.id
            for one in ast.walk(function)
            if isinstance(one, ast.Assign)
            and isinstance(one.value, ast.Call)
            and name_of(one.value) == UNSIGNED
            for target in one.targets
            if isinstance(target, ast.Name)
        }
        for one in ast.walk(function):
            sides = [one.left, one.right] if isinstance(one, ast.BinOp) else []
            sides = [one.target, one.value] if isinstance(one, ast.AugAssign) else sides
            names = any(isinstance(side, ast.Name) and side.id in made for side in sides)
            if names and any(isinstance(side, ast.Constant) for side in sides):
                found.append(one.lineno)
    return found


def histograms(text):
    """Lines that call np.histogram, which treats the last edge otherwise in compiled code."""
    calls = (one for one in ast.walk(ast.parse(text)) if isinstance(one, ast.Call))
    return [one.lineno for one in calls if name_of(one) == "histogram"]


@pytest.mark.parametrize(
    ("search", "wrong", "right"),
    [
        (
            negated_parallel_indices,
            "for i in prange(n):\n    a[-i] = 1",
            "for i in prange(n):\n    a[n - i] = -n\nfor j in range(n):\n    a[-j] = 1",
        ),
        (negative_powers_of_integers, "y = n ** -2", "y = 2.0 ** -40 + x ** 2 + x ** -2.0"),
        (
            unsigned_with_literals,
            "def f():\n    k = uint64(3)\n    return k + 1",
            "def f():\n    k = uint64(3)\n    return k + uint64(1) + n + 1",
        ),
        (histograms, "np.histogram(x, 3)", "np.searchsorted(edges, x)"),
    ],
)
def test_kernels_avoid_what_numba_translates_otherwise(search, wrong, right):
    assert search(wrong) and not search(right)
    assert in_all(search, PACKAGE / "kernels") == {}


# Snakemake


def parameters_of_jobs(text, functions):
    """Parameters whose functions take more than wildcards: input, output or threads are no trigger to rerun.

    functions: the arguments of the functions of all rules, by name.
    """
    found = []
    for block in re.findall(r"^    params:\n((?:        .*\n|\n)+)", text, re.M):
        for arguments in re.findall(r"lambda ([\w, ]*):", block):
            found += [name for name in map(str.strip, arguments.split(",")) if name != "wildcards"]
        for name in re.findall(r"=(\w+),$", block, re.M):
            found += [argument for argument in functions.get(name, []) if argument != "wildcards"]
    return found


def functions_of_rules():
    """Arguments of the functions that the rules define."""
    definitions = re.findall(r"^def (\w+)\(([^)]*)\):", "\n".join(texts(RULES, "*.smk").values()), re.M)
    return {name: [word.split("=")[0].strip() for word in given.split(",")] for name, given in definitions}


def test_parameters_of_rules_depend_on_wildcards_alone():
    functions = functions_of_rules()
    assert "settings_of" in functions
    planted = "rule a:\n    params:\n        n=lambda wildcards, threads: threads,\n        m=of_input,\n"
    assert parameters_of_jobs(planted, {"of_input": ["wildcards", "input"]}) == ["threads", "input"]
    found = in_all(lambda text: parameters_of_jobs(text, functions), RULES, "*.smk")
    # on purpose, as its comment says: nothing but a missing stamp runs it
    assert found == {"workflow/rules/warm.smk": ["threads"]}


# scipy, xarray, freud

EXPLICIT = {
    "concat": {"join", "compat"},
    "merge": {"join", "compat"},
    "curve_fit": {"sigma", "absolute_sigma"},
    "RDF": {"r_min", "normalization_mode"},
    "Steinhardt": {"average", "wl", "weighted", "wl_normalize"},
    "Hexatic": {"k", "weighted"},
}
"""Arguments whose defaults decide the result, or will change, by the name of the function."""


def left_to_defaults(text):
    """Calls that leave such an argument out."""
    calls = (one for one in ast.walk(ast.parse(text)) if isinstance(one, ast.Call))
    return [
        f"{name_of(one)} in line {one.lineno}"
        for one in calls
        if isinstance(one.func, ast.Attribute) or name_of(one) == "curve_fit"
        if not EXPLICIT.get(name_of(one), set()) <= {keyword.arg for keyword in one.keywords}
    ]


def test_defaults_of_other_packages_are_passed_explicitly():
    assert left_to_defaults("xr.concat(parts, 'a', join='outer')") == ["concat in line 1"]
    assert left_to_defaults("xr.concat(parts, 'a', join='outer', compat='equals')") == []
    assert in_all(left_to_defaults, PACKAGE) == {}
