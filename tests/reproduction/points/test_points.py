"""From a config to the points of its grids, and from a point to the parameters of its job."""

import math
import os
import subprocess
import sys

import pytest

from gaspart import theory
from gaspart.errors import SceneError
from gaspart.reproduction.points.engine import boxes_per_side
from gaspart.reproduction.points.points import points
from gaspart.scene.scene import Scene

POINT = {
    "dimension": 2, "count": 100, "radius": 0.5, "packing_fraction": 0.2, "boundary": "periodic",
    "temperature": 2.0, "collisions_per_particle": 50, "equilibration": 3, "samples": 10,
}  # fmt: skip


def config(point=None, grid=None, job="simulate", seed=1):
    block = {"job": job, "point": {**POINT, **(point or {})}}
    if grid is not None:
        block["grid"] = grid
    return {"seed": seed, "points": "results/points", "experiments": {"gas": block}, "figures": {}}


def only(**arguments):
    (point,) = points(config(**arguments), "gas")
    return point


def test_the_product_of_a_mapping_is_taken_and_a_list_is_concatenated():
    product = points(config(grid={"packing_fraction": [0.1, 0.2], "count": [10, 20]}), "gas")
    assert [point.name for point in product] == [
        "packing_fraction=0.1,count=10",
        "packing_fraction=0.1,count=20",
        "packing_fraction=0.2,count=10",
        "packing_fraction=0.2,count=20",
    ]
    listed = points(config(grid=[{"count": [10, 20]}, {"count": 40, "radius": 0.25}]), "gas")
    assert [point.name for point in listed] == ["count=10", "count=20", "count=40,radius=0.25"]
    assert listed[2].settings["radius"] == 0.25


def test_adding_a_value_changes_neither_names_nor_seeds_nor_parameters_of_the_others():
    before = points(config(grid={"packing_fraction": [0.1, 0.3]}), "gas")
    after = {
        point.name: point for point in points(config(grid={"packing_fraction": [0.05, 0.1, 0.3]}), "gas")
    }
    for point in before:
        assert after[point.name] == point
        assert after[point.name].parameters == point.parameters


def test_seeds_differ_between_replicas_points_and_config_seeds():
    first, second = points(config(grid={"count": [10, 20]}), "gas")
    other = points(config(grid={"count": [10, 20]}, seed=2), "gas")[0]
    seeds = [first.seed(0), first.seed(1), second.seed(0), other.seed(0)]
    assert len(set(seeds)) == 4
    assert all(0 <= word < 2**32 for seed in seeds for word in seed)


def test_a_seed_is_the_same_today_and_tomorrow():
    assert only().seed(0) == (2184986234, 2333639417, 659378589, 2926825994)


@pytest.mark.parametrize(
    "given",
    [
        {"count": 100, "radius": 0.5, "packing_fraction": 0.2, "side": None},
        {"count": 100, "radius": 0.5, "packing_fraction": None, "side": math.sqrt(math.pi * 25 / 0.2)},
        {"count": 100, "radius": None, "packing_fraction": 0.2, "side": math.sqrt(math.pi * 25 / 0.2)},
        {"count": None, "radius": 0.5, "packing_fraction": 0.2, "side": math.sqrt(math.pi * 25 / 0.2)},
    ],
)
def test_any_three_of_count_radius_packing_fraction_and_side_make_the_same_scene(given):
    scene = only(point=given).scene
    assert scene.count == 100
    assert scene.largest_radius == pytest.approx(0.5, rel=1e-14)
    assert scene.packing_fraction == pytest.approx(0.2, rel=1e-14)


def test_paths_by_kind_of_job():
    assert only().path == "results/points/gas/single"
    assert only(point={"replicas": 2}).replica_paths == [
        "results/points/gas/single/replica-0.nc",
        "results/points/gas/single/replica-1.nc",
    ]
    assert only(job="measure_cost").path == "results/points/gas/single.nc"


def test_collisions_per_particle_become_time_by_enskogs_rate():
    schedule = only().schedule
    rate = theory.collision_rate(0.2, 2, 1.0, 2.0, 1.0)
    assert schedule.sample_interval == pytest.approx(50 / rate / 10)
    assert schedule.equilibration_frames == 1  # 3 collisions per particle in intervals of 5, rounded up
    assert schedule.duration == pytest.approx(11 * schedule.sample_interval)


def test_steps_are_sampled_at_whole_time_steps():
    steps = {
        "engine": "step",
        "time_step": 0.03,
        "collisions_per_particle": None,
        "steps": 1000,
        "samples": 7,
    }
    schedule = only(point={**steps, "equilibration": 0}).schedule
    assert schedule.sample_interval / 0.03 == pytest.approx(143, rel=1e-14)
    assert schedule.equilibration_frames == 0


