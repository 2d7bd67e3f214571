"""`gaspart.sweep`: a grid of runs without a workflow, by the points and jobs of the workflow."""

import json

import numpy as np
import pytest

import gaspart as gp
from gaspart.reproduction.points.points import points
from gaspart.yaml_text import parse_yaml

FRACTIONS = [0.05, 0.1]
GAS = gp.Scene(
    gp.Container((8.0, 8.0, 8.0), boundary="periodic"), [gp.Species(60, 0.5, temperature=1.0)]
)  # fmt: skip


def swept(folder, over=None, observables=("Z",), scene=GAS, progress=None, **options):
    options = {"duration": 30.0, **options}
    over = over or {"packing_fraction": FRACTIONS}
    return gp.sweep(
        scene, over, observables, folder=folder, progress=progress or (lambda *_: None), **options
    )


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    """A sweep with two replicas of each point, and what it reported."""
    folder, reported = tmp_path_factory.mktemp("swept"), []
    data = swept(folder, None, ["Z", "rdf"], replicas=2, progress=lambda *progress: reported.append(progress))
    return folder, data, reported


def test_the_points_are_those_of_a_config(made):
    """The trajectories have the seeds and the bits that an experiment of a workflow would have."""
    folder, data, _ = made
    point = {"dimension": 3, "boundary": "periodic", "temperature": 1.0, "count": 60, "radius": 0.5}
    point |= {"duration": 30.0, "samples": 128, "replicas": 2, "engine": "event"}
    block = {"job": "simulate", "point": point, "grid": {"packing_fraction": FRACTIONS}}
    config = {"experiments": {"points": block}, "seed": 0, "points": str(folder)}
    for row, planned in enumerate(points(config, "points")):
        measured = [gp.analysis.compressibility_factor(path) for path in planned.replica_paths]
        values, errors = ([float(getattr(one, part)) for one in measured] for part in ("estimate", "error"))
        assert float(data.Z[row]) == np.mean(values)
        assert float(data.Z_error[row]) == pytest.approx(np.hypot(*errors) / 2)
        with gp.open_trajectory(planned.replica_path(1)) as trajectory:
            assert trajectory.attrs["packing_fraction"] == pytest.approx(FRACTIONS[row])
            assert json.loads(trajectory.attrs["seed"]) == list(planned.seed(1))


def test_the_table_has_a_dimension_for_what_varies(made):
    _, data, reported = made
    assert data.packing_fraction.values.tolist() == FRACTIONS
    assert data.Z.dims == ("packing_fraction",) and data.rdf.dims == ("packing_fraction", "rdf_distance")
    assert data.rdf_distance_places.shape == data.rdf.shape  # half the side, which differs
    assert np.all(np.abs(data.Z - data.Z_theory) < 5.0 * data.Z_error)
    assert data.duration.values.tolist() == [30.0, 30.0] and data.duration.attrs["units"] == "time"
    assert gp.Scene.from_dict(parse_yaml(data.attrs["scene"])) == GAS
    assert [done[:2] for done in reported] == [(1, 2), (2, 2)]
    assert {name for _, _, name in reported} == {f"packing_fraction={value}" for value in FRACTIONS}


def test_what_is_complete_is_not_made_again(made):
    folder, data, _ = made
    paths = sorted(folder.rglob("*.nc"))
    before = [path.stat().st_mtime_ns for path in paths]
    again = swept(folder, {"packing_fraction": FRACTIONS[::-1]}, replicas=2)
    assert [path.stat().st_mtime_ns for path in paths] == before
    assert again.Z.values.tolist() == data.Z.values[::-1].tolist()


def test_more_replicas_make_only_what_is_missing(tmp_path):
    one = swept(tmp_path, {"packing_fraction": [0.05]})
    path = next(tmp_path.rglob("*.nc"))
    before = path.stat().st_mtime_ns
    two = swept(tmp_path, {"packing_fraction": [0.05]}, replicas=2)
    assert path.stat().st_mtime_ns == before and len(list(tmp_path.rglob("*.nc"))) == 2
    assert float(two.Z_error[0]) < float(one.Z_error[0])


