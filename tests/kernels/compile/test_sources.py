"""What changes a digest of sources: code, and neither docstrings nor comments."""

import ast
import json
import os
import shutil
import subprocess
import sys
from collections import Counter
from pathlib import Path

import pytest

import gaspart
from gaspart.kernels.compile import sources
from gaspart.kernels.compile.sources import STORE, closure_digests, file_digests, tree_digest

SOURCE = '''"""A module."""
LIMIT = 3.0
"""A constant."""


class Entry(NamedTuple):
    """A class."""

    value: float


@helper
def twice(x, factor=2):
    """Return a multiple."""
    return factor * x - LIMIT
'''


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ('"""A module."""\n', ""),
        ('"""A constant."""', '"""Another\n\n    constant."""'),
        ('    """Return a multiple."""\n', '    """Return `factor` times x."""\n    # The reason.\n'),
        ("LIMIT = 3.0", "# The unit is a length.\n\nLIMIT = 3.0  # at most"),
        ("return factor * x - LIMIT", "return (\n        factor * x - LIMIT\n    )"),
    ],
)
def test_text_changes_no_digest(old, new):
    assert SOURCE.count(old) == 1
    assert tree_digest(SOURCE.replace(old, new).encode()) == tree_digest(SOURCE.encode())


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("3.0", "3"),
        ("factor=2", "factor=True"),
        ("value: float", "value: int"),
        ("@helper\n", ""),
        ("factor * x", "x * factor"),
        ("- LIMIT", "- (LIMIT + 0.0)"),
        ("return factor", 'return "a text", factor'),
    ],
)
def test_code_changes_the_digest(old, new):
    assert SOURCE.count(old) in (1, 2)
    assert tree_digest(SOURCE.replace(old, new).encode()) != tree_digest(SOURCE.encode())


def test_other_files_have_the_digest_of_their_bytes(tmp_path):
    table, script = tmp_path / "table.csv", tmp_path / "script.py"
    for content in (b"# 1\n", b"# 2\n"):
        table.write_bytes(content)
        script.write_bytes(content + b"invalid syntax\n")
        digests = file_digests([table, script])
        assert len(set(digests)) == 2
    assert tree_digest(b"# 1\ninvalid syntax\n") != tree_digest(b"# 2\ninvalid syntax\n")


@pytest.fixture
def cache(tmp_path, monkeypatch):
    monkeypatch.setenv("GASPART_CACHE", str(tmp_path / "cache"))
    sources._read_stored.cache_clear()
    yield tmp_path / "cache/sources" / STORE
    sources._read_stored.cache_clear()


def test_digests_are_computed_once_for_each_content(tmp_path, cache, monkeypatch):
    paths = [tmp_path / "one.py", tmp_path / "two.py"]
    for path in paths:
        path.write_text(SOURCE.replace("twice", path.stem))
    expected, computed = file_digests(paths), []
    sources._read_stored.cache_clear()  # as another process
    monkeypatch.setattr(sources, "tree_digest", lambda content: computed.append(content) or "f" * 32)
    assert file_digests(paths) == expected and not computed
    paths[0].write_text("new = 1")
    assert file_digests(paths) == ["f" * 32, expected[1]] and computed == [b"new = 1"]


@pytest.mark.parametrize("content", ["", "{", "[1]", "null", '{"a": 1}', '{"a": "../b"}', "[" * 100_000])
def test_a_damaged_store_is_ignored_and_written_again(tmp_path, cache, content):
    path = tmp_path / "one.py"
    path.write_text(SOURCE)
    cache.parent.mkdir(parents=True, mode=0o700)
    cache.write_text(content)
    assert file_digests([path]) == [tree_digest(SOURCE.encode())]
    assert [*json.loads(cache.read_text()).values()] == [tree_digest(SOURCE.encode())]


