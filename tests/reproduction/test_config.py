"""Invalid configs, and how they are reported."""

import ast
import copy
import math
import re
import shutil
import sys
import tomllib
from datetime import date
from importlib.metadata import packages_distributions
from pathlib import Path

import pytest
import yaml
from malformed import one_line

from gaspart.errors import SceneError
from gaspart.reproduction import registry
from gaspart.reproduction.config import check, explain_error, judge_config, merged_with_default, read_numbers
from gaspart.reproduction.cost import predict
from gaspart.reproduction.points.points import points
from gaspart.yaml_text import dump_yaml

ROOT = Path(__file__).parents[2]
GOOD = {
    "title": "a test",
    "seed": 1,
    "points": "results/points",
    "experiments": {
        "gas": {
            "point": {
                "dimension": 2,
                "count": 100,
                "radius": 0.5,
                "temperature": 1.0,
                "duration": 10.0,
            },
            "grid": {"packing_fraction": [0.1, 0.2]},
        }
    },
    "figures": {"radius_grid": {"experiments": ["gas"]}},
}


def with_value(keys, value):
    config = copy.deepcopy(GOOD)
    block = config
    for key in keys[:-1]:
        block = block.setdefault(key, {})
    block[keys[-1]] = value
    return config


POINT = ("experiments", "gas", "point")
GRID = ("experiments", "gas", "grid")
FIGURE = ("figures", "radius_grid")
ONE = "experiments.gas[packing_fraction=0.1"
DENSE = "experiments.gas[packing_fraction=0.95]"


@pytest.mark.parametrize(
    ("keys", "value", "key", "rule"),
    [
        (("sed",), 1, "sed", "unknown key"),
        (("seed",), -1, "seed", "must be at least 0"),
        (("points",), "/tmp/elsewhere", "points", "must match"),
        (("points",), "results/../elsewhere", "points", "must match"),
        (("run",), "../mine", "run", "must match"),
        (("experiments",), {}, "experiments", "entries at least"),
        (("effort",), 0, "effort", "greater than 0"),
        ((*POINT, "mass"), -1.0, "experiments.gas.point.mass", "must be greater than 0"),
        ((*POINT, "mass"), math.nan, "experiments.gas.point.mass", "must be a finite number"),
        ((*POINT, "count"), 1.5, "experiments.gas.point.count", "must be of type integer"),
        ((*POINT, "dimension"), 4, "experiments.gas.point.dimension", "must be one of [2, 3]"),
        ((*POINT, "boundary"), "door", "experiments.gas[packing_fraction=0.1].boundary", "must be one of"),
        ((*POINT, "speed"), 1.0, "experiments.gas[packing_fraction=0.1].temperature", "not both"),
        ((*POINT, "boxes_per_side"), 1000, f"{ONE}].boxes_per_side", "narrower than the largest diameter"),
        ((*GRID, "packing_fraction"), [], "experiments.gas.grid.packing_fraction", "must not be empty"),
        ((*GRID, "packing_fraction"), [0.1, -0.1], "experiments.gas.grid.packing_fraction", "greater than 0"),
        ((*GRID, "packing_fraction"), [0.95], f"{DENSE}.packing_fraction", "close packing"),
        ((*FIGURE, "experiments"), ["gass"], "figures.radius_grid.experiments", "name of an experiment"),
        (("figures", "virial_disks"), {"experiments": ["gas"]}, "figures.virial_disks", "unknown key"),
    ],
)  # fmt: skip
def test_each_mistake_is_one_line_with_key_value_and_rule(keys, value, key, rule):
    with pytest.raises(SceneError) as refused:
        check(with_value(keys, value))
    assert refused.value.key == key
    assert rule in refused.value.rule
    assert "\n" not in str(refused.value)


def test_what_the_config_of_a_module_lacks_is_named_and_no_folder(tmp_path, monkeypatch):
    """Where this workflow is a module of another one, there is no config/config.yaml."""
    monkeypatch.chdir(tmp_path)
    error = SceneError("points", None, "is required")
    assert explain_error(error, {"title": "my gas"}, module=True) is error
    assert "configfile" in str(explain_error(error, {}, module=True))
    assert "config/config.yaml" in str(explain_error(error, {}, module=False))


def test_a_key_that_is_missing_is_named():
    config = copy.deepcopy(GOOD)
    del config["seed"]
    with pytest.raises(SceneError, match="seed = None: is required"):
        check(config)