def test_other_settings_replace_nothing_unless_asked_to(tmp_path):
    swept(tmp_path, {"packing_fraction": [0.05]})
    with pytest.raises(gp.SceneError, match=r"points\[packing_fraction=0.05\].path = .*exists"):
        swept(tmp_path, {"packing_fraction": [0.05]}, duration=31.0)
    data = swept(tmp_path, {"packing_fraction": [0.05]}, duration=31.0, overwrite=True)
    assert data.duration.values.tolist() == [31.0]


def test_processes_change_no_bit(made, tmp_path):
    _, data, _ = made
    assert swept(tmp_path, replicas=2, workers=2).Z.equals(data.Z)
    with pytest.raises(gp.SceneError, match=r"points\[packing_fraction=.*path = .*exists"):
        swept(tmp_path, replicas=2, workers=2, duration=31.0)


def test_values_of_a_scene_file_and_of_the_engine_vary(tmp_path):
    """Between walls, with gravity: the values of any scene; runs that end when they are accurate."""
    scene = gp.Scene(gp.Container((8.0, 8.0, 8.0)), [gp.Species(60, 0.5, temperature=1.0)])
    over = {"species.0.temperature": [1.0, 4.0], "boxes_per_side": [1, 4]}
    until = gp.Accuracy("pressure", 0.3, face="x low")
    data = swept(tmp_path, over, ["pressure"], scene, until=until, duration=None, at_most=200.0, samples=800)
    assert data.pressure.dims == (*over, "pressure_face")
    assert data.pressure_face.values.tolist()[:2] == ["x low", "x high"]
    ratio = data.pressure.isel({"species.0.temperature": 1}) / data.pressure.isel(
        {"species.0.temperature": 0}
    )
    assert np.all((ratio.mean("pressure_face") > 2.0) & (ratio.mean("pressure_face") < 8.0))
    assert np.all(data.duration < 200.0)


@pytest.mark.parametrize(
    ("changed", "line"),
    [
        ({"over": {"packing_fracton": [0.1]}}, "over.packing_fracton = .*did you mean packing_fraction"),
        ({"over": {"packing_fraction": [2.0]}}, "over.packing_fraction = 2.0: must be less than 1"),
        ({"over": {"packing_fraction": []}}, r"over.packing_fraction = \[\]: must not be empty"),
        ({"over": {"packing_fraction": [0.1, 0.1]}}, "every point of a grid must be different"),
        ({"over": {"packing_fraction": [0.1], "species.0.mass": [2.0]}}, "replaces a value of a scene file"),
        ({"observables": ["Q"]}, "observable = 'Q': unknown observable"),
        ({"duration": None}, "duration = None: must be given, or until"),
        ({"duration": -1.0}, "duration = -1.0: must be positive"),
        ({"at_most": 3.0}, "at_most = 3.0: needs until"),
        ({"duration": None, "until": gp.Accuracy("Z", 0.1)}, "at_most = None: must be positive"),
        (
            {"duration": None, "at_most": 9.0, "until": gp.Accuracy("Z", 0.1, start=1.0)},
            "until.start = 1.0: is the equilibration of a sweep",
        ),
        ({"replicas": 0}, "replicas = 0"),
        ({"workers": 0}, "workers = 0"),
        ({"equilibration": -1.0}, "equilibration = -1.0: must not be negative"),
        ({"observables": ["pressure"]}, "observables = 'pressure': cannot be measured: .*has no walls"),
        (
            {"scene": gp.Scene(gp.Container((8.0, 9.0, 8.0)), [gp.Species(60, 0.5)])},
            "over.packing_fraction = .*needs a container with equal sides",
        ),
        (
            {"scene": gp.Scene(gp.Container((8.0, 8.0)), [gp.Species(6, 0.5)], gravity=(0.0, -1.0))},
            "over.packing_fraction = .*varies one species alone in a container",
        ),
    ],
)
def test_a_mistake_is_one_line(changed, line, made, tmp_path):
    folder = made[0] if changed.get("observables") == ["pressure"] else tmp_path
    more = {"replicas": 2} if folder == made[0] else {}
    with pytest.raises(gp.SceneError, match=line):
        swept(folder, **{**more, **changed})