def test_a_store_of_others_is_neither_read_nor_written(tmp_path, cache, monkeypatch):
    path = tmp_path / "one.py"
    path.write_text(SOURCE)
    file_digests([path])
    forged = json.dumps(dict.fromkeys(json.loads(cache.read_text()), "f" * 32))
    cache.write_text(forged)
    cache.parent.chmod(0o777)
    sources._read_stored.cache_clear()
    assert file_digests([path]) == [tree_digest(SOURCE.encode())] and cache.read_text() == forged


def test_the_store_does_not_grow_without_end(tmp_path, cache, monkeypatch):
    monkeypatch.setattr(sources, "MOST_STORED", 3)
    path = tmp_path / "one.py"
    for number in range(6):
        path.write_text(f"x = {number}")
        file_digests([path])
    last = [tree_digest(f"x = {number}".encode()) for number in (3, 4, 5)]
    assert [*json.loads(cache.read_text()).values()] == last


def test_a_name_stands_for_one_function_of_a_module_of_kernels():
    """The files of compiled kernels are named by it, without the number of its line."""
    for path in (Path(gaspart.__file__).parent / "kernels").rglob("*.py"):
        tree = ast.parse(path.read_text(encoding="utf-8"))
        names = Counter(
            one.name for one in ast.walk(tree) if isinstance(one, ast.FunctionDef) and is_compiled(one)
        )
        assert not [name for name, count in names.items() if count > 1], path


def is_compiled(function):
    return any(
        "kernel" in ast.unparse(one) or "helper" in ast.unparse(one) for one in function.decorator_list
    )


def test_a_kernel_is_compiled_again_if_and_only_if_a_module_that_it_needs_has_changed(tmp_path):
    folder = tmp_path / "kernels"
    shutil.copytree(Path(gaspart.__file__).parent / "kernels", folder)
    before = closure_digests(folder)

    def changed(name):
        path = folder / name
        text = path.read_text()
        path.write_text(f"{text}\nADDED = 1\n")
        closure_digests.cache_clear()
        after = closure_digests(folder)
        path.write_text(text)
        return {str(Path(key).relative_to(folder)) for key in before if before[key] != after[key]}

    assert changed("drawing/ray_tracing.py") == {"drawing/ray_tracing.py"}
    assert changed("event/loop.py") == {"event/loop.py"}
    contact = changed("physics/contact.py")
    assert contact >= {"event/loop.py", "step/resolve.py"}
    assert "drawing/ray_tracing.py" not in contact and "analysis/waves.py" not in contact
    policy = changed("compile/policy.py")
    for path in folder.rglob("*.py"):
        if "kernels.compile.policy import" in path.read_text():
            assert str(path.relative_to(folder)) in policy


PROGRAM = """
from gaspart.kernels.compile.sources import source_digest
from gaspart.kernels.physics.rng import log_of
from gaspart.reproduction.points.modules import digest, kernel_digest
log_of(2.0)
root = "gaspart.simulation"
print(sum(log_of.stats.cache_hits.values()), source_digest(), kernel_digest(root), digest(root))
"""


def test_docstrings_and_comments_recompile_nothing_and_rerun_no_stage(tmp_path):
    package = tmp_path / "gaspart"
    shutil.copytree(Path(gaspart.__file__).parent, package)
    file = package / "kernels/physics/rng.py"
    text = file.read_text()
    (line,) = [line for line in text.splitlines() if line.startswith("def log_of(")]

    def run():
        environment = os.environ | {"GASPART_CACHE": str(tmp_path / "cache"), "PYTHONPATH": str(tmp_path)}
        command = [sys.executable, "-c", PROGRAM]
        done = subprocess.run(command, capture_output=True, env=environment, text=True)
        assert done.returncode == 0, done.stderr
        hits, *digests = done.stdout.split()
        return hits, digests

    compiled, before = run()
    commented = text.replace(line, f'{line}\n    """Text."""')
    file.write_text(f"# A comment.\n{commented}")
    assert (compiled, run()) == ("0", ("1", before))
    file.write_text(text.replace(line, f"{line}\n    x = x + 0.0"))
    hits, after = run()
    assert hits == "0" and not set(after) & set(before)
