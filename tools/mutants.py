"""Plant errors in gaspart, one at a time, and count those that tests catch: `python tools/mutants.py --help`.

An error is a small change of the source: another sign, constant, comparison, index or argument, or a
statement that is left out. The tests of a package are its mirror in `tests` and the files that name something
of the changed module, the mirror first. Kernels run as plain Python, so that none is compiled.
"""

import argparse
import ast
import csv
import os
import random
import re
import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from dataclasses import asdict, dataclass
from pathlib import Path

PROJECT = Path(__file__).parents[1]
PACKAGE = Path("src/gaspart")
PACKAGES = [
    "kernels",
    "engines",
    "state",
    "analysis",
    "theory",
    "accuracy",
    "trajectory",
    "scene",
    "reproduction",
]
PACKAGES += ["inspection", "cli"]
COMPILED = {"test": "not thorough and not interpreted", "test-all": "not interpreted"}
"""Expression of pytest for the tests of a tier whose kernels are compiled."""
TEXTUAL = ("tests/style/", "tests/workflow/", "tests/test_code_rules.py", "tests/test_project.py")
"""Tests that read the text of sources, or run the whole workflow: neither notices a wrong number."""
LIMITED = [
    "/bin/bash",
    "-c",
    'ulimit -t 600; exec "$@"',
    "-",
]  # s of processor time for the tests of one error
SWAP = {ast.Add: ast.Sub, ast.Sub: ast.Add, ast.Mult: ast.Div, ast.Div: ast.Mult}
COMPARE = {ast.Lt: ast.GtE, ast.LtE: ast.Gt, ast.Gt: ast.LtE, ast.GtE: ast.Lt, ast.Eq: ast.NotEq}
STRICT = {ast.Lt: ast.LtE, ast.LtE: ast.Lt, ast.Gt: ast.GtE, ast.GtE: ast.Gt}
CALLS = {
    "min": "max",
    "max": "min",
    "minimum": "maximum",
    "maximum": "minimum",
    "floor": "ceil",
    "any": "all",
}
CALLS |= {"all": "any", "sin": "cos", "cos": "sin", "nanmin": "nanmax", "nanmax": "nanmin"}


@dataclass
class Mutant:
    """A piece of a source file and what replaces it."""

    package: str
    path: str
    line: int
    kind: str
    old: str
    new: str
    start: int
    end: int


def changes(tree: ast.AST) -> Iterator[tuple[str, ast.AST, ast.AST | str]]:
    """Yield the kind of each error, the node that it changes, and the node or text in its place."""
    for function in (node for node in ast.walk(tree) if isinstance(node, ast.FunctionDef)):
        names = [argument.arg for argument in function.args.args if argument.arg not in ("self", "cls")]
        for statement in function.body:
            for node in ast.walk(statement):
                yield from of_expression(node)
                yield from of_statement(node)
                if isinstance(node, ast.Name) and isinstance(node.ctx, ast.Load) and node.id in names:
                    yield from (("argument", node, ast.Name(other)) for other in names if other != node.id)


def of_expression(node: ast.AST) -> Iterator[tuple[str, ast.AST, ast.AST | str]]:
    """Yield the errors of an expression."""
    if isinstance(node, ast.BinOp) and type(node.op) in SWAP:
        yield "sign", node, ast.BinOp(node.left, SWAP[type(node.op)](), node.right)
        if isinstance(node.op, ast.Add | ast.Sub):
            yield "missing term", node, node.left
    if isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.USub):
        yield "sign", node, node.operand
    if isinstance(node, ast.Compare) and len(node.ops) == 1:
        for table in (COMPARE, STRICT):
            if type(node.ops[0]) in table:
                yield (
                    "comparison",
                    node,
                    ast.Compare(node.left, [table[type(node.ops[0])]()], node.comparators),
                )
    if isinstance(node, ast.Constant) and type(node.value) in (int, float):
        yield (
            "constant",
            node,
            ast.Constant(1.02 * node.value if type(node.value) is float else node.value + 1),
        )
    if isinstance(node, ast.Subscript) and isinstance(node.slice, ast.Name):
        yield "index", node.slice, ast.BinOp(node.slice, ast.Sub(), ast.Constant(1))
    if isinstance(node, ast.BoolOp):
        yield (
            "condition",
            node,
            ast.BoolOp(ast.Or() if isinstance(node.op, ast.And) else ast.And(), node.values),
        )
    if isinstance(node, ast.Name) and isinstance(node.ctx, ast.Load) and node.id in CALLS:
        yield "function", node, ast.Name(CALLS[node.id])
    if isinstance(node, ast.Attribute) and node.attr in CALLS:
        yield "function", node, ast.Attribute(node.value, CALLS[node.attr])


