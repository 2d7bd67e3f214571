"""`gaspart.sweep`: a grid of runs without a workflow, by the points and jobs of the workflow."""

import json
from concurrent.futures import ProcessPoolExecutor
from contextlib import suppress
from dataclasses import replace
from multiprocessing import get_context

import numpy as np
import pytest
import xarray as xr

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


def test_the_energy_at_the_start_is_the_same_at_each_point(made):
    """As it is conserved, the pressures of two points would differ by the scatter of drawn velocities."""
    for path in made[0].glob("points/*/replica-*.nc"):
        with gp.open_trajectory(path) as trajectory:
            assert trajectory["kinetic_energy"].values[0] == pytest.approx(0.5 * 3.0 * 59.0, rel=1e-6)


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
    assert data.pressure.dims == (*over, "face")
    assert data.face.values.tolist()[:2] == ["x low", "x high"]
    ratio = data.pressure.isel({"species.0.temperature": 1}) / data.pressure.isel(
        {"species.0.temperature": 0}
    )
    assert np.all((ratio.mean("face") > 2.0) & (ratio.mean("face") < 8.0))
    assert np.all(data.duration < 200.0)


@pytest.mark.parametrize(
    ("changed", "line"),
    [
        ({"over": {"packing_fracton": [0.1]}}, "over.packing_fracton = .*did you mean packing_fraction"),
        ({"over": {"packing_fraction": [2.0]}}, "over.packing_fraction = 2.0: must be less than 1"),
        ({"over": {"packing_fraction": []}}, r"over.packing_fraction = \[\]: must not be empty"),
        ({"over": {"count": [50, 50.0]}}, "over.count = .*: every point of a grid must be different"),
        ({"over": {"duration": [1.0]}}, "over.duration = .*: is an argument of a sweep"),
        ({"over": {"packing_fraction": [0.1], "species.0.mass": [2.0]}}, "replaces a value of a scene file"),
        ({"observables": ["Q"]}, "observable = 'Q': unknown observable"),
        ({"duration": None}, "duration = None: must be given, or until"),
        ({"at_most": 3.0}, "at_most = 3.0: needs until"),
        (
            {"duration": None, "at_most": 9.0, "until": gp.Accuracy("Z", 0.1, start=1.0)},
            "until.start = 1.0: is the equilibration of a sweep",
        ),
        ({"replicas": 0}, "replicas = 0"),
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


BETWEEN_WALLS = gp.Scene(
    gp.Container((6.0, 6.0, 6.0)), [gp.Species(20, 0.5, temperature=1.0)], gravity=(0.0, 0.0, -1.0)
)  # fmt: skip


def test_two_sweeps_in_one_folder_each_run_their_own_scene(tmp_path):
    """Also where the second one is begun, and complete, while the first runs."""
    hot = gp.Scene(gp.Container((12.0, 12.0)), [gp.Species(5, 0.5, temperature=25.0)])
    others = []

    def progress(done, points, name):
        if done == 1:
            others.append(swept(tmp_path, {"species.0.mass": [1.0, 2.0]}, ["density"], hot, duration=3.0))

    over = {"gravity": [[0.0, 0.0, -1.0], [0.0, 0.0, -2.0]]}
    data = swept(tmp_path, over, ["density"], BETWEEN_WALLS, progress, duration=3.0)
    counts = {}
    for path in tmp_path.rglob("*.nc"):
        with gp.open_trajectory(path) as trajectory:
            counts[path.parent.name] = trajectory.attrs["count"]
    assert counts == {
        **{f"scene.gravity=0.0x0.0x{g}": 20 for g in (-1.0, -2.0)},
        **{f"scene.species.0.mass={mass}": 5 for mass in (1.0, 2.0)},
    }
    assert "count: 20" in data.attrs["scene"] and "count: 5" in others[0].attrs["scene"]


def swept_between_walls(folder):
    """A sweep of three points, in a process of its own."""
    over = {"gravity": [[0.0, 0.0, -1.0], [0.0, 0.0, -2.0], [0.0, 0.0, -3.0]]}
    return swept(folder, over, ["density"], BETWEEN_WALLS, duration=20.0)


def test_sweeps_at_the_same_time_share_their_points(tmp_path):
    """In two processes: a point is made once, and both have it."""
    with ProcessPoolExecutor(2, mp_context=get_context("spawn")) as processes:
        seen = list(processes.map(swept_between_walls, [tmp_path] * 2))
    assert seen[0].equals(seen[1]) and set(seen[0].failure.values) == {""}
    assert len(list(tmp_path.rglob("*"))) == 1 + 3 + 3  # points, each with one trajectory, and no lock


@pytest.mark.parametrize("mass", [-1.0, 2.0])
def test_a_file_of_the_user_stays(tmp_path, mass):
    file = tmp_path / "scene.yaml"
    file.write_text("# my own\n")
    with suppress(gp.SceneError):
        swept(tmp_path, {"species.0.mass": [mass]}, ["density"], BETWEEN_WALLS, duration=1.0)
    assert file.read_text() == "# my own\n"


@pytest.mark.parametrize("workers", [1, 2])
def test_a_point_that_cannot_be_made_is_nan_with_the_reason(tmp_path, capfd, workers):
    """Full by random insertion, and impossible beforehand; the others are those of a sweep without them."""
    over = {"packing_fraction": [0.05, 0.72], "radius": [0.25, 0.5]}
    data = swept(tmp_path / "all", over, workers=workers)
    alone = swept(tmp_path / "one", {"packing_fraction": [0.05], "radius": [0.25, 0.5]})
    assert data.Z.sel(packing_fraction=0.05).equals(alone.Z.isel(packing_fraction=0))
    assert np.isnan(data.Z.sel(packing_fraction=0.72)).all()
    assert np.isnan(data.duration.sel(packing_fraction=0.72)).all()
    reasons = data.failure.values
    assert reasons[0].tolist() == ["", ""]
    assert all("does not fit by random insertion" in reason for reason in reasons[1])
    complaint = f"points[packing_fraction=0.72,radius=0.5] is NaN: {reasons[1, 1]}"
    assert complaint in capfd.readouterr().err.splitlines()
    data.to_netcdf(tmp_path / "table.nc")
    assert xr.load_dataset(tmp_path / "table.nc").failure.values.tolist() == reasons.tolist()


def test_settings_that_no_scene_can_have_fail_alone(tmp_path):
    data = swept(tmp_path, {"boxes_per_side": [2, 200]}, duration=5.0)
    assert data.failure.values[1].startswith("boxes_per_side = 200: boxes must not be narrower")
    assert np.isfinite(data.Z[0]) and np.isnan(data.Z[1])


def test_an_observable_that_some_points_lack_is_nan_there(tmp_path, capfd):
    boundaries = ["periodic", "wall"]
    data = swept(tmp_path, {"container.boundary": boundaries}, ["Z", "pressure"])
    assert np.isfinite(data.Z).values.tolist() == [True, False]
    assert np.isfinite(data.pressure).all("face").values.tolist() == [False, True]
    assert "has no walls" in data.failure.values[0] and "needs a periodic" in data.failure.values[1]
    assert "points[scene.container.boundary=wall]: Z is NaN: Z of" in capfd.readouterr().err
    axes = swept(tmp_path / "D", {"container.boundary": ["periodic", ["periodic", "wall", "wall"]]}, ["D"],
                 duration=400.0)  # fmt: skip
    assert axes.failure.values[1] == "D: has other components than elsewhere"
    assert np.isfinite(axes.D[0]) and np.isnan(axes.D[1])


def test_what_no_point_can_have_is_refused_before_any_is_run(tmp_path):
    for observables in (["pressure"], ["Z", "mutual_diffusion"], ["shear_viscosity"]):
        with pytest.raises(gp.SceneError, match=f"observables = '{observables[-1]}': cannot be measured"):
            swept(tmp_path / "new", {"packing_fraction": [0.05]}, observables)
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize(
    ("values", "coordinate"),
    [
        (iter([40, 60]), [40, 60]),
        (xr.DataArray([40, 60]), [40, 60]),
        (40, [40]),
    ],
)
def test_values_of_numpy_and_single_ones_are_taken(tmp_path, values, coordinate):
    data = swept(tmp_path, {"count": values}, "Z", duration=5.0)
    assert data["count"].values.tolist() == coordinate and data["count"].dtype.kind == "i"
    assert np.isfinite(data.Z).all()


def test_single_precision_is_a_number_and_no_key_is_one_point(tmp_path):
    data = swept(tmp_path / "a", {"packing_fraction": np.array([0.05], np.float32)}, "Z", duration=5.0)
    assert data.packing_fraction.values.tolist() == [float(np.float32(0.05))]
    one = gp.sweep(GAS, {}, "Z", folder=tmp_path / "b", duration=5.0, progress=lambda *_: None)
    assert one.Z.dims == () and np.isfinite(one.Z)
    twice = gp.sweep(GAS, {}, ["Z", "Z"], folder=tmp_path / "b", duration=5.0, progress=lambda *_: None)
    assert twice.equals(one)


def test_the_remainder_of_another_sweep_is_replaced_only_if_asked_for(tmp_path):
    """As of the same name and another scene: of a point that was cut short too."""
    over = {"species.0.mass": [1.0]}
    swept(tmp_path, over, ["density"], BETWEEN_WALLS, duration=3.0)
    folder = tmp_path / "points/scene.species.0.mass=1.0"
    folder.rename(f"{folder}.partial")
    other = replace(BETWEEN_WALLS, gravity=(0.0, 0.0, -2.0))
    with pytest.raises(gp.SceneError, match=r"points\[scene.species.0.mass=1.0\].path = .*exists"):
        swept(tmp_path, over, ["density"], other, duration=3.0)
    swept(tmp_path, over, ["density"], other, duration=3.0, overwrite=True)
    with gp.open_trajectory(folder / "replica-0.nc") as trajectory:
        assert gp.Scene.from_dict(parse_yaml(trajectory.attrs["scene"])).gravity == (0.0, 0.0, -2.0)


def test_the_packing_fraction_of_a_polydisperse_species(tmp_path):
    """Z of Boublik, Mansoori, Carnahan, Starling and Leland with the radii of the scene."""
    wide = gp.Scene(
        gp.Container((16.0, 16.0, 16.0), boundary="periodic"),
        [gp.Species(150, 0.5, polydispersity=0.4, temperature=1.0)],
    )
    data = swept(tmp_path, {"packing_fraction": [0.05, 0.15]}, "Z", wide, duration=200.0)
    diameters = 2.0 * wide.species[0].radii
    for row, eta in enumerate((0.05, 0.15)):
        exact = gp.theory.mixture_compressibility_factor(eta, 3, diameters, theory="boublik")
        assert abs(data.Z[row] - exact) < 3.0 * data.Z_error[row] + 0.01  # 1/150 of Z - 1
    with gp.open_trajectory(next(tmp_path.rglob("*.nc"))) as trajectory:
        assert trajectory.attrs["packing_fraction"] in (pytest.approx(0.05), pytest.approx(0.15))


def test_transport_coefficients_of_correlations(tmp_path):
    """Enskog's viscosity, to its accuracy of a few per cent at this density; lags of ten collisions."""
    stress = gp.Correlations(0.125, 80, stress=True)
    names = ["shear_viscosity", "thermal_conductivity", "D"]
    dense = gp.Scene(
        gp.Container((5.0, 5.0, 5.0), boundary="periodic"),
        [gp.Species(60, 0.5, temperature=1.0, exact_temperature=True)],
    )
    data = swept(tmp_path, {"packing_fraction": [0.2]}, names, dense, duration=1000.0, correlations=stress)
    with gp.open_trajectory(next(tmp_path.rglob("*.nc"))) as trajectory:
        assert trajectory.sizes["frame"] == 126 and trajectory.sizes["lag"] == 81  # 8000 samples
    for name in names[:2]:
        assert abs(data[name] - data[f"{name}_theory"])[0] < 3.0 * data[f"{name}_error"][0] + 0.05
    assert np.isfinite(data.D).all()


def test_a_gas_at_rest_is_run_at_its_temperature_of_zero(tmp_path):
    cold = replace(GAS, species=(replace(GAS.species[0], temperature=0.0),))
    with pytest.warns(UserWarning, match="all particles are at rest"):
        data = swept(tmp_path, {"packing_fraction": [0.05]}, "collision_rate", cold)
    assert data.duration.values.tolist() == [30.0] and "none happened" in data.failure.values[0]
