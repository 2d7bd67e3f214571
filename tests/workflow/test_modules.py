"""What each stage of the workflow is made of. In which direction imports lead, pyproject.toml states."""

import ast
import re
import subprocess
import sys
from functools import cache
from pathlib import Path

from gaspart.reproduction.points.modules import PACKAGE, closure, find_imports, measuring_digest
from gaspart.reproduction.registry import modules

ROOT = Path(__file__).parents[2]


class _Runs(ast.NodeTransformer):
    """Leaves out what is imported for type hints only, on which no result depends."""

    def visit_If(self, node):
        return None if ast.unparse(node.test) == "TYPE_CHECKING" else node


@cache
def reexported(package):
    """The module of each name in the stub of a package, if it has one."""
    stub = PACKAGE.joinpath(*package.split(".")[1:], "__init__.pyi")
    nodes = ast.parse(stub.read_text(encoding="utf-8")).body if stub.exists() else []
    return {node.names[0].name: node.module for node in nodes if isinstance(node, ast.ImportFrom)}


def parsed(path):
    """Files that a file imports, found by a parser."""
    names = set()
    for node in ast.walk(_Runs().visit(ast.parse(path.read_text(encoding="utf-8")))):
        if isinstance(node, ast.Import):
            names |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            assert not node.level, f"{path}:{node.lineno}: `imported` follows absolute imports only"
            names |= {node.module} | {f"{node.module}.{alias.name}" for alias in node.names}
            if not node.module.startswith("gaspart"):
                continue  # itertools.compress is not gaspart.compress
            for alias in node.names:
                names |= set(reexported(f"{node.module}.{alias.name}").values())
                names |= {reexported(node.module).get(alias.name, node.module)}
    names = {name for name in names if name.split(".")[0] == "gaspart"}
    names |= {".".join(name.split(".")[:n]) for name in names for n in range(1, name.count(".") + 1)}
    places = [PACKAGE.joinpath(*name.split(".")[1:]) for name in names]
    files = [file for place in places for file in (place / "__init__.py", place.with_suffix(".py"))]
    return {file for file in files if file.is_file()}


def test_the_imports_that_are_searched_for_are_those_that_a_parser_finds():
    for path in [*PACKAGE.rglob("*.py"), *(ROOT / "workflow/scripts").glob("*.py")]:
        assert find_imports(path) == parsed(path), path


def test_tables_are_part_of_what_reads_them():
    assert PACKAGE / "theory/data/virial_3d.csv" in closure("gaspart.theory.virial")
    assert PACKAGE / "accuracy/data/accuracy.csv" in closure("gaspart.accuracy.table")


def test_a_simulation_depends_on_no_theory_but_that_of_its_engine():
    """Another value of the literature measures and evaluates again, and simulates nothing again."""
    needed = {path.relative_to(PACKAGE) for path in closure("gaspart.reproduction.jobs.simulate")}
    theories = {str(path) for path in needed if path.parts[0] == "theory"}
    modules = ("__init__", "discretisation", "geometry", "rates")
    assert theories == {f"theory/{name}.py" for name in modules}


def test_particles_that_are_only_placed_depend_on_no_collision():
    needed = closure(ROOT / "workflow/scripts/compute.py", "gaspart.reproduction.jobs.fill")
    assert PACKAGE / "kernels/insertion.py" in needed
    assert PACKAGE / "kernels/physics/contact.py" not in needed


def test_a_figure_imports_no_large_package_that_it_does_not_need():
    """Each is 0.1 to 1 s of every job."""
    code = f"import sys, {', '.join(modules())}; print(*sys.modules)"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert not {"numba", "matplotlib.pyplot"} & set(done.stdout.split())


MODULE = """
from gaspart.analysis import statistics
from gaspart.theory import virial as theory

ORDER = 3


def helper(points):
    return statistics.average(points) ** ORDER


def measure(points, settings):
    return helper(points)


def claims(dataset):
    yield theory.virial(dataset)


FIGURES = {"one": Parts({}, measure, claims, draw), "two": Parts({}, claims=claims, measure=len, draw=draw)}
"""


def test_what_a_figure_is_measured_with_is_found_in_its_module(tmp_path):
    def digests(text):
        measuring_digest.cache_clear()
        path = tmp_path / "figure.py"
        path.write_text(text)
        return [measuring_digest(str(path), figure) for figure in ("one", "two", "in a loop")]

    one, two, other = digests(MODULE)
    assert len({one, two, other}) == 3
    assert digests(MODULE.replace("import virial", "import enskog")) == [one, two, other]
    assert digests(MODULE.replace("yield", "return")) == [one, two, other]
    for old, new in (
        ("= 3", "= 4"),
        ("return helper", "return 2 * helper"),
        ("import stat", "import estimate as stat"),
    ):
        changed = digests(MODULE.replace(old, new))
        assert changed[0] != one and changed[1] == two and changed[2] != other


def test_every_rule_states_what_it_needs():
    for file in (ROOT / "workflow/rules").glob("*.smk"):
        for rule in re.split(r"^(?:rule|checkpoint) ", file.read_text(), flags=re.MULTILINE)[1:]:
            name = rule.split(":")[0]
            stated = set(re.findall(r"^    (\w+):", rule, re.MULTILINE))
            wanted = {"output", "log", "threads", "resources"}
            if name != "warm":  # which may have none: see there
                wanted |= {"input"}
            assert wanted <= stated, (file.name, name)
            assert "mem_mb=" in rule, name
            assert "runtime=" in rule, name
            script = ROOT / f"workflow/scripts/{name}.py"
            assert script.exists()
            assert re.search(rf'(scripts/|SCRIPTS / "){name}\.py', file.read_text())
