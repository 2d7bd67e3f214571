"""The scene of a point: from a scene file, in which the settings replace values."""

import pytest

import gaspart as gp
from gaspart.errors import SceneError
from gaspart.reproduction.config import check
from gaspart.reproduction.points import points as planned
from gaspart.yaml_text import dump_yaml

SCENE = gp.Scene(
    gp.Container((20.0, 40.0)),
    [gp.Species(50, 0.5, temperature=1.0), gp.Species(20, 0.25, mass=2.0, temperature=1.0)],
    gravity=(0.0, -1.0),
)


@pytest.fixture
def scene_file(tmp_path):
    SCENE.to_file(tmp_path / "two.yaml")
    return str(tmp_path / "two.yaml")


def config(scene_file, varied=None, **settings):
    block = {"point": {"scene": scene_file, "duration": 8.0, "samples": 4, **settings}}
    if varied:
        block["grid"] = varied
    return {
        "title": "t",
        "seed": 1,
        "points": "results/p",
        "experiments": {"gas": block},
        "figures": {"radius_grid": {"experiments": ["gas"]}},
    }


def points(*arguments, **settings):
    return planned.points(config(*arguments, **settings), "gas")


def test_a_point_is_the_scene_of_its_file(scene_file):
    (point,) = points(scene_file, replicas=2, follow=50)
    parameters = point.parameters
    assert point.scene == SCENE == gp.Scene.from_dict(parameters["scene"])
    assert (parameters["duration"], parameters["sample_interval"], parameters["follow"]) == (8.0, 2.0, 50)
    assert point.extents == (70, 0.5, (20.0, 40.0))


def test_a_point_with_lags_keeps_two_frames_of_its_run(scene_file):
    (plain,) = points(scene_file, equilibration=3)
    assert plain.parameters["correlations"] is None
    for lags, kept in ((1, 1), (100, 2)):  # at most half the length, of 4 intervals
        (point,) = points(scene_file, equilibration=3, lags=lags)
        parameters = point.parameters
        assert parameters["correlations"] == {"interval": 2.0, "lags": kept, "start": 4.0}
        assert parameters["duration"] == parameters["sample_interval"] == plain.parameters["duration"] == 12.0


def test_dotted_keys_replace_values_and_add_what_a_mapping_lacks(scene_file):
    varied = {"scene.gravity.1": [-0.5, -2], "scene.species.1.mass": 8, "scene.restitution.normal": [0.5]}
    first, second = points(scene_file, varied)
    assert first.name == "scene.gravity.1=-0.5,scene.species.1.mass=8,scene.restitution.normal=0.5"
    assert [point.scene.gravity for point in (first, second)] == [(0.0, -0.5), (0.0, -2.0)]
    assert [kind.mass for kind in first.scene.species] == [1.0, 8.0]
    assert first.scene.restitution == gp.Restitution(0.5)
    assert points(scene_file)[0].scene == SCENE  # the file's own content is left as it is


def test_a_changed_value_in_the_file_changes_the_parameters_and_a_comment_does_not(scene_file):
    parameters = []
    for old, new in (("container", "# a remark\ncontainer"), ("count: 50", "count: 51")):
        parameters.append(points(scene_file)[0].parameters)
        with open(scene_file, "r+") as file:
            text = file.read()
            assert old in text
            file.seek(0)
            file.write(text.replace(old, new))
    parameters.append(points(scene_file)[0].parameters)
    assert parameters[0] == parameters[1] != parameters[2]


def test_collisions_per_particle_are_for_one_species_and_nothing_else(tmp_path):
    alone = gp.Scene(gp.Container((40.0, 40.0), "periodic"), [gp.Species(100, 0.5, mass=3.0, speed=2.0)])
    alone.to_file(tmp_path / "one.yaml")
    given = {"duration": None, "collisions_per_particle": 8}
    (point,) = points(str(tmp_path / "one.yaml"), **given)
    settings = {"dimension": 2, "count": 100, "radius": 0.5, "side": 40.0, "boundary": "periodic"}
    (same,) = points(None, **given, **settings, mass=3.0, speed=2.0)
    assert point.schedule == same.schedule
    for key, value in (("walls", [{"start": [1.0, 1.0], "end": [5.0, 5.0]}]), ("restitution.normal", 0.9)):
        (point,) = points(str(tmp_path / "one.yaml"), **given, **{f"scene.{key}": value})
        with pytest.raises(SceneError, match=r"collisions_per_particle = 8: .*give duration"):
            _ = point.schedule


@pytest.mark.parametrize(
    ("settings", "key", "rule"),
    [
        ({"scene": "nowhere.yaml"}, "experiments.gas.scene", "cannot be read: No such file"),
        ({"count": 3}, "experiments.gas.count", "no meaning beside a scene file"),
        ({"scene": None}, "experiments.gas.scene.gravity.1", "but there is no scene"),
        ({"scene.species.2.count": 3}, "experiments.gas.scene.species.2.count", "2 must be the number of an"),
        ({"scene.species.0.mass.x": 3}, "experiments.gas.scene.species.0.mass.x", "has 1.0 where this looks"),
        ({"scene.species.0.maas": 3}, "experiments.gas[single].species[0].maas", "unknown key; "),
        ({"scene.species.0.mass": -1}, "experiments.gas[single].species[0].mass", "must be positive"),
        ({"scene.gravity.1": float("nan")}, "experiments.gas.point.scene.gravity.1", "must be a finite"),
        ({"follow": 71}, "experiments.gas.follow", "must be at most 70, the number of particles"),
    ],
)
def test_each_mistake_is_one_line_that_names_the_config(scene_file, tmp_path, settings, key, rule):
    wrong = config(scene_file, **{"scene.gravity.1": -2.0, **settings})
    (tmp_path / "own.yaml").write_text(dump_yaml(wrong))
    with pytest.raises(SceneError) as refused:
        check(wrong, [str(tmp_path / "own.yaml")])
    assert (refused.value.key, refused.value.file) == (key, str(tmp_path / "own.yaml"))
    assert rule in refused.value.rule and "\n" not in str(refused.value)


def test_a_mistake_in_the_scene_file_names_that_file(tmp_path):
    path = tmp_path / "heavy.yaml"
    path.write_text("container: {lengths: [9.0, 9.0]}\nspecies: [{count: 3, radius: 0.5, mass: heavy}]\n")
    with pytest.raises(
        SceneError, match=r"^\S+heavy.yaml: species\[0\].mass = 'heavy': must be a number, without a unit$"
    ):
        _ = points(str(path), **{"scene.species.0.mass": 1.0})[0].parameters
