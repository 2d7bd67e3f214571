"""Accuracies of what faces are given: heat, momentum along them, and the flow between them."""

import pytest
from battery.kinds_of_runs import KINDS

import gaspart as gp
from gaspart.accuracy import pilot, plan
from gaspart.accuracy.estimates import components
from gaspart.analysis.measuring import measure
from gaspart.analysis.observables import OBSERVABLES
from gaspart.runs.ending import require_measurable
from gaspart.trajectory.run_options import Contents

SLIT = gp.Container((10.0, 6.0), ("periodic", "wall"))
COLD = gp.Scene(
    SLIT, [gp.Species(12, 0.5, temperature=1.0)], faces={"y_low": gp.Thermal(1.0), "y_high": gp.Thermal(1.0)}
)


def between(low, high):
    return gp.Scene(SLIT, COLD.species, faces={"y_low": low, "y_high": high})


HEATED = between(gp.Thermal(1.0), gp.Thermal(3.0))
SLIDING = between(gp.Thermal(1.0), gp.Thermal(1.0, velocity=(2.0, 0.0)))


@pytest.fixture(autouse=True)
def own_cache(tmp_path, monkeypatch):
    monkeypatch.setattr(pilot, "cache_directory", lambda: tmp_path / "cache")


COUETTE = gp.Scene(
    gp.Container((6.0, 6.0, 6.0), boundary=("wall", "periodic", "periodic")),
    [gp.Species(100, 0.2, temperature=1.0)],
    faces={
        "x_low": gp.Thermal(1.0, velocity=(0.0, -1.0, 0.0)),
        "x_high": gp.Thermal(1.0, velocity=(0.0, 1.0, 0.0)),
    },
)
"""Symmetry makes the stress along z zero, and the velocity along z everywhere."""


@pytest.mark.thorough
def test_the_heat_flux_is_not_the_pressure(tmp_path):
    """Both are of faces: each component is that of the measured observable, with its freedom."""
    path = gp.run(HEATED, gp.EventDriven(), 1, 400.0, 1.0, tmp_path / "run.nc")
    with gp.open_trajectory(path) as data:
        found, measured = components(data, "heat_flux"), measure(data, "heat_flux")
    assert list(found) == ["y low", "y high"]
    for face, one in found.items():
        exact = measured.sel(face=face)
        assert (one.value, one.freedom) == (float(exact.estimate), float(exact["heat_flux_freedom"]))
        assert one.estimate.error == pytest.approx(float(exact.error))
    assert found["y low"].value > 0.0 > found["y high"].value


@pytest.mark.parametrize(
    ("scene", "observable", "accuracy"),
    [
        (KINDS["plates"].scene, "heat_flux", 0.3),
        (KINDS["plates"].scene, "wall_shear", 0.3),
        pytest.param(COUETTE, "wall_shear", 0.1, marks=pytest.mark.thorough),
        pytest.param(COUETTE, "velocity", 0.3, marks=pytest.mark.thorough),
    ],
)
def test_runs_end_when_they_are_accurate(tmp_path, scene, observable, accuracy):
    asked = gp.Accuracy(observable, accuracy)
    settings = {"sample_interval": 1.0, "at_most": 4000.0, "pairs": True}
    path = gp.run(scene, gp.EventDriven(), 1, path=tmp_path / "run.nc", until=asked, **settings)
    (reached,) = gp.reached_accuracy(path)
    assert reached.met and reached.accuracy <= accuracy


@pytest.mark.thorough
def test_the_heat_flux_to_one_face_is_advised():
    made = plan.plan(HEATED, "heat_flux:y low", 0.4, pilot_seconds=0.4)
    (asked,) = made.recipe.until.accuracies
    assert asked.name == "heat_flux:y low" and made.value > 0.0


@pytest.mark.parametrize(
    ("scene", "observable", "reason"),
    [
        (COLD, "heat_flux", "have one temperature: the heat flux is 0 on average"),
        (COLD, "velocity", "nothing drives a flow"),
        (SLIDING, "flux", "the net flux between walls is 0 in a steady state"),
        (HEATED, "heat_flux:x low", "must be one of the walls, y low, y high"),
    ],
)
def test_what_vanishes_is_refused(scene, observable, reason):
    with pytest.raises(gp.SceneError, match=reason):
        plan.plan(scene, observable, 0.1, pilot_seconds=0.1)
    if OBSERVABLES[observable.partition(":")[0]].ends_runs:
        with pytest.raises(gp.SceneError, match=reason):
            require_measurable(gp.Accuracy.from_name(observable, 0.1), scene, gp.EventDriven(), Contents())
