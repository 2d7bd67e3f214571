"""Kinds of figures that other installed packages bring, through the check of a config."""

import sys
from pathlib import Path

import pytest

from gaspart.cli import main
from gaspart.errors import SceneError
from gaspart.reproduction.config import check
from gaspart.reproduction.families import installed, registry
from gaspart.yaml_text import dump_yaml

FAMILY = '''"""Paths."""
from gaspart.cli import main
from gaspart.errors import SceneError
from gaspart.keys import positive

TITLE = "Paths"
KINDS = {"paths": {"up_to": positive("longest path"), "claims": {"type": "array", "default": []}}}


def validate(figure, settings, points):
    if settings["up_to"] > 5.0 * len(points):
        raise SceneError(f"figures.{figure}.up_to", settings["up_to"], "is long for so few points")
    if settings["up_to"] == 1.5:
        raise KeyError("a mistake of the package")


def caption(settings):
    return f"**Paths up to {settings['up_to']}.**"
'''
PARTS = ("measure", "claims", "figure")
POINT = {"dimension": 2, "count": 16, "radius": 0.5, "packing_fraction": 0.1, "boundary": "periodic"}
CONFIG = {
    "title": "a user's own",
    "seed": 1,
    "points": "results/points",
    "experiments": {"gas": {"point": {**POINT, "temperature": 1.0, "duration": 1.0, "samples": 4}}},
    "figures": {},
}
FIGURE = {"kind": "paths", "experiments": ["gas"], "up_to": 2.0}
BROKEN = (
    "figures.my_paths.kind = 'paths': the entry point (gaspart.families: paths = gas_paths) of gas-paths 0.3 "
    "cannot be used: "
)


@pytest.fixture
def install(tmp_path, monkeypatch):
    """A function that installs a package, as pip does it, in a folder on the path of modules."""
    monkeypatch.syspath_prepend(str(tmp_path))

    def made(name, kinds, text=FAMILY, parts=PARTS):
        package = tmp_path / name.replace("-", "_")
        package.mkdir()
        (package / "__init__.py").write_text(text)
        for part in parts:
            (package / f"{part}.py").write_text("raise ImportError('not before it is needed')")
        metadata = tmp_path / f"{package.name}-0.3.dist-info"
        metadata.mkdir()
        (metadata / "METADATA").write_text(f"Metadata-Version: 2.1\nName: {name}\nVersion: 0.3\n")
        lines = [f"{kind} = {module}" for kind, module in kinds.items()]
        (metadata / "entry_points.txt").write_text("\n".join([f"[{installed.GROUP}]", *lines, ""]))
        installed._entry_points.cache_clear()

    yield made
    installed._entry_points.cache_clear()
    for name in [name for name in sys.modules if name.startswith("gas_paths")]:
        del sys.modules[name]


def configured(**settings):
    return {**CONFIG, "figures": {"my_paths": {**FIGURE, **settings}}}


def refused(config):
    with pytest.raises(SceneError) as error:
        check(config)
    return str(error.value)


def test_a_config_has_a_figure_of_another_package(install):
    install("gas-paths", {"paths": "gas_paths"})
    assert list(check(configured())) == ["gas"]
    block = configured()["figures"]["my_paths"]
    assert registry.functions("my_paths", block) == ("gas_paths", "paths")
    assert registry.module("gas_paths", "claims") == "gas_paths.claims"
    assert registry.chapter("gas_paths") == "Own figures"
    assert registry.title("my_paths", block) == "Paths"
    assert registry.caption(block) == "**Paths up to 2.0.**"
    assert registry.package_of(block) == "gas-paths 0.3"
    assert {path.name for path in registry.files("gas_paths")} == {"__init__.py", *(f"{n}.py" for n in PARTS)}


