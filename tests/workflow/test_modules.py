"""The table of modules in workflow/rules/common.smk against the import graph of the scripts."""

import ast
import re
from functools import cache
from pathlib import Path

import pytest

from gaspart.planning.families import FAMILIES

ROOT = Path(__file__).parents[2]
SOURCE = ROOT / "src/gaspart"
# What a script loads by a name that is put together: package by stage.
BY_NAME = {"measure": "measure", "judge": "claims", "draw": "figures"}


def table():
    """MODULES, FAMILY_MODULES and what they are made of, as the rules see them."""
    text = (ROOT / "workflow/rules/common.smk").read_text()
    block = text[text.index("SCENE = [") : text.index("def module_files(")]
    names = {}
    for statement in ast.parse(block).body:
        names[statement.targets[0].id] = eval(ast.unparse(statement.value), {}, names)
    return names


def path_of(module):
    """The file of `gaspart` or `gaspart.x.y`, or None if there is none."""
    base = SOURCE.joinpath(*module.split(".")[1:])
    for path in (base / "__init__.py", base.with_suffix(".py")):
        if path.exists():
            return path
    return None


class _Runs(ast.NodeTransformer):
    """Leaves out what is imported for type hints only, on which no result depends."""

    def visit_If(self, node):
        return None if ast.unparse(node.test) == "TYPE_CHECKING" else node


def imported(path):
    """Modules of gaspart that a file imports, anywhere in it, with the packages they lie in."""
    package = "gaspart." + ".".join(path.relative_to(SOURCE).parts[:-1]) if SOURCE in path.parents else ""
    found = set()
    for node in ast.walk(_Runs().visit(ast.parse(path.read_text()))):
        if isinstance(node, ast.Import):
            found |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            base = node.module or ""
            if node.level:
                base = ".".join(filter(None, [package.rstrip("."), base]))
            found.add(base)
            found |= {f"{base}.{alias.name}" for alias in node.names}
    found = {name for name in found if name.split(".")[0] == "gaspart" and path_of(name)}
    parents = {".".join(name.split(".")[:n]) for name in found for n in range(1, len(name.split(".")))}
    return found | parents


@cache
def closure(path):
    """Files of gaspart that a file needs, whatever the way."""
    seen, queue = set(), [path]
    while queue:
        for name in imported(queue.pop()):
            module = path_of(name)
            if module not in seen:
                seen.add(module)
                queue.append(module)
    return seen


def needed(stage, family=None):
    files = set(closure(ROOT / f"workflow/scripts/{stage}.py")) | set(
        closure(ROOT / "workflow/scripts/_job.py")
    )
    if family:
        module = SOURCE / BY_NAME[stage] / f"{family}.py"
        files |= {module, *closure(module), SOURCE / BY_NAME[stage] / "__init__.py"}
        files |= closure(SOURCE / BY_NAME[stage] / "__init__.py")
    return {str(path.relative_to(SOURCE)) for path in files}


def listed(stage, family=None, whole_packages=True):
    tables = table()
    names = tables["MODULES"][stage] + tables["FAMILY_MODULES"].get((stage, family), [])
    names = [name for name in names if whole_packages or "*" not in name]
    return {
        str(path.relative_to(SOURCE))
        for name in names
        for path in SOURCE.glob(f"{name.format(family=family)}.py")
    }


FAMILY_NAMES = sorted(set(FAMILIES.values()))


@pytest.mark.parametrize("stage", [stage for stage in table()["MODULES"] if stage not in BY_NAME])
def test_a_stage_lists_the_modules_it_uses(stage):
    assert listed(stage) == needed(stage)


@pytest.mark.parametrize("stage", BY_NAME)
def test_a_stage_of_families_lists_what_each_uses_and_nothing_that_none_uses(stage):
    for family in FAMILY_NAMES:
        assert needed(stage, family) <= listed(stage, family), family
    used = set().union(*(needed(stage, family) for family in FAMILY_NAMES))
    assert set().union(*(listed(stage, family, whole_packages=False) for family in FAMILY_NAMES)) <= used


def test_every_rule_states_what_it_needs():
    for file in (ROOT / "workflow/rules").glob("*.smk"):
        for rule in re.split(r"^(?:rule|checkpoint) ", file.read_text(), flags=re.MULTILINE)[1:]:
            name = rule.split(":")[0]
            stated = set(re.findall(r"^    (\w+):", rule, re.MULTILINE))
            wanted = {"output", "log", "benchmark", "threads", "resources"}
            if name != "warm":  # which may have none: see there
                wanted |= {"input"}
            assert wanted <= stated, (file.name, name)
            assert "mem_mb=" in rule, name
            assert "runtime=" in rule, name
            script = ROOT / f"workflow/scripts/{name}.py"
            assert script.exists()
            assert f"scripts/{name}.py" in rule