def test_boxes_per_particle_are_never_smaller_than_a_diameter():
    assert boxes_per_side(1.0, 1000, 0.1, (10.0, 10.0, 10.0)) == (10, 10, 10)
    assert boxes_per_side(1000.0, 1000, 0.5, (10.0, 20.0)) == (10, 20)
    assert boxes_per_side(1e-6, 10, 0.5, (10.0, 10.0)) == (1, 1)


def test_a_scan_is_timed_beside_the_same_partitions_without_a_key_of_the_engine():
    steps = {"engine": "step", "time_step": 0.01, "scan_boxes_per_side": [3, 6], "near_boxes": True}
    parameters = only(point=steps | {"without": ["near_boxes"]}, job="measure_cost").parameters
    beside = parameters["rival"]
    assert beside["scene"] == parameters["scene"]
    assert [engine["near_boxes"] for engine in parameters["engines"] + beside["engines"]] == [True] * 2 + [
        False
    ] * 2
    assert [engine["boxes_per_side"] for engine in parameters["engines"] + beside["engines"]] == [3, 6, 3, 6]


def test_a_parameters_is_plain_and_makes_the_same_scene():
    point = only(point={"replicas": 2})
    parameters = point.parameters
    assert Scene.from_dict(parameters["scene"]) == point.scene
    assert parameters["seeds"] == [list(point.seed(0)), list(point.seed(1))]
    assert (
        eval(repr(parameters), {"__builtins__": {}}) == parameters
    )  # Snakemake compares the text of parameters


@pytest.mark.parametrize(
    ("arguments", "key"),
    [
        ({"grid": {"count": []}}, "experiments.gas.grid.count"),
        ({"grid": {"count": [10, 10]}}, "experiments.gas.grid"),
        ({"grid": {"arrangement": ["../away"]}}, "experiments.gas.grid.arrangement"),
        ({"point": {"side": 20.0}}, "experiments.gas"),
        ({"point": {"duration": 1.0}}, "experiments.gas"),
        ({"point": {"time_step": 0.1}}, "experiments.gas.time_step"),
        ({"point": {"collisions_per_particle": None, "steps": 10}}, "experiments.gas.steps"),
        ({"point": {"boxes_per_side": 2, "boxes_per_particle": 1}}, "experiments.gas.boxes_per_particle"),
        ({"point": {"temperature": None}}, "experiments.gas.collisions_per_particle"),
        ({"point": {"count": None, "side": [20.0, 20.0, 20.0]}}, "experiments.gas.side"),
        ({"job": "fill"}, "experiments.gas.attempts"),
    ],
)
def test_what_contradicts_itself_is_refused_by_its_key(arguments, key):
    with pytest.raises(SceneError) as refused:
        for point in points(config(**arguments), "gas"):
            _ = point.parameters
    assert refused.value.key == key
    assert "\n" not in str(refused.value)


def test_planning_imports_neither_compiler_nor_pictures():
    """Snakemake reads the config anew for many jobs: functions of the figures import what takes long."""
    code = "from gaspart.reproduction import config, registry; import gaspart.reproduction.points.point, sys"
    code += "; registry.settings(); print(*{'scipy', 'matplotlib', 'numba'} & set(sys.modules))"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.split() == []


def test_engine_auto_becomes_the_engine_for_the_accuracy():
    wanted = {"engine": "auto", "accuracy": 0.01, "collisions_per_particle": None, "equilibration": None}
    point = only(point=wanted)
    assert point.settings["engine"] in ("event", "step")
    assert point.settings["collisions_per_particle"] >= 20 and "accuracy" not in point.settings
    finer = only(point={**wanted, "accuracy": 0.001})
    runs = [one.schedule.duration * one.replicas for one in (point, finer)]
    assert runs[1] > 30 * runs[0]
    assert only(point={**wanted, "collisions_per_particle": 7}).settings["collisions_per_particle"] == 7
    with pytest.raises(SceneError, match="accuracy.*required"):
        only(point={"engine": "auto"})
    with pytest.raises(SceneError, match="accuracy.*needs engine: auto"):
        only(point={"accuracy": 0.01})


def test_the_length_of_a_run_of_a_mixture_is_the_same_on_every_processor():
    """Sums by BLAS are not: each kind of processor has kernels of its own."""
    sizes, fractions = {"polydispersity": 0.2, "arrangement": "random"}, [0.01 * n for n in range(5, 45)]
    program = (
        "from gaspart.reproduction.points.points import points\n"
        f"config = {config(point=sizes, grid={'packing_fraction': fractions})!r}\n"
        "print([point.schedule.duration.hex() for point in points(config, 'gas')])"
    )
    found = {
        subprocess.run(
            [sys.executable, "-c", program],
            env={**os.environ, "OPENBLAS_CORETYPE": kind},
            capture_output=True,
            text=True,
            check=True,
        ).stdout
        for kind in ("Prescott", "Nehalem", "Haswell", "SkylakeX")
    }
    assert len(found) == 1
