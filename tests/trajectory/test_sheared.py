"""Sheared gases from end to end: files, kills, measurements, checks and pictures."""

import numpy as np
import pytest

import gaspart as gp
from gaspart.cli import main
from gaspart.scene.boundaries import flow

pytestmark = pytest.mark.thorough

FACES = {"y_high": gp.LeesEdwards(0.2)}
SCENE = gp.Scene(gp.Container((12.0, 10.0), "periodic"), [gp.Species(60, 0.5, temperature=1.0)], faces=FACES)
STRESS = gp.Correlations(interval=0.25, lags=4, stress=True)


@pytest.fixture(scope="module")
def path(tmp_path_factory):
    to = tmp_path_factory.mktemp("sheared") / "run.nc"
    return gp.run(SCENE, gp.EventDriven(), 3, 30.0, 1.0, to, correlations=STRESS, displacements=True)


def test_a_trajectory_holds_the_scene_and_the_way_in_the_flow(path):
    sim = gp.Simulation(SCENE, gp.EventDriven(), 3)
    sim.advance(until=30.0)
    with gp.open_trajectory(path) as run:
        assert gp.Scene.from_dict(gp.yaml_text.parse_yaml(run.attrs["scene"])) == SCENE
        moved = sim.state.unwrapped - sim.initial_state.unwrapped
        assert run["displacements"].values[-1] == pytest.approx(moved, abs=1e-4)
        assert abs(moved[:, 0]).max() > 20.0  # along the flow, beyond the container
        steps = np.diff(run["displacements"].values, axis=0)
    assert abs(steps[..., 1]).max() < 6.0 and abs(steps[..., 0]).max() < 12.0  # no jump by an image


def test_the_response_is_that_of_the_pressure_tensor(path):
    tensor = gp.analysis.pressure_tensor(path)
    components = dict(zip(tensor["component"].values, tensor["pressure_tensor"].values, strict=True))
    viscosity = gp.analysis.shear_viscosity(path)
    assert float(viscosity["shear_viscosity"]) == pytest.approx(-components["yx"] / 0.2)
    assert components["xy"] == pytest.approx(components["yx"])
    assert components["xx"] > 0.5
    with gp.open_trajectory(path) as run:
        later = run.isel(frame=run["time"].values >= 7.5)
        relative = later["velocities"].values - flow(SCENE, later["coordinates"].values)
    temperature = (relative**2).sum(axis=(1, 2)).mean() / (2 * (SCENE.count - 1))
    assert temperature > 1.5  # from 1: it heats
    expected = gp.theory.enskog_viscosity(SCENE.packing_fraction, 2, temperature=temperature)
    assert float(viscosity["shear_viscosity_theory"]) == pytest.approx(expected, rel=1e-3)


def test_a_lag_has_no_meaning_for_the_response(path):
    with pytest.raises(gp.SceneError, match="lag = 0.5: is that of fluctuations"):
        gp.analysis.shear_viscosity(path, lag=0.5)


def test_correlations_of_the_motion_are_refused(tmp_path):
    with pytest.raises(gp.SceneError, match="carries particles along"):
        gp.run(
            SCENE, gp.EventDriven(), 3, 5.0, 1.0, tmp_path / "run.nc", correlations=gp.Correlations(0.5, 4)
        )


def test_the_last_state_knows_the_displacement(path, tmp_path):
    assert gp.last_state(path).displaced == pytest.approx(0.2 * 10.0 * 30.0)
    kept = gp.run(SCENE, gp.EventDriven(), 3, 5.0, 1.0, tmp_path / "run.nc", keep_checkpoint=True)
    assert gp.last_state(kept).displaced == pytest.approx(0.2 * 10.0 * 5.0)


def test_its_file_passes_the_checks_and_is_drawn(path, tmp_path, capsys):
    assert main(["check", str(path)]) == 0
    text = capsys.readouterr().out
    assert "all centres are inside" in text
    assert gp.render(path, size=(120, 100)).shape[:2] == (100, 120)
    gp.film(path, tmp_path / "film.gif", size=(120, 100), clock=False, trail=3)
    gp.view(path, frames=4).save(tmp_path / "view.html")
