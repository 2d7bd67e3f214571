"""Malformed scenes, configs and arguments are accepted, or refused in one line, within two seconds."""

import dataclasses
import inspect

import pytest
from hypothesis import given
from hypothesis import strategies as st
from malformed import NASTY, OBJECTS, SCENES, configs, extreme_configs, mutated, one_line, planned_configs

import gaspart as gp
from gaspart.engines import engine_from_dict
from gaspart.errors import SceneError
from gaspart.reproduction.config import check
from gaspart.scene.faces import Piston, Vibrating
from gaspart.scene.surfaces import Sticky, Thermal, Well
from gaspart.scene.walls import Plate, box_of_walls
from gaspart.yaml_text import dump_yaml

VALID = {
    gp.Container: {"lengths": (8.0, 9.0), "boundary": "wall"},
    gp.Species: {"count": 3, "radius": 0.5, "speed": 1.0},
    gp.Particle: {"position": (4.0, 4.0), "velocity": (1.0, 0.0), "radius": 0.5, "spin": 0.1},
    gp.Restitution: {"normal": 0.9, "tangential": 0.5},
    gp.Wall: {"start": (1.0, 1.0), "end": (2.0, 1.0)},
    Plate: {"corner": (1.0, 1.0, 1.0), "edges": ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0))},
    Thermal: {"temperature": 1.0, "components": "all"},
    Well: {"depth": 1.0, "width": 0.5},
    Sticky: {"momentum": 1.0},
    Piston: {"mass": 10.0, "pressure": 1.0},
    Vibrating: {"amplitude": 0.1, "period": 1.0, "waveform": "sawtooth"},
    gp.Scene: {"container": gp.Container((8.0, 9.0)), "species": [gp.Species(3, 0.5)]},
    gp.EventDriven: {"search": "boxes"},
    gp.TimeStepped: {"time_step": 0.01},
    gp.DSMC: {"cells_per_side": 4},
    box_of_walls: {"lower": (1.0, 1.0), "upper": (2.0, 2.0)},
}
PARTS = [kind(**values) for kind, values in VALID.items()]


def arguments(kind):
    """Every argument of a constructor, replaced by anything, others as they are in a valid call."""
    names = list(inspect.signature(kind).parameters)
    for name in names:
        for value in (*NASTY, *OBJECTS, *PARTS, [PARTS[0]], [PARTS[1], None], [[1.0, object()]] * 2):
            yield {**VALID[kind], name: value}


@pytest.mark.parametrize("kind", VALID, ids=lambda kind: kind.__name__)
def test_a_constructor_takes_any_argument_or_refuses_it_in_one_line(kind):
    for values in arguments(kind):
        one_line(lambda values=values: kind(**values))


def test_valid_ones_are_accepted():
    for scene in SCENES:
        assert one_line(gp.Scene.from_dict, scene)
    for config in configs():
        assert one_line(check, config)


@pytest.mark.parametrize(
    ("kind", "changes", "message"),
    [
        (gp.Species, {"count": 10**400}, "count = <an integer of 401 digits>: must be a whole number"),
        (gp.Species, {"radius": 1e300}, "radius = 1e+300: must be from 1e-60 to 1e+60: choose other units"),
        (gp.Wall, {"end": (1.0 + 1e-300, 1.0), "start": (1.0, 1.0)}, "must have a length"),
        (Plate, {"edges": ((1e-300, 0.0, 0.0), (0.0, 1.0, 0.0))}, "edges = 1e-300: must be from 1e-60"),
        (gp.Scene, {"species": None}, "species = None: must be a Species"),
        (gp.Scene, {"gravity": (0.0, 1e300)}, "gravity = (0.0, 1e+300): must be 0 or of a size"),
        (gp.Container, {"lengths": range(10**9)}, "must be a list of 2 or 3 finite numbers"),
    ],
)
def test_values_that_cannot_be_computed_with_are_named(kind, changes, message):
    with pytest.raises(SceneError) as refused:
        kind(**{**VALID[kind], **changes})
    assert message in str(refused.value)


def test_the_kind_of_a_face_and_of_an_engine_is_text():
    with pytest.raises(SceneError, match=r"x_low.kind = \[\]: must be one of"):
        gp.Scene.from_dict({"container": {"lengths": [8, 8]}, "faces": {"x_low": {"kind": []}}})
    with pytest.raises(SceneError, match=r"engine.name = \[\]: must be one of"):
        engine_from_dict({"name": []})


def test_a_scene_of_more_particles_than_can_be_numbered_is_refused():
    kinds = [gp.Species(2**31 - 1, 1e-6), gp.Species(1, 1e-6)]
    with pytest.raises(SceneError, match="count = 2147483648: must be at most 2147483647"):
        gp.Scene(gp.Container((1e5, 1e5)), kinds)


def test_all_are_frozen_and_keep_what_they_were_made_of():
    for part in PARTS[:-1]:
        if dataclasses.is_dataclass(part):
            assert dataclasses.replace(part) == part


@given(mutated(SCENES, NASTY))
def test_a_malformed_scene_is_one_line(content):
    if one_line(gp.Scene.from_dict, content):
        scene = gp.Scene.from_dict(content)
        assert gp.Scene.from_dict(scene.to_dict()) == scene


@given(mutated(SCENES, [*NASTY, *OBJECTS, *PARTS]))
def test_a_malformed_scene_from_python_is_one_line(content):
    one_line(gp.Scene.from_dict, content)


@given(st.data())
def test_a_malformed_config_is_one_line(data):
    one_line(check, data.draw(mutated(configs(), [*NASTY, OBJECTS[-1]])))


@given(planned_configs())
def test_a_point_that_cannot_be_planned_is_one_line(config):
    one_line(check, config)


@given(extreme_configs())
def test_a_config_of_extreme_points_is_one_line(config):
    one_line(check, config)


@given(st.data())
def test_a_malformed_config_names_its_file(tmp_path_factory, data):
    path = tmp_path_factory.mktemp("config") / "own.yaml"
    config = data.draw(mutated(configs(), [value for value in NASTY if value != "\ud800"]))
    try:
        path.write_text(dump_yaml(config), encoding="utf-8")
    except UnicodeEncodeError:
        return
    try:
        check(config, [path])
    except SceneError as error:
        assert error.file is not None
