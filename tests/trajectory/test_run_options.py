"""Options of a run, each declared once: in Python, on the command line, in a config and in the file."""

import inspect
import re
from dataclasses import fields, replace
from functools import wraps

import pytest

import gaspart as gp
from gaspart.cli import main
from gaspart.cli.options import run_options
from gaspart.errors import SceneError
from gaspart.reproduction.config import checked_points
from gaspart.reproduction.jobs.simulate import recipes
from gaspart.runs import entry
from gaspart.state.tally import WallShearTally
from gaspart.trajectory.recipe import Recipe, read_recipe
from gaspart.trajectory.run_options import OPTIONS, REQUESTED, Contents, recipe_fields, stated_options
from gaspart.yaml_text import dump_yaml

VALUES = {
    "displacements": True,
    "follow": 5,
    "keep": "positions",
    "pairs": True,
    "impulses": "y:8",
    "pair_impulses": "2.5:20:0.5",
}
UNTIL_Z = {"keep": "keep = 'positions': has no meaning with until", "follow": "'Z': follow: needs all 20"}
"""Why a run until Z is accurate cannot have an option."""
SCENE = gp.Scene(gp.Container((8.0, 9.0), "periodic"), [gp.Species(20, 0.5, temperature=1.0)])
CORRELATIONS = gp.Correlations(0.25, 4, 0.5, stress=True)
PLAIN = Recipe(SCENE, gp.EventDriven(), (3, 1), 4.0, 0.5)
RECIPES = {
    **{name: replace(PLAIN, **recipe_fields({name: value})) for name, value in VALUES.items()},
    "all": replace(PLAIN, correlations=CORRELATIONS, **recipe_fields(VALUES)),
    "none": PLAIN,
}


def test_every_option_has_a_value_here_and_a_parameter_of_run():
    assert VALUES.keys() == OPTIONS.keys()
    names = {item.name for item in fields(Contents)}
    assert names <= inspect.signature(gp.run).parameters.keys()
    assert OPTIONS.keys() - names == REQUESTED.keys() == {tally.name for tally in RECIPES["all"].tallies}


@pytest.mark.parametrize("name", RECIPES)
def test_the_header_of_a_file_restores_the_recipe(name, tmp_path):
    path = tmp_path / "run.nc"
    path.write_bytes(RECIPES[name].header(""))
    assert read_recipe(path) == RECIPES[name]


@pytest.mark.parametrize("name", RECIPES)
def test_the_stated_command_asks_for_the_same_run(name, tmp_path, monkeypatch, capsys):
    recipe, scene, asked = RECIPES[name], tmp_path / "scene.yaml", {}

    @wraps(entry.run)
    def take(**settings):
        asked.update(settings)
        raise SceneError("seen", True, "is enough")

    scene.write_text(dump_yaml(SCENE.to_dict()))
    monkeypatch.setattr(entry, "run", take)
    assert main(["run", str(scene), *run_options(tmp_path / "run.nc", recipe)]) == 2
    assert "seen = True: is enough" in capsys.readouterr().err
    again = Recipe(**{key: asked[key] for key in asked.keys() & {item.name for item in fields(Recipe)}})
    assert again == recipe


@pytest.mark.parametrize("name", VALUES)
def test_a_point_of_a_config_has_the_option(name):
    point = {"dimension": 2, "count": 20, "radius": 0.5, "side": [8.0, 9.0], "boundary": "periodic"}
    point |= {"temperature": 1.0, "duration": 4.0, "samples": 8, name: VALUES[name]}
    config = {"experiments": {"gas": {"point": point}}, "points": "results/points", "seed": 1}
    (made,) = checked_points(config, "gas").values()
    (recipe,) = recipes(**made.arguments)
    assert stated_options(recipe) == stated_options(RECIPES[name])
    config["experiments"]["gas"]["point"] = {**point, "until": {"Z": 0.1}}
    if rule := UNTIL_Z.get(name):
        with pytest.raises(SceneError, match=f"^experiments.gas.*{rule}"):
            checked_points(config, "gas")
    else:
        (made,) = checked_points(config, "gas").values()
        (recipe,) = recipes(**made.arguments)
        assert recipe.until and stated_options(recipe) == stated_options(RECIPES[name])


@pytest.mark.parametrize(
    ("name", "value", "rule"),
    [
        ("displacements", "yes", "must be true or false"),
        ("follow", 0, "must be a whole number of at least 1"),
        ("follow", 2.5, "must be a whole number"),
        ("keep", "spins", "must be one of"),
        ("pairs", 1, "must be true or false"),
        ("correlations", 1.0, "must be a gaspart.Correlations"),
        ("tallies", "y:8", "must be of gaspart.StressTally, gaspart.ImpulseTally, gaspart.PairImpulseTally"),
        ("tallies", gp.ImpulseTally, "must be of gaspart.StressTally"),
        ("tallies", [WallShearTally()], "must be of gaspart.StressTally"),
    ],
)
def test_a_wrong_value_is_refused_by_its_rule(name, value, rule, tmp_path):
    with pytest.raises(SceneError, match=f"^{name} = .*{rule}"):
        gp.run(SCENE, None, 1, 4.0, 0.5, tmp_path / "run.nc", **{name: value})
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize(
    ("name", "text", "rule"),
    [
        ("impulses", "y:8:8", "must be of the form AXIS:BINS"),
        ("impulses", "w:8", "must be"),
        ("pair_impulses", "2.5", r"must be of the form DISTANCE:SHELLS\[:FRACTION\]"),
    ],
)
def test_a_wrong_text_is_refused_on_the_command_line_and_in_a_config(name, text, rule, tmp_path, capsys):
    scene = tmp_path / "scene.yaml"
    scene.write_text(dump_yaml(SCENE.to_dict()))
    command = ["run", str(scene), "-o", str(tmp_path / "run.nc"), "--duration", "4", "--sample-interval", "1"]
    assert main([*command, f"--{name.replace('_', '-')}", text]) == 2
    assert re.search(f"{name}.*{text[0]}.*{rule}", capsys.readouterr().err)
    point = {"dimension": 2, "count": 20, "radius": 0.5, "packing_fraction": 0.1, "boundary": "periodic"}
    point |= {"temperature": 1.0, "duration": 4.0, "samples": 8, name: text}
    config = {"experiments": {"gas": {"point": point}}, "points": "results/points", "seed": 1}
    with pytest.raises(SceneError, match=f"^experiments.gas.{name}.*{rule}"):
        checked_points(config, "gas")


def test_a_tally_is_requested_once():
    tallies = [gp.ImpulseTally("x", 8), gp.ImpulseTally("y", 8)]
    with pytest.raises(SceneError, match="^impulses = 'y:8': must be requested only once"):
        replace(PLAIN, tallies=tallies)
    both = [gp.PairImpulseTally(2.5, 20), gp.ImpulseTally("y", 8)]
    assert replace(PLAIN, tallies=both) == replace(PLAIN, tallies=[*both[::-1], both[0]])
