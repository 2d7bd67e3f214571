"""Made-up measurements of estimators with known answers."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
import xarray as xr
from reproduction.claims.data import judged
from reproduction.families.drawn import column, draw, shows

import gaspart as gp
from gaspart.analysis.run import open_run
from gaspart.reproduction.families.pressure.claims import estimators as claims_of_estimators
from gaspart.reproduction.families.pressure.figure import estimators as draw_estimators
from gaspart.reproduction.families.pressure.measure import blocks_of, pressures_of
from gaspart.trajectory.reading import open_trajectory


def measured(**changed):
    """What `measure.estimators` gives of two gases in two widths of bins."""
    columns = {
        "packing_fraction": [0.05, 0.05, 0.4, 0.4],
        "width": [0.1, 0.5, 0.1, 0.5],
        "mixture": [30.0, 9.0, 1.8, 1.1],
        "impulses": [29.0, 8.0, 1.7, 0.8],
        "at_walls": [70.0, 20.0, 6.0, 1.5],
        "mean_square": [1.05, 0.9, 1.1, 0.95],
        "additions": [0.03, 0.03, 0.07, 0.07],
        "pressure": [15.0, 15.0, 1.3, 1.3],
        "pressures_apart": [0.002, 0.002, -0.001, -0.001],
    } | changed
    ds = xr.Dataset({name: ("case", np.array(values)) for name, values in columns.items()})
    for name in (
        "mixture",
        "impulses",
        "at_walls",
        "mean_square",
        "additions",
        "pressure",
        "pressures_apart",
    ):
        ds[f"{name}_error"] = 0.02 * ds[name]
        ds[f"{name}_freedom"] = "case", np.full(4, 7.0)
    ds["pressures_apart_error"] = "case", np.full(4, 0.002)
    return ds


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    """A few spheres that fall in a container 4 high, of which three quarters are measured."""
    container = gp.Container((6.0, 6.0, 4.0), ("periodic", "periodic", "wall"))
    scene = gp.Scene(container, [gp.Species(20, 0.4, temperature=1.0)], gravity=(0.0, 0.0, -0.5))
    path = tmp_path_factory.mktemp("falling") / "run.nc"
    gp.run(scene, gp.EventDriven(), 5, 65.0, 0.5, path, tallies=[gp.ImpulseTally("z", 16)])
    with open_trajectory(path) as data, open_run(data, 0.0) as found:
        yield found


def test_blocks_have_all_particles_in_counts_and_impulses(run):
    counted, impulses = blocks_of(run, 0.5)
    assert counted.shape == impulses.shape == (32, 8)
    assert np.allclose(counted.sum(axis=1), 20.0) and np.allclose(impulses.sum(axis=1), 20.0)
    places = run.positions[1:129, :, 2]
    assert counted[0] == pytest.approx(np.histogram(places[:4], 8, (0.0, 4.0))[0] / 4.0)
    assert impulses.mean(axis=0) == pytest.approx(counted.mean(axis=0), abs=0.4)


def test_other_bins_and_runs_without_impulses_are_refused(run):
    for width in (0.3, 0.1):
        with pytest.raises(gp.SceneError, match="do not divide"):
            blocks_of(run, width)
    with pytest.raises(gp.SceneError, match="None"):
        blocks_of(replace(run, data=run.data.assign_attrs(tallies="[]")), 0.5)


def test_pressures_of_a_run_by_impulses_and_with_what_is_known(run, tmp_path):
    """Under gravity nothing is known beside them, so that both are one."""
    assert pressures_of(run) == {"pressure": 1.0, "pressures_apart": 0.0}
    scene = replace(run.scene, gravity=None)
    path = gp.run(
        scene, gp.EventDriven(), 1, 200.0, 0.5, tmp_path / "run.nc", tallies=[gp.ImpulseTally("z", 4)]
    )
    with open_trajectory(path) as data, open_run(data, 20.0) as found:
        gained = pressures_of(found)
    assert gained["pressure"] > 4.0 and abs(gained["pressures_apart"]) < 0.1


def test_what_is_right_agrees():
    found = judged(claims_of_estimators(measured()))
    assert len(found) == 9 and set(found.values()) == {"agrees"}


@pytest.mark.parametrize(
    ("changed", "start"),
    [
        ({"mean_square": [1.05, 0.9, 2.5, 0.95]}, "mean square"),
        ({"mixture": [12.0, 9.0, 1.8, 1.1]}, "variance"),
        ({"mixture": [30.0, 9.0, 0.8, 1.1]}, "variance"),
        ({"pressures_apart": [0.002, 0.002, 0.02, 0.02]}, "pressure by impulses"),
        ({"pressure": [5.0, 5.0, 1.3, 1.3]}, "squared error"),
    ],
)
def test_what_is_wrong_is_found(changed, start):
    found = judged(claims_of_estimators(measured(**changed)))
    wrong = [text for text, verdict in found.items() if verdict == "disagrees"]
    assert len(wrong) == 1 and wrong[0].startswith(start)


def test_gains_are_drawn_against_the_packing_fraction():
    ds = measured()
    everywhere, walls, pressure = draw(draw_estimators, ds).axes
    for axis, name in ((everywhere, "mixture"), (walls, "at_walls")):
        rows = ds.isel(case=[0, 2]), ds.isel(case=[1, 3])
        shows(axis, *(column(row, "packing_fraction", name) for row in rows))
    shows(pressure, column(ds.isel(case=[0, 2]), "packing_fraction", "pressure"))