def test_the_last_file_that_holds_the_key_is_named(tmp_path):
    default, own = tmp_path / "config.yaml", tmp_path / "own.yaml"
    default.write_text(dump_yaml(GOOD))
    own.write_text(dump_yaml({"experiments": {"gas": {"point": {"mass": -2.0}}}}))
    config = with_value((*POINT, "mass"), -2.0)
    with pytest.raises(SceneError) as refused:
        check(config, [str(default), str(own)])
    assert refused.value.file == str(own)
    for stated, named in ((-1, str(default)), (3, "--config")):  # the option holds what no file does
        default.write_text(dump_yaml(with_value(("seed",), stated)))
        with pytest.raises(SceneError) as refused:
            check(with_value(("seed",), -1), [str(default), str(own)])
        assert refused.value.file == named


def test_a_config_is_merged_over_the_files_of_its_families(tmp_path):
    folder = tmp_path / "figures"
    folder.mkdir()
    sections = ("experiments", "figures", "animations")
    gas = {key: GOOD[key] for key in sections if key in GOOD}
    small = {"experiments": {"gas": {"point": {"mass": 2.0}}}}
    (folder / "gases.yaml").write_text(dump_yaml(gas | {"small": small}))
    (folder / "empty.yaml").write_text("figures: {}\n")
    rest = {key: value for key, value in GOOD.items() if key not in sections} | {"families": "all"}
    default, own = tmp_path / "config.yaml", tmp_path / "own.yaml"
    default.write_text(dump_yaml(rest))
    own.write_text("sizes: small\n")
    merged, files = merged_with_default(default)
    assert merged == GOOD and [file.name for file in files] == ["empty.yaml", "gases.yaml", "config.yaml"]
    merged, files = merged_with_default(own)
    assert merged == with_value((*POINT, "mass"), 2.0) | {"sizes": "small"}
    own.write_text("sizes: small\nfamilies: [empty]\n")
    assert merged_with_default(own)[0]["figures"] == {}
    small["experiments"]["gas"]["point"]["mass"] = -2.0
    (folder / "gases.yaml").write_text(dump_yaml(gas | {"small": small}))
    own.write_text("sizes: small\n")
    with pytest.raises(SceneError, match="mass = -2") as refused:
        check(*merged_with_default(own))
    assert refused.value.file == str(folder / "gases.yaml")
    (folder / "empty.yaml").write_text("experiment: {gas: {}}\n")
    for families, complaint in (
        ("all", "empty.yaml: experiment = .*: must be animations, experiments, figures, or a block of sizes"),
        ("[../config]", "families = .*: must be all, or a list of names of files in"),
        ("[absent]", "absent.yaml"),
    ):
        own.write_text(f"families: {families}\n")
        with pytest.raises((SceneError, OSError), match=complaint):
            merged_with_default(own)


@pytest.mark.parametrize(
    ("keys", "value", "key", "rule"),
    [
        ((3,), 1, "3", "a key must be text"),
        ((*GRID, 3), [1], "experiments.gas.grid.3", "a key must be text"),
        (("title",), date(2001, 2, 3), "title", "must be text, a number"),
        (("title",), [[[]]], "title", "must be of type string"),
        (("seed",), 10**400, "seed", "must be a finite number"),
        (("points",), "results/points\n", "points", "must match"),
        (("experiments", "gas\n"), GOOD["experiments"]["gas"], "experiments", "must match"),
        ((*POINT, "radius"), 1e-300, "experiments.gas.point.radius", "of a size from"),
        ((*POINT, "count"), 1e20, f"{ONE}].count", "must be at most"),
        ((*POINT, "dimension"), 2.0, None, None),
        ((*POINT, "replicas"), 10**9, "experiments.gas.point.replicas", "must be at most 10000"),
        ((*POINT, "boxes_per_side"), [3, 3, 3], f"{ONE}].boxes_per_side", "per axis"),
        ((*POINT, "duration"), 1e60, None, None),
        ((*POINT, "equilibration"), 1e60, "experiments.gas.equilibration", "makes 1e+59 sample intervals"),
        (GRID, [{"mass": list(range(1, 60_001))}] * 2, "experiments.gas.grid", "may have 100000"),
        ((*GRID, "scene.x"), ["a" * 300], "experiments.gas.grid", "name of a point may have 200"),
        ((*GRID, "scene./x"), [1], "experiments.gas.grid", "may hold letters, digits"),
    ],
)  # fmt: skip
def test_values_that_cannot_be_computed_with_are_named(keys, value, key, rule):
    config = with_value(keys, value)
    if key is None:
        check(config)
        return
    with pytest.raises(SceneError) as refused:
        check(config)
    assert refused.value.key == key
    assert rule in refused.value.rule
    assert str(refused.value).isprintable()


