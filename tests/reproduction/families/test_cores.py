"""Made-up measurements of several cores with known answers."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from numba import config
from reproduction.claims.data import judged
from reproduction.families.drawn import Points, draw, follows, lines, shows

from gaspart.analysis.estimate import Estimate
from gaspart.reproduction.families.cost.claims import cores as claims_of_cores
from gaspart.reproduction.families.cost.figure import cores as draw_cores
from gaspart.reproduction.families.cost.measure import _model
from gaspart.reproduction.families.cost.measure import cores as measure_cores
from gaspart.reproduction.families.shared.timings import SLABS, SYSTEMATIC, speed_up
from gaspart.reproduction.jobs.measure_cost import measure_cost
from gaspart.reproduction.points.point import Point
from gaspart.reproduction.table import Table

SERIAL, OVERHEAD = 0.05, 800.0


def measured(**changed):
    """What `measure.cores` gives on a machine of two cores."""
    count = np.array([1e4, 1e6, 1e6, 1e4, 1e5, 1e5, 1e5, 1e5, 1e6])
    cores = np.array([2, 2, 2, 2, 2, 4, 2, 4, 4])
    dsmc, events, steps = "DSMC, Enskog", "event-driven", "time-stepped"
    columns = {
        "engine": [dsmc, dsmc, dsmc, events, events, events, steps, steps, dsmc],
        "packing_fraction": [0.2, 0.2, 0.05] + [0.2] * 6,
        "count": count.astype(int),
        "copies": [1, 1, 1, 2, 2, 4, 1, 1, 1],
        "cores": cores,
        "speed": np.where(cores <= 2, speed_up(cores, count, SERIAL, OVERHEAD), np.nan),
        "same": [1] * 9,
    } | changed
    ds = xr.Dataset({f"run_{name}": ("run", np.array(values)) for name, values in columns.items()})
    ds["run_speed_error"] = 0.02 * ds["run_speed"]
    models = {
        "engine": [dsmc, dsmc, steps],
        "packing_fraction": [0.05, 0.2, 0.2],
        "serial": [SERIAL] * 3,
        "serial_error": [0.01] * 3,
        "overhead": [OVERHEAD] * 3,
        "overhead_error": [10.0] * 3,
    }
    ds = ds.assign({f"model_{name}": ("model", values) for name, values in models.items()})
    return ds.assign_attrs(cores=2, waiting=0.0)


# Speeds on several cores, from jobs of their own and from made-up times.


GAS = {
    "dimension": 3,
    "count": 1000,
    "radius": 0.5,
    "packing_fraction": 0.1,
    "boundary": "periodic",
    "temperature": 1.0,
    "samples": 2,
}
STEPS = GAS | {"engine": "step", "time_step": 0.01, "steps": 40, "threads": 2, "without": ["threads"]}
EVENTS = GAS | {"engine": "event", "collisions_per_particle": 4, "copies": 2, "without": ["copies"]}


def made(folder, name, settings):
    point = Point("cores", name, "measure_cost", settings, str(folder), 3)
    Path(point.path).parent.mkdir(parents=True, exist_ok=True)
    measure_cost(**point.arguments).write(point.path)
    return point


def timed(point, own, alone, waited=1.0):
    """The file of a point with these times on the wall, and processors for this share of them."""
    with xr.open_dataset(point.path) as file:
        run = file.load()
    run = run.isel(repeat=[0] * len(own)).assign(wall_seconds=(("partition", "repeat"), [own, alone]))
    run["seconds"] = run["wall_seconds"] * run["cores"] * waited
    run.attrs["cores"] = 2
    run.to_netcdf(point.path)


@pytest.fixture
def points(tmp_path):
    return [made(tmp_path, "steps", STEPS), made(tmp_path, "events", EVENTS)]


def test_speeds_are_those_of_the_wall_and_bits_those_of_one_core(points):
    timed(points[0], own=[1.0, 2.0, 1.0], alone=[1.8, 3.6, 1.8])
    timed(points[1], own=[1.0, 1.0, 1.0], alone=[0.9, 0.9, 0.9])
    ds = measure_cores(points, {})
    assert ds.run_engine.values.tolist() == ["time-stepped", "event-driven"]
    assert ds.run_copies.values.tolist() == [1, 2] and ds.run_cores.values.tolist() == [2, 2]
    assert ds.run_speed.values == pytest.approx([1.8, 1.8])
    assert ds.run_speed_error.values == pytest.approx([1.8 * SYSTEMATIC] * 2)
    assert ds.run_same.values.tolist() == [1, 1] and ds.cores == 2


def test_what_others_take_of_the_cores_is_in_every_uncertainty(points):
    for point in points:
        timed(point, own=[1.0, 1.0], alone=[0.2, 0.2], waited=0.9)
    ds = measure_cores(points, {})
    assert ds.waiting == pytest.approx(0.1)
    assert ds.run_speed_error.values == pytest.approx(np.hypot([0.2, 0.4], 0) * SYSTEMATIC + 0.2, abs=0.01)
    without = measure_cores(points[:1], {})
    assert np.isnan(without.waiting) and np.isnan(without.run_speed_error.values).all()


def test_what_needs_more_cores_than_there_are_compares_bits_only(tmp_path, monkeypatch):
    monkeypatch.setattr(config, "NUMBA_NUM_THREADS", 1)
    ds = measure_cores([made(tmp_path, "steps", STEPS), made(tmp_path, "events", EVENTS)], {})
    assert ds.cores == 1 and np.isnan(ds.run_speed.values).all() and ds.run_same.values.tolist() == [1, 1]
    assert np.isnan(ds.model_serial.values).all()


def test_other_bits_are_noticed(points):
    with xr.open_dataset(points[0].path) as file:
        run = file.load()
    run["bits"] = "partition", ["one", "another"]
    run.to_netcdf(points[0].path)
    assert measure_cores(points, {}).run_same.values.tolist() == [0, 1]


@pytest.mark.parametrize(("serial", "overhead"), [(0.05, 800.0), (0.0, 800.0), (0.05, 0.0), (0.0, 0.0)])
def test_the_model_finds_the_shares_that_made_the_speeds(serial, overhead):
    measure_cores, count = np.array([2, 2, 2, 4]), np.array([1e4, 1e5, 1e6, 1e5])
    speed = Estimate(speed_up(measure_cores, count, serial, overhead), 0.01)
    columns = {"cores": measure_cores, "count": count, "speed": speed, "engine": "a", "packing_fraction": 0.1}
    gas = Table(xr.Dataset(coords={"run": range(4)}), "run").assign(**columns)
    found = _model(gas)
    assert found["serial"].value == pytest.approx(serial, abs=1e-6)
    assert found["overhead"].value == pytest.approx(overhead, abs=1e-2)


def test_speeds_above_the_number_of_cores_have_no_serial_share():
    columns = {"cores": [2, 2], "count": [1e4, 1e6], "engine": "a", "packing_fraction": 0.1}
    gas = Table(xr.Dataset(coords={"run": range(2)}), "run")
    found = _model(gas.assign(**columns, speed=Estimate([2.1, 2.2], 0.01)))
    assert found["serial"] == found["overhead"] == Estimate(0.0)


def test_enskog_is_modelled_where_two_threads_share_its_collisions():
    """Not a gas of one slab, nor slabs that more threads share unevenly."""
    count, used = np.array([1e4, 1e5, 1e6, 1e6]), np.array([2, 2, 2, 4])
    speed = Estimate([1.0, *speed_up(2.0, count[1:3], 0.05, 800.0), 2.5], 0.01)
    columns = {"cores": used, "count": count, "speed": speed, "packing_fraction": 0.1}
    gas = Table(xr.Dataset(coords={"run": range(4)}), "run")
    found = _model(gas.assign(**columns, engine="DSMC, Enskog"))
    assert found["serial"].value == pytest.approx(0.05)
    assert _model(gas.assign(**columns, engine="time-stepped"))["serial"].value > 0.1


NAN = float("nan")
SPEEDS = [1.6, 1.9, 1.9, 1.95, 1.7, NAN, 1.8, NAN, NAN]


def test_what_is_right_agrees():
    found = judged(claims_of_cores(measured(speed=SPEEDS)))
    assert len(found) == 7 and set(found.values()) == {"agrees"}


@pytest.mark.parametrize(
    ("changed", "start"),
    [
        ({"speed": [1.6, 1.3, *SPEEDS[2:]]}, "speed with two threads"),
        ({"speed": [*SPEEDS[:3], 1.5, *SPEEDS[4:]]}, "speed of two runs at once"),
        (
            {"same": [1, 1, 1, 1, 1, 0, 1, 1, 1]},
            "runs on several cores that differ from one core in any bit",
        ),
    ],
)
def test_what_is_wrong_is_found(changed, start):
    found = judged(claims_of_cores(measured(**{"speed": SPEEDS} | changed)))
    wrong = [text for text, verdict in found.items() if verdict == "disagrees"]
    assert len(wrong) == 1 and wrong[0].startswith(start)


def test_a_machine_with_one_core_compares_bits_and_decides_no_speed():
    found = judged(claims_of_cores(measured(speed=[NAN] * 9)))
    bits = {text: verdict for text, verdict in found.items() if text.startswith("runs on several")}
    assert set(bits.values()) == {"agrees"}
    assert {found[text] for text in found.keys() - bits} == {"inconclusive"}


def of(ds, *rows, x="run_count"):
    part = ds.isel(run=list(rows))
    return Points(part[x], part["run_speed"], part["run_speed_error"])


def test_speeds_are_drawn_against_particles_and_cores_with_the_model():
    ds = measured()
    dsmc, steps, events, wide = draw(draw_cores, ds).axes
    shows(dsmc, of(ds, 2), of(ds, 0, 1))
    shows(steps, of(ds, 6))
    shows(events, of(ds, 3, 4))
    ways = (6, 7), (1, 8), (4, 5)
    shows(wide, *(of(ds, *rows, x="run_cores") for rows in ways))
    (model,) = [one for one in lines(dsmc) if len(one.get_xdata()) == 100 and np.ptp(one.get_xdata())]
    count = np.geomspace(SLABS["DSMC, Enskog"], 1e6, 100)
    follows(model, count, speed_up(2, count, SERIAL, OVERHEAD))
    ideal, within, beyond = lines(wide)
    assert np.max(within.get_xdata()) <= 2.0 <= np.min(beyond.get_xdata())
    assert (within.get_linestyle(), beyond.get_linestyle()) == ("-", ":")
    follows(ideal, ideal.get_xdata(), ideal.get_xdata())
    for one in (within, beyond):
        follows(one, one.get_xdata(), speed_up(one.get_xdata(), 1e5, SERIAL, OVERHEAD))


def test_what_a_machine_with_one_core_cannot_time_is_said():
    ds = measured(speed=[np.nan] * 9).assign_attrs(cores=1)
    assert all("not timed" in axis.texts[0].get_text() for axis in draw(draw_cores, ds).axes[:3])
