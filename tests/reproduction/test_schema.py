"""Schemas and the pages of the reference: current, and the same rules as those of the program."""

import copy
import json
import re
from pathlib import Path

import jsonschema
import pytest
from malformed import SCENES
from reference import pages

from gaspart.reproduction.config import check, merged_with_default, scene_schema, schema
from gaspart.reproduction.points.modules import closure
from gaspart.reproduction.registry import families, home, settings
from gaspart.yaml_text import read_yaml

ROOT = Path(__file__).parents[2]


def test_the_site_has_the_schemas():
    for name in ("scene", "config"):
        assert json.loads(pages()[f"reference/{name}.schema.json"])["properties"]


@pytest.mark.parametrize("content", [schema(), scene_schema()], ids=["config", "scene"])
def test_a_schema_is_one(content):
    jsonschema.Draft202012Validator.check_schema(content)


def described(kind):
    """All parts of a schema that state a key, with the key."""
    for name, part in kind.get("properties", {}).items():
        yield name, part
        yield from described(part)
    for name in ("items", "additionalProperties"):
        if isinstance(kind.get(name), dict):
            yield from described(kind[name])
    for part in kind.get("anyOf", ()):
        yield from described(part)


def test_every_key_has_a_meaning():
    figures = schema()["properties"]["figures"]["properties"]
    for content in (schema(), scene_schema()):
        for name, part in described(content):
            assert name in figures or part["description"], name


@pytest.mark.parametrize("family", sorted(set(families().values())))
def test_every_setting_of_a_figure_is_declared_and_used(family):
    modules = [path for path in closure(home(family)) if path.parent.name == "figures"]
    text = "\n".join(path.read_text(encoding="utf-8") for path in modules)
    declared = {
        key for figure in families() if families()[figure] == family for key in settings()[figure]
    } - {"experiments"}
    made = tuple(re.findall(r'\bsettings\[f"\{\w+\}(\w+)"\]', text))
    unused = [key for key in declared if text.count(f'"{key}"') < 2]  # where it is declared
    assert [key for key in unused if not (made and key.endswith(made))] == []


@pytest.mark.parametrize("scene", SCENES)
def test_the_schema_of_scenes_accepts_scenes(scene):
    jsonschema.validate(scene, scene_schema())


@pytest.mark.parametrize("path", sorted((ROOT / "config/scenes").glob("*.yaml")), ids=lambda path: path.stem)
def test_the_schema_of_scenes_accepts_the_scene_files(path):
    jsonschema.validate(read_yaml(path), scene_schema())


@pytest.mark.parametrize(
    ("place", "value"),
    [
        (("colour",), "red"),
        (("species", 0, "mass"), 0.0),
        (("particles", 0, "position"), [1.0]),
        (("container", "boundary"), "fog"),
        (("faces", "left"), {"kind": "thermal", "temperature": 1.0}),
        (("restitution", "normal"), 1.5),
    ],
)
def test_the_schema_of_scenes_refuses_what_the_program_refuses(place, value):
    scene = copy.deepcopy(SCENES[0])
    *way, last = place
    block = scene
    for key in way:
        block = block[key]
    block[last] = value
    with pytest.raises(jsonschema.ValidationError):
        jsonschema.validate(scene, scene_schema())


def test_the_schema_of_configs_is_the_one_that_is_checked():
    config, _ = merged_with_default(ROOT / "config/smoke.yaml")
    check(config)  # which removes what is null
    jsonschema.validate(config, schema())