def test_a_config_that_is_too_deep_or_too_large_or_contains_itself_is_refused():
    deep, wide, own = {}, [1] * 10, {}
    for _ in range(10_000):
        deep = {"a": deep}
    for _ in range(10):
        wide = [wide] * 10
    own["a"] = own
    for value in (deep, wide, own):
        with pytest.raises(SceneError, match="nested 64 deep|there may be"):
            check(with_value(("title",), value))


@pytest.mark.parametrize("scene", ["\0", "\ud800", "", ".", "nowhere.yaml", "a" * 5000])
def test_a_scene_file_that_cannot_be_is_one_line(scene):
    config = copy.deepcopy(GOOD)
    config["experiments"]["gas"] = {"point": {"scene": scene, "duration": 1.0}}
    with pytest.raises(SceneError) as refused:
        check(config)
    assert str(refused.value).isprintable()


def test_the_unknown_key_is_named_not_one_of_the_scene():
    config = copy.deepcopy(GOOD)
    config["experiments"]["gas"]["point"] = {"scene.x": 1, "maas": 2}
    with pytest.raises(SceneError, match="experiments.gas.point.maas = 2: unknown key"):
        check(config)


def test_a_scene_without_particles_has_no_points(tmp_path):
    (tmp_path / "empty.yaml").write_text("container: {lengths: [9.0, 9.0]}\n")
    config = copy.deepcopy(GOOD)
    point = {"scene": str(tmp_path / "empty.yaml"), "duration": 1.0, "boxes_per_particle": 1.0}
    config["experiments"]["gas"] = {"point": point}
    with pytest.raises(SceneError, match="needs at least one particle"):
        check(config)


def test_names_that_are_many_and_of_all_types_are_refused_at_once():
    names = [f"a{n}" if n % 2 else n for n in range(20_000)]
    assert not one_line(check, with_value((*FIGURE, "experiments"), names))


@pytest.mark.parametrize("folder", [".", "config"])
def test_a_config_may_lie_anywhere_and_its_scenes_beside_it(tmp_path, monkeypatch, folder):
    """In a folder `config`, scenes are looked for in the folder above, where the workflow runs."""
    (tmp_path / folder).mkdir(exist_ok=True)
    (tmp_path / "gas.yaml").write_text(
        "container: {lengths: [9, 9]}\nspecies: [{count: 3, radius: 0.5, speed: 1}]\n"
    )
    config = copy.deepcopy(GOOD)
    config["experiments"]["gas"] = {"point": {"scene": "gas.yaml", "duration": 1.0}}
    own = tmp_path / folder / "own.yaml"
    own.write_text(dump_yaml(config))
    (tmp_path / "elsewhere").mkdir()
    monkeypatch.chdir(tmp_path / "elsewhere")
    (config_check,) = judge_config(own)
    assert str(config_check) == "ok    config: 1 experiments of 1 points, up to 3 particles; 1 figures"
    assert predict(own)[0].startswith("gas")
    own.write_text("experiments: [3]\n")
    for command in (judge_config, predict):
        with pytest.raises(SceneError, match="own.yaml: "):
            command(own)


def test_a_config_in_the_folder_of_the_project_is_merged_over_its_default(tmp_path):
    """Snakemake merges them with `--configfile my_gas.yaml`."""
    (tmp_path / "config").mkdir()
    (tmp_path / "config/config.yaml").write_text(dump_yaml(GOOD))
    own = tmp_path / "my_gas.yaml"
    own.write_text(dump_yaml({"experiments": {"mine": GOOD["experiments"]["gas"]}}))
    (config_check,) = judge_config(own)
    assert str(config_check) == "ok    config: 2 experiments of 4 points, up to 100 particles; 1 figures"


def test_an_overlay_changes_no_other_experiment_that_an_alias_shares(tmp_path):
    (tmp_path / "config.yaml").write_text("a: &a {point: {mass: 1}}\nb: *a\n")
    (tmp_path / "own.yaml").write_text("a: {point: {mass: 2}}\n")
    merged, _ = merged_with_default(tmp_path / "own.yaml")
    assert merged == {"a": {"point": {"mass": 2}}, "b": {"point": {"mass": 1}}}
    (tmp_path / "own.yaml").write_text("[1]\n")
    with pytest.raises(SceneError, match="own.yaml: config = .1.: must be a mapping"):
        merged_with_default(tmp_path / "own.yaml")


