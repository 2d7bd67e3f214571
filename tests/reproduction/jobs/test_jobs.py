"""What jobs find, read again; and what is not loaded where they start."""

from __future__ import annotations

import math
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

import gaspart as gp
from gaspart.engines import EventDriven, TimeStepped
from gaspart.reproduction.config import checked_points
from gaspart.reproduction.jobs.arguments import from_plain
from gaspart.reproduction.jobs.compare import compare
from gaspart.reproduction.jobs.data import MADE_BY, PointData, digest_of
from gaspart.reproduction.jobs.echo import DISPLACEMENT, echo
from gaspart.reproduction.jobs.fill import fill
from gaspart.reproduction.jobs.simulate import simulate
from gaspart.reproduction.points.jobs import JOBS
from gaspart.reproduction.points.modules import PACKAGE, closure, find_imports
from gaspart.reproduction.points.trust import require_own
from gaspart.scene.container import Container
from gaspart.scene.scene import Scene
from gaspart.scene.species import Species
from gaspart.trajectory.recording import Recording


def test_what_is_written_is_what_xarray_makes_of_it(tmp_path):
    data = PointData(
        {
            "seconds": (("engine", "repeat"), np.array([[1.5, np.nan], [-0.0, np.inf]]), {"units": "s"}),
            "counts": ("engine", [2**62, -1]),
            "length": ("axis", np.array([1.0, 2.0, 3.0], dtype=np.float32)),
        },
        {"engine": ("engine", ["event", "step"])},
        {"count": 5, "radius": 0.1, "search": "", "side": [1.0, 2.0]},
    )
    data.write(tmp_path / "größe.nc")
    read, made = xr.load_dataset(tmp_path / "größe.nc"), xr.Dataset(*data)
    assert read.attrs.pop("side").tolist() == made.attrs.pop("side")
    xr.testing.assert_identical(read, made)
    assert {name: str(read[name].dtype) for name in ("seconds", "counts", "length")} == {
        "seconds": "float64",
        "counts": "int64",
        "length": "float32",
    }


def test_jobs_load_neither_xarray_nor_pandas():
    """But for the echo, which needs the exponent of `gaspart.analysis`."""
    files = set().union(*(find_imports(PACKAGE / "reproduction/jobs" / f"{name}.py") for name in JOBS))
    files = {path for path in files if "analysis" not in path.parts}
    assert PACKAGE / "trajectory/run.py" in files and PACKAGE / "kernels/insertion.py" in files
    names = [".".join(("gaspart", *path.relative_to(PACKAGE).with_suffix("").parts)) for path in files]
    code = f"import sys, {', '.join(names)}; print(*sys.modules)"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert not {"xarray", "pandas"} & set(done.stdout.split())


# The job whose trajectories may end when observables are accurate.


POINT = {"dimension": 3, "count": 60, "side": 8, "radius": 0.5, "boundary": "periodic", "temperature": 1.0}


def planned(folder="results/points", **settings):
    point = {**POINT, "duration": 4000.0, "until": {"Z": 0.1}, **settings}
    block = {"point": {key: one for key, one in point.items() if one is not None}}
    config = {"experiments": {"accurate": block}, "points": str(folder), "seed": 1}
    (point,) = checked_points(config, "accurate").values()
    return point


def test_a_point_ends_when_it_is_accurate(tmp_path):
    point = planned(tmp_path, replicas=2)
    simulate(tmp_path / "accurate/single", **from_plain(point.parameters))
    for path in point.replica_paths:
        (reached,) = gp.reached_accuracy(path)
        assert reached.met and reached.accuracy <= 0.1
        with gp.open_trajectory(path) as trajectory:
            assert float(trajectory.time[-1]) < 4000.0


def test_the_equilibration_is_not_examined():
    def start(**settings):
        (asked,) = planned(**settings).arguments["until"].accuracies
        return asked.start

    assert start() is None  # a quarter of the run
    assert start(equilibration=10.0, samples=4000) == 10.0
    assert planned(samples=4000).arguments["sample_interval"] == 1.0


def test_only_runs_with_until_depend_on_the_analysis():
    def packages(point):
        return {path.relative_to(PACKAGE).parts[0] for path in closure(*point.modules)}

    assert {"analysis", "accuracy"} <= packages(planned())
    assert {"analysis", "accuracy"}.isdisjoint(packages(planned(until=None)))


@pytest.mark.parametrize(
    ("settings", "line"),
    [
        ({"until": {"Q": 0.1}}, "until.observable = 'Q': unknown observable"),
        ({"until": {"pressure": 0.1}}, "until = 'pressure': container.boundary: has no walls: measure comp"),
        ({"lags": 10}, "lags = 10: has no meaning with until"),
    ],
)
def test_a_mistake_is_one_line(settings, line):
    with pytest.raises(gp.SceneError, match=line):
        planned(**settings)


# Steps beside exact runs from the same state.


GAS = Scene(
    Container((11.0,) * 3, boundary="periodic"),
    species=(Species(256, 0.5, temperature=1.0, arrangement="lattice"),),
)


@pytest.fixture(scope="module")
def run():
    engines = [TimeStepped(step) for step in (4.0, 0.2, 0.002)]
    with pytest.warns(UserWarning, match="misses"):
        return xr.Dataset(*compare(GAS, engines, (1,), equilibration=5.0, interval=0.7, samples=3))