def of_statement(node: ast.AST) -> Iterator[tuple[str, ast.AST, ast.AST | str]]:
    """Yield the errors of a statement."""
    if isinstance(node, ast.AugAssign) and type(node.op) in SWAP:
        yield "sign", node, ast.AugAssign(node.target, SWAP[type(node.op)](), node.value)
    if isinstance(node, ast.If) and not isinstance(node.test, ast.Compare):
        yield "condition", node.test, ast.UnaryOp(ast.Not(), node.test)
    called = isinstance(node, ast.Expr) and isinstance(node.value, ast.Call)
    if called or isinstance(node, ast.AugAssign | ast.Raise | ast.Continue | ast.Break):
        yield "missing statement", node, "pass"


def mutants_of(path: Path) -> Iterator[Mutant]:
    """Yield all errors of a file that change its syntax tree."""
    text = path.read_text(encoding="utf-8")
    tree, lines = ast.parse(text), text.splitlines(keepends=True)
    starts = [0]
    for line in lines:
        starts.append(starts[-1] + len(line))

    def place(line: int, column: int) -> int:
        return starts[line - 1] + len(lines[line - 1].encode()[:column].decode())

    texts = [node for node in ast.walk(tree) if isinstance(node, ast.JoinedStr | ast.Raise)]
    skipped = {id(part) for node in texts for part in ast.walk(node) if part is not node}
    relative = path.relative_to(PROJECT)
    for kind, node, new in changes(tree):
        if id(node) in skipped:
            continue
        span = place(node.lineno, node.col_offset), place(node.end_lineno, node.end_col_offset)
        code = new if isinstance(new, str) else ast.unparse(ast.fix_missing_locations(new))
        code = f"({code})" if isinstance(new, ast.expr) else code
        old = text[slice(*span)]
        yield Mutant(relative.parts[2], str(relative), node.lineno, kind, old, code, *span)


def sample(number: int, seed: int, packages: list[str]) -> list[Mutant]:
    """Draw errors: from packages in turn, of kinds in turn, at most one of a line."""
    drawn, lines, turn = [], set(), 0
    pools = {name: pool(name, random.Random(f"{seed} {name}")) for name in packages}
    while len(drawn) < number:
        mutant = next(pools[packages[turn % len(packages)]])
        if (mutant.path, mutant.line) not in lines:
            lines.add((mutant.path, mutant.line))
            drawn.append(mutant)
            turn += 1
    return drawn


def pool(package: str, rng: random.Random) -> Iterator[Mutant]:
    """Yield the errors of a package in random order, of each kind in turn."""
    by_kind: dict[str, list[Mutant]] = {}
    for path in sorted((PROJECT / PACKAGE / package).rglob("*.py")):
        if "compile" not in path.parts:
            for mutant in mutants_of(path):
                by_kind.setdefault(mutant.kind, []).append(mutant)
    while by_kind:
        for kind in sorted(by_kind):
            yield by_kind[kind].pop(rng.randrange(len(by_kind[kind])))
        by_kind = {kind: rest for kind, rest in by_kind.items() if rest}


