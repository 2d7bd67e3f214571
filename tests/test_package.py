"""What is released: a source distribution with all of the project, and a wheel with all of the package."""

import base64
import csv
import hashlib
import importlib.util
import shutil
import subprocess
import sys
import tarfile
import tomllib
import zipfile
from email.parser import Parser
from pathlib import Path

import numba
import pytest
from packaging.tags import sys_tags
from packaging.utils import parse_wheel_filename

import gaspart as gp

pytestmark = pytest.mark.thorough

ROOT = Path(__file__).parents[1]
GENERATED = ("__pycache__", ".egg-info", ".pyc", ".partial")


def files_of_project():
    """Files of the repository but for hidden ones, which are for its hosting. Where there is none,
    as in an unpacked source distribution, those that are there."""
    listed = subprocess.run(["git", "ls-files", "-z"], cwd=ROOT, capture_output=True, text=True)
    names = listed.stdout.split("\0")[:-1] or [str(path.relative_to(ROOT)) for path in ROOT.rglob("*")]
    paths = [path for path in map(Path, names) if (ROOT / path).is_file()]
    own = [path for path in paths if path.parts[0] != "results" or path.name == "README.md"]
    return {
        path for path in own if not any(part[0] == "." or part.endswith(GENERATED) for part in path.parts)
    }


def build(source, target):
    """A source distribution, and a wheel that is made of it, by the tools that are installed."""
    command = [sys.executable, "-m", "build", "--no-isolation", "--outdir", str(target), str(source)]
    done = subprocess.run(command, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout[-2000:] + done.stderr[-2000:]


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    """The folder of both, made of a copy: setuptools writes into the folder that it builds."""
    source, target = tmp_path_factory.mktemp("source"), tmp_path_factory.mktemp("made")
    for path in files_of_project():
        (source / path).parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(ROOT / path, source / path)
    build(source, target)
    return target


@pytest.fixture(scope="module")
def wheel(made):
    (path,) = made.glob("*.whl")
    return path


def test_the_source_distribution_is_the_project(made):
    (path,) = made.glob("*.tar.gz")
    with tarfile.open(path) as file:
        names = {Path(*Path(one.name).parts[1:]) for one in file.getmembers() if one.isfile()}
    own = {name for name in names if ".egg-info" not in str(name)} - {Path("PKG-INFO"), Path("setup.cfg")}
    assert own == files_of_project()


def test_the_wheel_is_the_package(wheel):
    with zipfile.ZipFile(wheel) as file:
        names = {Path(name) for name in file.namelist() if ".dist-info/" not in name}
    assert names == {path.relative_to("src") for path in files_of_project() if path.parts[0] == "src"}


def test_the_wheel_with_kernels_has_them_besides_and_is_for_this_python(wheel, tmp_path):
    spec = importlib.util.spec_from_file_location("ship_kernels", ROOT / "release/ship_kernels.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    kernel = tmp_path / "cache/digest/physics/log_of.nbc"
    kernel.parent.mkdir(parents=True)
    kernel.write_bytes(b"its code")
    kernel.with_suffix(".part").write_bytes(b"a translation, which is not shipped")
    (tmp_path / "cache/wasm").mkdir()
    (tmp_path / "cache/wasm/kind.wasm").write_bytes(b"a module of a page")
    path = module.with_kernels(wheel, tmp_path / "cache", tmp_path)
    name, version, (*build,), tags = parse_wheel_filename(path.name)
    release = "".join(map(str, build))
    assert (name, str(version), release) == ("gaspart", gp.__version__, numba.__version__)
    assert tags < set(sys_tags())
    with zipfile.ZipFile(wheel) as old, zipfile.ZipFile(path) as new:
        added = set(new.namelist()) - set(old.namelist())
        assert not set(old.namelist()) - set(new.namelist())
        shipped = "gaspart/kernels/shipped/"
        assert added == {
            f"{shipped}{name}" for name in ("sha256.json", "digest/physics/log_of.nbc", "wasm/kind.wasm")
        }
        (record,) = (one for one in new.namelist() if one.endswith("/RECORD"))
        rows = {row[0]: row[1:] for row in csv.reader(new.read(record).decode().splitlines())}
        assert set(rows) == set(new.namelist())
        for one in set(rows) - {record}:
            digest = base64.urlsafe_b64encode(hashlib.sha256(new.read(one)).digest()).rstrip(b"=").decode()
            assert rows[one] == [f"sha256={digest}", str(len(new.read(one)))]
        stated = new.read(record.replace("RECORD", "WHEEL")).decode()
    assert f"Tag: {next(iter(tags))}\n" in stated and f"Build: {numba.__version__}\n" in stated


def test_their_metadata_are_valid_and_those_of_the_project(made, wheel):
    command = [sys.executable, "-m", "twine", "check", "--strict", *map(str, made.iterdir())]
    done = subprocess.run(command, capture_output=True, text=True)
    assert done.returncode == 0 and done.stdout.count("PASSED") == 2, done.stdout
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
    with zipfile.ZipFile(wheel) as file:
        (name,) = (name for name in file.namelist() if name.endswith(".dist-info/METADATA"))
        stated = Parser().parsestr(file.read(name).decode())
    assert (stated["Name"], stated["Version"]) == ("gaspart", gp.__version__)
    assert stated["License-Expression"] == project["license"]
    assert stated["Requires-Python"] == project["requires-python"]
    assert set(stated.get_all("Provides-Extra")) == set(project["optional-dependencies"])
    needed = [line for line in stated.get_all("Requires-Dist") if "extra ==" not in line]
    assert len(needed) == len(project["dependencies"])
    assert stated.get_payload() == (ROOT / "README.md").read_text()


def test_the_wheel_runs_without_the_project(wheel, tmp_path):
    """Unpacked, which is what pip does with it, and with its entry points."""
    with zipfile.ZipFile(wheel) as file:
        file.extractall(tmp_path / "installed")
    code = (
        f"import sys; sys.path.insert(0, {str(tmp_path / 'installed')!r})\n"
        "import gaspart; print(gaspart.__file__)\n"
        "from gaspart.cli import main\n"
        "sys.exit(main(['new', 'gas.yaml']) or main(['check', 'gas.yaml']))"
    )
    done = subprocess.run([sys.executable, "-c", code], cwd=tmp_path, capture_output=True, text=True)
    assert done.stdout.startswith(str(tmp_path / "installed")), done.stdout + done.stderr
    assert done.returncode == 0, done.stderr
