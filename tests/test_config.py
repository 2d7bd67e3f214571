"""What a config may not say, and how that is told."""

import copy
import math
from pathlib import Path

import pytest

from gaspart.config import check
from gaspart.errors import SceneError
from gaspart.yaml_text import dump_yaml, read_yaml

ROOT = Path(__file__).parents[1]
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


def test_a_good_config_passes():
    check(GOOD)


POINT = ("experiments", "gas", "point")
GRID = ("experiments", "gas", "grid")
FIGURE = ("figures", "radius_grid")
DENSE = "experiments.gas[packing_fraction=0.95]"


@pytest.mark.parametrize(
    ("keys", "value", "key", "rule"),
    [
        (("sed",), 1, "sed", "unknown key"),
        (("seed",), -1, "seed", "must be at least 0"),
        (("points",), "/tmp/elsewhere", "points", "must match"),
        (("points",), "results/../elsewhere", "points", "must match"),
        (("experiments",), {}, "experiments", "entries at least"),
        (("experiments", "gas", "gird"), {}, "experiments.gas.gird", "unknown key"),
        ((*POINT, "maas"), 1.0, "experiments.gas.point.maas", "unknown key"),
        ((*POINT, "mass"), -1.0, "experiments.gas.point.mass", "must be greater than 0"),
        ((*POINT, "mass"), math.nan, "experiments.gas.point.mass", "must be a finite number"),
        ((*POINT, "temperature"), math.inf, "experiments.gas.point.temperature", "must be a finite number"),
        ((*POINT, "count"), 1.5, "experiments.gas.point.count", "must be of type integer"),
        ((*POINT, "count"), "many", "experiments.gas.point.count", "must be of type integer"),
        ((*POINT, "dimension"), 4, "experiments.gas.point.dimension", "must be one of [2, 3]"),
        ((*POINT, "boundary"), "door", "experiments.gas[packing_fraction=0.1].boundary", "must be one of"),
        ((*POINT, "speed"), 1.0, "experiments.gas[packing_fraction=0.1].temperature", "not both"),
        (
            (*POINT, "boxes_per_side"),
            1000,
            "experiments.gas[packing_fraction=0.1].boxes_per_side",
            "narrower than the largest diameter",
        ),
        ((*GRID, "packing_fraction"), [], "experiments.gas.grid.packing_fraction", "must not be empty"),
        ((*GRID, "packing_fraction"), [0.1, -0.1], "experiments.gas.grid.packing_fraction", "greater than 0"),
        ((*GRID, "packing_fraction"), [0.95], f"{DENSE}.packing_fraction", "close packing"),
        ((*GRID, "packing"), [0.1], "experiments.gas.grid.packing", "unknown key"),
        ((*FIGURE, "experiments"), ["gass"], "figures.radius_grid.experiments", "name of an experiment"),
        (("figures", "virial_disks"), {"experiments": ["gas"]}, "figures.virial_disks", "unknown key"),
        ((*FIGURE, "colour"), "red", "figures.radius_grid.colour", "unknown key"),
    ],
)  # fmt: skip
def test_each_mistake_is_one_line_with_key_value_and_rule(keys, value, key, rule):
    with pytest.raises(SceneError) as refused:
        check(with_value(keys, value))
    assert refused.value.key == key
    assert rule in refused.value.rule
    assert "\n" not in str(refused.value)


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
    with pytest.raises(SceneError) as refused:
        check(with_value(("seed",), -1), [str(default), str(own)])
    assert refused.value.file == str(default)


def test_the_projects_configs_hold_every_figure_and_smoke_says_nothing_new():
    full, smoke = (read_yaml(ROOT / f"config/{name}.yaml") for name in ("config", "smoke"))
    check(full)
    assert set(smoke["experiments"]) <= set(full["experiments"])
    assert smoke["points"] != full["points"]


def test_a_film_is_of_trajectories():
    check(with_value(["animations"], {"gas": {"experiment": "gas", "colour": "speed"}, "no": None}))
    for wrong, complaint in (
        ({"experiment": "oil"}, "animations.gas.experiment = 'oil': must be the name of an experiment"),
        ({"colour": "speed"}, "animations.gas.experiment = None: is required"),
        ({"experiment": "gas", "colour": "red"}, "animations.gas.colour = 'red': must be one of"),
    ):
        with pytest.raises(SceneError, match=complaint):
            check(with_value(["animations"], {"gas": wrong}))