def test_files(mutant: Mutant) -> list[str]:
    """Return the files of tests that may notice an error, the mirror of its package first."""
    path = Path(mutant.path)
    tree = ast.parse((PROJECT / path).read_text(encoding="utf-8"))
    public = [node.name for node in tree.body if isinstance(node, ast.FunctionDef | ast.ClassDef)]
    words = [name for name in public if not name.startswith("_")] + [".".join(path.with_suffix("").parts[1:])]
    named = re.compile(r"\b(" + "|".join(map(re.escape, words)) + r")\b")
    mirror = Path("tests", *path.parts[2:-1])
    while not any((PROJECT / mirror).glob("test_*.py")):
        mirror = mirror.parent
    same = mirror / f"test_{path.stem}.py"
    found = []
    for file in sorted((PROJECT / "tests").rglob("test_*.py")):
        relative = file.relative_to(PROJECT)
        if "referees" in relative.parts or str(relative).startswith(TEXTUAL):
            continue
        near = relative.is_relative_to(mirror)
        if near or named.search(file.read_text(encoding="utf-8")):
            found.append((relative != same, not near, file.stat().st_size, str(relative)))
    return [name for *_, name in sorted(found)]


def judge(mutant: Mutant, tier: str, copy: Path) -> str:
    """Return the first test of a tier that fails with an error, "" if none does."""
    target = copy / mutant.path
    before = target.read_text(encoding="utf-8")
    target.write_text(before[: mutant.start] + mutant.new + before[mutant.end :], encoding="utf-8")
    plain = {**os.environ, "PYTHONPATH": str(copy / "src"), "PYTHONDONTWRITEBYTECODE": "1"}
    plain["NUMBA_DISABLE_JIT"] = "1"
    interpreted = (
        "interpreted" if tier == "test" or mutant.package != "kernels" else "interpreted or thorough"
    )
    runs = [(plain, interpreted)]
    if mutant.package != "kernels":
        runs.insert(0, ({name: plain[name] for name in plain if name != "NUMBA_DISABLE_JIT"}, COMPILED[tier]))
    command = [sys.executable, "-m", "pytest", "-x", "-q", "--tb=no", "-p", "no:cacheprovider", "-n0", "-m"]
    try:
        for environment, expression in runs:
            done = subprocess.run(
                [*LIMITED, *command, expression, *test_files(mutant)],
                cwd=copy,
                env=environment,
                capture_output=True,
                text=True,
            )
            if failed := re.search(r"^(?:FAILED|ERROR) (\S+)", done.stdout, re.MULTILINE):
                return failed[1]
            if done.returncode not in (0, 5):  # 5: no test of this tier
                return f"exit code {done.returncode}"
    finally:
        target.write_text(before, encoding="utf-8")
    return ""


def main() -> None:
    """Judge a sample of errors, and print the fraction that is caught in each package."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("number", type=int, help="number of errors")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--tier", choices=COMPILED, default="test")
    parser.add_argument("--packages", nargs="+", default=PACKAGES)
    parser.add_argument("-o", "--output", default="mutants.csv", help="table of errors, one a row")
    options = parser.parse_args()
    caught: dict[str, list[bool]] = {}
    with tempfile.TemporaryDirectory() as folder, open(options.output, "w", newline="") as file:
        files = subprocess.run(["git", "ls-files", "-z"], cwd=PROJECT, capture_output=True, check=True).stdout
        for name in files.decode().split("\0")[:-1]:
            (Path(folder) / name).parent.mkdir(parents=True, exist_ok=True)
            shutil.copy(PROJECT / name, Path(folder) / name)
        table = csv.writer(file)
        table.writerow(["package", "path", "line", "kind", "old", "new", "caught by", "seconds"])
        for mutant in sample(options.number, options.seed, options.packages):
            start = time.perf_counter()
            by = judge(mutant, options.tier, Path(folder))
            row = [value for key, value in asdict(mutant).items() if key not in ("start", "end")]
            table.writerow([*row, by, f"{time.perf_counter() - start:.1f}"])
            file.flush()
            caught.setdefault(mutant.package, []).append(bool(by))
    for package, values in sorted(caught.items()):
        print(f"{package}: {sum(values)} of {len(values)} caught")
    every = [value for values in caught.values() for value in values]
    print(f"all: {sum(every)} of {len(every)} caught by `make {options.tier}`")


if __name__ == "__main__":
    main()
