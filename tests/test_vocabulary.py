"""The words of the command line are those of Python, and both names of a face are taken."""

import numpy as np
import pytest
import xarray as xr

import gaspart as gp
from gaspart.accuracy.target import Target
from gaspart.analysis.observable import observable

BOX = gp.Container((8.0, 8.0))
SCENE = gp.Scene(BOX, gp.Species(10, 0.5, temperature=1.0))
WARM = gp.Thermal(2.0)


def test_a_run_has_a_default_engine_and_seed_and_is_measured_by_name(tmp_path):
    usual = gp.run(SCENE, duration=4.0, sample_interval=0.125, path=tmp_path / "usual.nc")
    stated = gp.run(SCENE, gp.EventDriven(), 0, 4.0, 0.125, tmp_path / "stated.nc")
    assert usual.read_bytes() == stated.read_bytes()
    pressure = gp.measure(usual, "pressure")
    xr.testing.assert_identical(pressure, gp.analysis.wall_pressure(usual))
    assert pressure.sel(face="y_low").estimate == pressure.sel(face="y low").estimate
    assert pressure.sel({"face": "y_low"}).estimate == pressure.estimate[2]


def test_names_of_functions_are_names_of_observables(tmp_path):
    run = gp.run(SCENE, duration=4.0, sample_interval=0.125, path=tmp_path / "run.nc")
    measured = gp.measure(run, ["wall_pressure", "collision_rate"])
    assert list(measured) == ["pressure", "collision_rate"]
    xr.testing.assert_identical(measured["pressure"], gp.analysis.pressure(run))
    with pytest.raises(
        gp.SceneError, match="observable = 'presure': unknown observable; did you mean pressure?"
    ):
        gp.measure("run.nc", "presure")


def test_a_face_has_two_names():
    warm = gp.Scene(BOX, SCENE.species, faces={"y low": WARM})
    assert warm == gp.Scene(BOX, SCENE.species, faces={"y_low": WARM}) and list(warm.faces) == ["y_low"]
    assert (
        gp.Scene.from_dict({**SCENE.to_dict(), "faces": {"y low": {"kind": "thermal", "temperature": 2.0}}})
        == warm
    )
    with pytest.raises(gp.SceneError, match="faces.up = .*unknown face; known are x_low"):
        gp.Scene(BOX, faces={"up": WARM})
    assert gp.Accuracy("pressure", 0.1, face="x_low") == gp.Accuracy.from_name("pressure:x low", 0.1)
    assert gp.Accuracy.from_name("pressure:x_low", 0.1).name == "pressure:x low"
    assert Target.from_name(SCENE, "pressure:x_low") == Target.from_name(SCENE, "pressure: x low")
    along = {"face": (np.array(["x low", "x high"]), {})}
    found = observable("p", along, np.array([1.0, 2.0]), np.zeros(2), units="1", long_name="p")
    assert found.sel(face=["x_high"]).estimate.values.tolist() == [2.0]