def test_all_that_gaspart_imports_and_reads_comes_with_it():
    """`pip install .` and the extras of single features, without that of the workflow, give every command all
    it needs; only the report, which no command makes, needs that extra."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    distributions = packages_distributions()
    own = {*sys.stdlib_module_names, "gaspart", "_typeshed"}
    needed = set()
    for path in (ROOT / "src/gaspart").rglob("*.py"):
        if "report" in path.parts:
            continue
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.Import):
                needed |= {alias.name.split(".")[0] for alias in node.names}
            elif isinstance(node, ast.ImportFrom) and node.module and not node.level:
                needed.add(node.module.split(".")[0])
    extras = project["project"]["optional-dependencies"]
    single = [extras[name] for name in ("film", "order", "gsd", "archive")]
    required = sum(single, project["project"]["dependencies"])
    names = {re.split("[<>=]", name)[0].lower() for name in required}
    for module in needed - own - {"coverage", "cycler", "PIL"}:  # the last two come with matplotlib
        assert {name.lower() for name in distributions[module]} & names, module
    packed = project["tool"]["setuptools"]["package-data"]
    found = {
        file
        for package, patterns in packed.items()
        for pattern in patterns
        for file in (ROOT / "src" / package.replace(".", "/")).glob(pattern)
    }
    for file in (ROOT / "src/gaspart").rglob("*"):
        if file.is_file() and "__pycache__" not in file.parts and file.suffix != ".py":
            assert file in found, file


def test_the_projects_configs_are_valid_and_smoke_has_no_experiment_of_its_own():
    (full, _), (smoke, _) = (
        merged_with_default(ROOT / f"config/{name}.yaml") for name in ("config", "smoke")
    )
    check(copy.deepcopy(full))
    assert set(smoke["experiments"]) == set(full["experiments"]) and smoke["figures"] != full["figures"]
    assert smoke["points"] != full["points"]
    assert smoke["run"] == "smoke" and "run" not in full


def test_a_film_is_of_trajectories():
    check(with_value(["animations"], {"gas": {"experiment": "gas", "colour": "speed"}, "no": None}))
    for wrong, complaint in (
        ({"experiment": "oil"}, "animations.gas.experiment = 'oil': must be the name of an experiment"),
        ({"colour": "speed"}, "animations.gas.experiment = None: is required"),
        ({"experiment": "gas", "colour": "red"}, "animations.gas.colour = 'red': must be one of"),
    ):
        with pytest.raises(SceneError, match=complaint):
            check(with_value(["animations"], {"gas": wrong}))


def test_numbers_with_an_exponent_are_read_as_the_documentation_says(tmp_path):
    """Snakemake's reader takes 1e3 for text; what is quoted in a file is text."""
    file = tmp_path / "a.yaml"
    file.write_text("a: {b: 1e3, c: '1e3', d: [2, 1e-2, '1e1', x]}\ne: 1.5e3\n")
    config = yaml.safe_load(file.read_text()) | {"given": "2e2", "title": "1e3 discs"}
    assert config["a"]["b"] == "1e3"
    read_numbers(config, [file])
    assert config["a"] == {"b": 1000.0, "c": "1e3", "d": [2, 0.01, "1e1", "x"]}
    assert (config["e"], config["given"], config["title"]) == (1500.0, 200.0, "1e3 discs")


def test_null_removes_a_figure_and_a_partial_config_is_a_config(tmp_path, capsys):
    """Of a config with a few keys, which is merged over the config of its folder."""
    from gaspart.cli import main

    shutil.copytree(ROOT / "config", tmp_path / "config")
    tmp_path /= "config"
    answers = {
        "seed: 11": f"{len(registry.families())} figures",
        "figures: {virial_discs: null}": f"{len(registry.families()) - 1} figures",
        "figures: {virial_disc: null}": "unknown name to remove; did you mean virial_discs?",
        "experiment: {virial_discs: {point: {count: 100}}}": "experiment = {'virial_discs'",
        "animations: {gas: null}": "unknown name to remove",
        "contianer: {lengths: [9.0, 9.0]}": "did you mean container?",
    }
    for text, answer in answers.items():
        (tmp_path / "own.yaml").write_text(text)
        main(["check", str(tmp_path / "own.yaml")])
        assert answer in "".join(capsys.readouterr())
    tmp_path = tmp_path.parent / "elsewhere"
    tmp_path.mkdir()
    (tmp_path / "own.yaml").write_text("seed: 11")
    assert main(["check", str(tmp_path / "own.yaml")]) == 2
    assert "has no config/config.yaml, over which others are laid" in capsys.readouterr().err


def test_all_grids_of_a_config_together_have_a_bound():
    grid = {"count": list(range(60_000))}
    config = {"seed": 1, "experiments": {"a": {"grid": grid}, "b": {"grid": grid}}}
    with pytest.raises(SceneError, match=r"experiments\.b\.grid = 120000: .*may have 100000"):
        points(config, "b")
