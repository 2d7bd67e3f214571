"""Kernels that come with the package: which are used, and that none is that is not what was shipped."""

import importlib.util
import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

import gaspart
from gaspart.kernels.compile import cache as shipped
from gaspart.kernels.compile import files
from gaspart.kernels.compile.files import KernelFiles

pytestmark = pytest.mark.thorough

SPEC = importlib.util.spec_from_file_location(
    "ship_kernels", Path(__file__).parents[3] / "release/ship_kernels.py"
)
HERE = ("a system", "a newer processor", f"{shipped.FEATURES},+avx512f,-sse4a")
FOR_MANY = ("a system", shipped.PROCESSOR, shipped.FEATURES)


@pytest.fixture(scope="module")
def wheels():
    loaded = importlib.util.module_from_spec(SPEC)
    SPEC.loader.exec_module(loaded)
    return loaded


def kernel_files(folder, sources="sources", stamp="stamp"):
    (folder / sources / "physics").mkdir(parents=True, exist_ok=True)
    return KernelFiles(str(folder / sources / "physics"), "rng.log_of-1.py311", stamp, "nbc")


@pytest.fixture
def folder(tmp_path, monkeypatch, wheels):
    """A package that brings the code of one kernel."""
    kernel_files(tmp_path / "v3").save(("types", FOR_MANY, "bytecode"), "its code")
    monkeypatch.setattr(shipped, "FOLDER", tmp_path / "shipped")
    shipped._digests.cache_clear()
    for path, content in wheels.shipped_files(tmp_path / "v3").items():
        (tmp_path / "shipped" / path).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / "shipped" / path).write_bytes(content)
    yield tmp_path / "shipped"
    shipped._digests.cache_clear()


def loaded(tmp_path, types="types", system=HERE, bytecode="bytecode", **more):
    return kernel_files(tmp_path / "cache", **more).load((types, system, bytecode))


def test_a_processor_of_the_level_uses_what_came_with_the_package_and_its_own_first(folder, tmp_path):
    assert loaded(tmp_path) == "its code"
    kernel_files(tmp_path / "cache").save(("types", HERE, "bytecode"), "own code")
    assert loaded(tmp_path) == "own code"


@pytest.mark.parametrize("lacking", shipped.FEATURES.split(","))
def test_an_older_processor_does_not(folder, tmp_path, lacking):
    features = HERE[2].replace(lacking, lacking.replace("+", "-"))
    assert loaded(tmp_path, system=("a system", "an older processor", features)) is None


def test_code_of_other_types_sources_options_systems_and_numbas_is_not_found(folder, tmp_path, monkeypatch):
    others = {"types": "others", "bytecode": "other", "sources": "others", "stamp": "other options"}
    for key, value in (others | {"system": ("another system", *HERE[1:])}).items():
        assert loaded(tmp_path, **{key: value}) is None
    monkeypatch.setattr(files.caching.numba, "__version__", "0.68.99")
    assert loaded(tmp_path) is None


def damage(folder, how):
    (file,) = folder.glob("*/*/*.nbc")
    content = bytearray(file.read_bytes())
    if how == "a file of this user's":  # with a checksum that agrees
        digest = json.loads((folder / shipped.LIST).read_text())
        kernel_files(folder.parent / "foreign").save("any", "foreign code")
        (foreign,) = folder.parent.glob("foreign/*/*/*.nbc")
        assert len(digest) == 1
        shutil.copy(foreign, file)
    elif how == "a flipped bit":
        content[-2] ^= 1
        file.write_bytes(content)
    elif how == "missing":
        file.unlink()
    elif how == "not listed":
        (folder / shipped.LIST).write_text("{}")
    else:
        (folder / shipped.LIST).write_text(how)


NO_LISTS = "{", "[1]", "null", "3", '"text"', "[" * 100_000, '{"sources": [1]}'


@pytest.mark.parametrize(
    "how", ["a flipped bit", "a file of this user's", "missing", "not listed", *NO_LISTS]
)
def test_nothing_but_what_was_shipped_is_read_as_code(folder, tmp_path, how):
    damage(folder, how)
    shipped._digests.cache_clear()
    assert loaded(tmp_path) is None


def test_a_file_that_another_user_has_placed_in_the_cache_is_not_read(tmp_path, monkeypatch):
    kernel_files(tmp_path / "cache").save(("types", HERE, "bytecode"), "code")
    assert loaded(tmp_path) == "code"
    monkeypatch.setattr(files.os, "geteuid", lambda: os.getuid() + 1)
    assert loaded(tmp_path) is None


PROGRAM = """
from gaspart.kernels.physics.rng import log_of
print(log_of(2.0).hex(), sum(log_of.stats.cache_hits.values()))
"""


def test_a_kernel_compiled_for_many_processors_runs_and_a_damaged_one_is_compiled_instead(tmp_path, wheels):
    """The whole way, with an empty cache each time; the same bits."""
    package = tmp_path / "installed" / "gaspart"
    shutil.copytree(Path(gaspart.__file__).parent, package)

    def run(cache, **more):
        environment = os.environ | {"GASPART_CACHE": str(tmp_path / cache)} | more
        environment["PYTHONPATH"] = str(package.parent)
        command = [sys.executable, "-c", PROGRAM]
        done = subprocess.run(command, capture_output=True, text=True, env=environment, check=True)
        return done.stdout.split()

    bits, _ = run("v3", NUMBA_CPU_NAME=shipped.PROCESSOR, NUMBA_CPU_FEATURES=shipped.FEATURES)
    for path, content in wheels.shipped_files(tmp_path / "v3").items():
        place = package / "kernels" / shipped.FOLDER.name / path
        place.parent.mkdir(parents=True, exist_ok=True)
        place.write_bytes(content)
    assert run("empty") == [bits, "1"] and not list(tmp_path.glob("empty/*/*/*"))
    (file,) = package.glob("kernels/shipped/*/*/*.nbc")
    file.write_bytes(file.read_bytes()[:-1])
    assert run("empty") == [bits, "0"] and len(list(tmp_path.glob("empty/*/*/*.nbc"))) == 1