def test_short_steps_find_every_contact_and_long_ones_do_not(run):
    assert (run.collisions[2] == run.exact_collisions[2]).all()
    assert run.virial[2].values == pytest.approx(run.exact_virial[2].values, rel=1e-3)
    assert run.collisions[1].sum() < run.exact_collisions[1].sum()
    assert run.missed[1].sum() > 0
    assert np.abs(run.energy_drift[1:]).max() < 1e-12


def test_the_exact_runs_cover_the_same_time(run):
    assert run.steps.values.tolist() == [4, 4, 350]
    rate = run.exact_collisions.sum("snapshot") / (run.steps * run.time_step)
    assert rate[1] == pytest.approx(float(rate[2]), rel=0.1)
    assert run.exact_z[2].mean() == pytest.approx(1.52, abs=0.1)


def test_a_refused_step_is_told_of(run):
    assert run.refused.values.tolist() == [1, 0, 0]
    assert math.isnan(run.collisions[0, 0]) and math.isnan(run.missed[0, 0])


# There and back.


ECHO_GAS = Scene(Container((8.0,) * 3), species=(Species(40, 0.5, temperature=1.0),))


@pytest.mark.parametrize("engine", [EventDriven(), TimeStepped(0.01)], ids=["event", "step"])
def test_a_short_way_leads_back_to_the_start_and_a_long_one_does_not(engine):
    run = xr.Dataset(*echo(ECHO_GAS, engine, [(1,), (2,)], 1.0, 10.0, 5))
    assert (run.echo[:, -1] > 0.1).all()
    assert np.isfinite(run.exponent).all() == (engine.name == "event")
    short = xr.Dataset(*echo(ECHO_GAS, engine, [(1,), (2,)], 1.0, 0.5, 2))
    assert (short.echo < 1e-11).all()
    assert (np.diff(short.collisions, axis=1) > 0.0).all()
    assert (short.divergence > 0.5 * DISPLACEMENT).all() and (short.divergence < 1e-6).all()


# Filling a container: every failure counted, until the attempts are spent.


@pytest.mark.parametrize("boundary", ["wall", "periodic"])
def test_failures_are_counted_until_the_attempts_are_spent(boundary):
    scene = gp.Scene(gp.Container((8.0, 8.0), boundary), [gp.Species(60, 0.5)])  # far above saturation
    found = xr.Dataset(*fill(scene, attempts=300, seeds=[(1,), (2,)]))
    for replica in range(2):
        placed = int(found["placed"][replica])
        failures = found["failures"][replica].values
        assert 20 < placed < 60
        assert (failures[:placed] >= 0).all()
        assert (failures[placed:] == -1).all()
        assert failures[:placed].sum() + placed <= int(found["attempts"][replica]) == 300 * 60


# A run of more effort continues the files of one of less, which Snakemake has deleted.


def of_effort(folder, effort, **settings):
    point = {**POINT, "duration": 40.0, "samples": 80, "equilibration": 4.0, "replicas": 2, **settings}
    config = {"experiments": {"gas": {"point": point}}, "points": str(folder), "seed": 1, "effort": effort}
    (point,) = checked_points(config, "gas").values()
    simulate(folder / "gas/single", **from_plain(point.parameters))
    return point


@pytest.mark.parametrize("settings", [{}, {"lags": 10, "frames": 8}])
def test_more_effort_continues_what_less_has_made(tmp_path, monkeypatch, settings):
    of_effort(tmp_path / "at once", 1.0, **settings)
    of_effort(tmp_path / "later", 0.5, **settings)
    shutil.rmtree(tmp_path / "later/gas")
    continued = []
    restore = Recording.restore
    monkeypatch.setattr(
        Recording, "restore", lambda self, arrays: (continued.append(self), restore(self, arrays))
    )
    point = of_effort(tmp_path / "later", 1.0, **settings)
    assert len(continued) == point.replicas == 2
    for path in point.replica_paths:
        other = path.replace("later", "at once")
        assert Path(path).read_bytes() == Path(other).read_bytes()


def test_a_file_of_another_point_is_not_measured(tmp_path):
    point = of_effort(tmp_path / "own", 1.0)
    require_own(point)
    other = of_effort(tmp_path / "other", 1.0, count=50)
    shutil.copy(other.replica_path(1), point.replica_path(1))
    with pytest.raises(gp.SceneError, match="replica-1.nc.*was not made by the point gas/single"):
        require_own(point)


def test_a_data_set_of_another_point_is_not_measured(tmp_path):
    block = {"job": "fill", "point": {"count": 10, "side": 8, "radius": 0.5, "attempts": 100, "dimension": 3}}
    config = {"experiments": {"full": block}, "points": str(tmp_path), "seed": 1}
    (point,) = checked_points(config, "full").values()
    Path(point.path).parent.mkdir()
    PointData({"n": ("x", [1.0])}, {}, {MADE_BY: digest_of(point.parameters)}).write(point.path)
    require_own(point)
    (other,) = checked_points({**config, "seed": 2}, "full").values()
    with pytest.raises(gp.SceneError, match="was not made by the point full/single"):
        require_own(other)
