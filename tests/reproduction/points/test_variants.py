"""Kernel variants: how two of them differ, and that a tiny run compiles the kernels of a point."""

import json

import pytest

import gaspart as gp
from gaspart.reproduction.points.point import (
    Point,
    compile_kernels,
    compile_task,
    compiled_features,
    variant,
)

SIZE = {"dimension": 2, "count": 1000, "radius": 0.5, "side": 100.0, "temperature": 1.0, "duration": 10.0}
BOX = gp.Container((40.0, 40.0))
GAS = gp.Species(500, 0.5, temperature=1.0)


def point(job="simulate", **settings):
    return Point("gas", "single", job, {**SIZE, "attempts": 10, **settings}, "results/points", 1)


def described(tmp_path, scene, **settings):
    """A point of a scene file."""
    scene.to_file(tmp_path / "scene.yaml")
    given = {"scene": str(tmp_path / "scene.yaml"), "duration": 10.0, **settings}
    return Point("gas", "single", "simulate", given, "results/points", 1)


@pytest.mark.parametrize(
    ("settings", "name"),
    [
        ({}, "event-boxes-2d"),
        ({"boundary": "periodic", "dimension": 3}, "event-boxes-3d"),
        ({"boundary": ["periodic", "wall"], "search": "direct"}, "event-boxes-2d"),
        ({"side": 34.0, "arrangement": "lattice"}, "event-lists-2d"),
        ({"engine": "step", "time_step": 0.1}, "step-list-float64-2d"),
        ({"engine": "step", "time_step": 0.1, "precision": "float32"}, "step-list-float32-2d"),
        ({"job": "fill", "dimension": 3}, "fill-random-3d"),
    ],
)
def test_a_variant_is_named_after_what_is_compiled(settings, name):
    assert variant(point(**settings)) == name


def test_points_that_differ_in_numbers_share_their_kernels():
    assert variant(point(count=10, radius=0.4)) == variant(point(mass=3.0, temperature=2.0))


@pytest.mark.parametrize(
    ("scene", "expected"),
    [
        (gp.Scene(BOX, [GAS], gravity=(0.0, 0.0), restitution=gp.Restitution()), set()),
        (gp.Scene(BOX, [GAS], gravity=(0.0, -1.0)), {"gravity"}),
        (gp.Scene(BOX, [GAS], restitution=gp.Restitution(0.9)), {"law"}),
        (gp.Scene(BOX, [GAS], walls=[gp.Wall((1, 1), (9, 9))]), {"walls"}),
        (gp.Scene(BOX, [GAS, gp.Species(5, 0.5, mass=2.0)]), {"masses"}),
        (gp.Scene(BOX, [gp.Species(5, 0.5, mass=2.0)]), set()),
        (gp.Scene(BOX, [GAS, gp.Species(5, 0.5, fixed=True)]), {"fixed"}),
        (gp.Scene(BOX, [gp.Species(5, 0.5, arrangement="lattice")]), set()),
        (gp.Scene(BOX, [GAS], faces={"x_low": gp.Thermal(2.0, "normal")}), {"thermal"}),
        (gp.Scene(BOX, [GAS], faces={"y_low": gp.Well(1.0, 0.1, 3.0)}), {"well"}),
    ],
)
def test_every_feature_of_a_scene_that_changes_kernels_distinguishes_variants(scene, expected):
    assert compiled_features(scene) == expected


def test_a_point_is_warmed_by_a_few_of_its_own_particles_that_have_all_its_features(tmp_path):
    scene = gp.Scene(
        BOX,
        [GAS, gp.Species(300, 0.25, mass=4.0, moment_of_inertia=0.1)],
        gravity=(0.0, -1.0),
        restitution=gp.Restitution(0.9, 0.5),
        walls=[gp.Wall((x, 1.0), (x, 2.0)) for x in range(1, 39)],
    )
    full = described(tmp_path, scene, follow=400, **{"scene.restitution.tangential": 0.2})
    tiny = gp.Scene.from_dict(json.loads(compile_task(full))["scene"])
    assert [kind.count for kind in tiny.species] == [8, 8] and len(tiny.walls) == 8
    assert compiled_features(tiny) == compiled_features(scene)
    assert variant(full) == variant(described(tmp_path, scene))


def test_a_scene_whose_big_particle_stands_beside_the_boxes_is_warmed_with_all_its_particles(tmp_path):
    scene = gp.Scene(BOX, [gp.Species(900, 0.1)], [gp.Particle((20.0, 20.0), (0.0, 0.0), 5.0)])
    assert compiled_features(scene) == {"oversized"}
    assert gp.Scene.from_dict(json.loads(compile_task(described(tmp_path, scene)))["scene"]) == scene


@pytest.mark.parametrize(
    ("job", "settings"),
    [
        ("simulate", {"boundary": ["periodic", "wall"]}),
        ("measure_cost", {"engine": "step", "time_step": 0.1}),
        ("fill", {"boundary": "periodic", "dimension": 3}),
    ],
)
def test_a_task_is_enough_to_warm_the_kernels(job, settings):
    compile_kernels(compile_task(point(job, **settings)))