@pytest.mark.parametrize(
    ("settings", "message"),
    [
        ({"up_to": -1.0}, "figures.my_paths.up_to = -1.0: must be greater than 0"),
        ({"upto": 1.0}, "figures.my_paths.upto = 1.0: unknown key; did you mean up_to?"),
        ({"experiments": []}, "figures.my_paths.experiments = []: must have this many items at least: 1"),
        ({"up_to": 6.0}, "figures.my_paths.up_to = 6.0: is long for so few points"),
        (
            {"up_to": 1.5},
            f"{BROKEN}KeyError: 'a mistake of the package'",
        ),
        ({"kind": "path"}, "figures.my_paths.kind = 'path': must be one of ['observable', 'paths']"),
        ({"kind": ["paths"]}, "figures.my_paths.kind = ['paths']: must be one of ['observable', 'paths']"),
    ],
)
def test_its_settings_are_checked_before_any_job(install, settings, message):
    install("gas-paths", {"paths": "gas_paths"})
    assert refused(configured(**settings)) == message


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        ("import a_missing_package", "ModuleNotFoundError: No module named 'a_missing_package'"),
        ("raise SystemExit('no licence')", "SystemExit: no licence"),
        ("KINDS = {'paths': {}}", "TypeError: its TITLE must be text"),
        (FAMILY.replace('"paths": {', '"path": {'), "TypeError: its KINDS must have the settings of paths"),
        (
            FAMILY.replace('positive("longest path")', '{"type": "real"}'),
            "TypeError: its KINDS of paths: up_to",
        ),
        (FAMILY.replace("def caption", "def captions"), "TypeError: it must have a function caption"),
    ],
)
def test_a_broken_package_is_named_with_the_reason(install, text, reason):
    install("gas-paths", {"paths": "gas_paths"}, text)
    message = refused(configured())
    assert message.startswith(BROKEN + reason)
    assert "\n" not in message


def test_a_package_without_one_of_the_modules_is_broken(install):
    install("gas-paths", {"paths": "gas_paths"}, parts=PARTS[:2])
    assert refused(configured()).endswith("ModuleNotFoundError: it has no module figure")


def test_a_package_is_not_taken_for_a_family_of_this_one(install):
    install("gas-paths", {"paths": "own"})
    (Path(sys.path[0]) / "own").mkdir()
    (Path(sys.path[0]) / "own/__init__.py").write_text(FAMILY)
    assert refused(configured()).endswith("ValueError: it has the name of a family of gaspart")
    del sys.modules["own"]


def test_two_packages_of_one_kind_are_refused(install):
    install("gas-paths", {"paths": "gas_paths"})
    install("gas-paths-2", {"paths": "gas_paths_2"})
    assert "several installed packages bring this kind (gaspart.families): gas-paths, gas-paths-2" in refused(
        configured()
    )


def test_only_a_kind_that_a_config_has_is_imported(install):
    install("gas-paths", {"paths": "gas_paths", "flights": "gas_paths.missing"})
    check(CONFIG)
    observable = {"kind": "observable", "observable": "Z", "against": "packing_fraction"}
    check({**CONFIG, "figures": {"mine": {**observable, "experiments": ["gas"]}}})
    assert installed._entry_points.cache_info().currsize == 0
    assert registry.known_kinds() == ["observable", "flights", "paths"]
    assert "gas_paths" not in sys.modules
    check(configured())


@pytest.mark.parametrize(
    "text",
    [
        b"no section\n[gaspart.families]\npaths\n",
        b"\xff\xfe[gaspart.configs]\n",
        b"[gaspart.configs]\ncheck = gas_paths:nothing\nverify = gas_paths:nothing\n",
        b"[gaspart.configs]\ncheck = \nverify = :::\n= a b\n[gaspart.families]\n= :::\n",
    ],
)
@pytest.mark.parametrize("words", [["check", "own.yaml"], ["verify", "own.zip"]])
def test_broken_entry_points_of_another_package_end_no_command(
    install, tmp_path, monkeypatch, capsys, text, words
):
    monkeypatch.chdir(tmp_path)
    install("gas-paths", {})
    (tmp_path / "gas_paths-0.3.dist-info/entry_points.txt").write_bytes(text)
    (tmp_path / "own.yaml").write_text(dump_yaml(CONFIG))
    assert main(words) == (0 if words[0] == "check" else 2)
    out, err = capsys.readouterr()
    assert (out.startswith("ok") or "1 experiments of 1 points" in out) if words[0] == "check" else not out
    assert err.count("\n") == (words[0] == "verify") and "Traceback" not in err
