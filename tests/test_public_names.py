"""The names of `import gaspart`, loaded when first used, and of engines, observables and faces."""

import os
import pkgutil
import subprocess
import sys
from importlib import import_module
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

import gaspart as gp
from gaspart.accuracy.target import Target
from gaspart.analysis.observable import observable
from gaspart.analysis.observables import ALIASES, OBSERVABLES, observable_name
from gaspart.engines.engine import resolve_engine
from gaspart.public import entries, read_stub

ROOT = Path(__file__).parents[1]
PACKAGES = ["gaspart", "gaspart.analysis", "gaspart.keys", "gaspart.theory", "gaspart.reproduction.claims"]

HEAVY = {"numpy", "numba", "xarray", "scipy", "matplotlib", "pandas", "netCDF4"}


def test_importing_the_package_imports_nothing_large():
    code = "import sys, gaspart; gaspart.__all__; print(*{name.split('.')[0] for name in sys.modules})"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert not HEAVY & set(done.stdout.split())


def test_every_stub_belongs_to_a_package_that_loads_what_it_states():
    stubs = {path.parent.relative_to(ROOT / "src") for path in (ROOT / "src/gaspart").rglob("*.pyi")}
    assert {".".join(path.parts) for path in stubs} == set(PACKAGES)
    for package in map(import_module, PACKAGES):
        homes = read_stub(f"{package.__file__}i")
        assert package.__all__ == list(homes) and dir(package) == sorted(homes)
        originals, aliases = entries(f"{package.__file__}i")
        for name, home in originals.items():
            assert getattr(package, name) is getattr(import_module(home), name)
        for alias, name in aliases.items():
            assert getattr(package, alias) is getattr(package, name)
        with pytest.raises(AttributeError, match=f"module '{package.__name__}' has no attribute 'Scenes'"):
            _ = package.Scenes


MISTAKES = """import gaspart as gp
gas = gp.Scene(gp.Container((9.0, 9.0)), [gp.Species(20, 0.5, temperature=1.0)])
gp.run(gas, gp.EventDriven(), 1, 2.0, 0.5, "a.nc")
gp.analysis.rdf("a.nc")
gp.Scene(gp.Container((9.0, 9.0)), gravity=1.0)
gp.run(gas, gp.EventDriven(), 1, 2.0, "0.5", "a.nc")
gp.analysis.rdf(3)
gp.theory.collision_rates(0.1, 2)
"""


@pytest.mark.thorough
def test_a_type_checker_finds_mistakes_in_the_use_of_public_names(tmp_path):
    (tmp_path / "mistakes.py").write_text(MISTAKES)
    command = [sys.executable, "-m", "mypy", "mistakes.py", "--config-file", str(ROOT / "pyproject.toml")]
    environment = {**os.environ, "MYPYPATH": str(ROOT / "src")}
    done = subprocess.run(command, cwd=tmp_path, env=environment, capture_output=True, text=True)
    found = [int(line.split(":")[1]) for line in done.stdout.splitlines() if ": error:" in line]
    assert found == [5, 6, 7, 8], done.stdout


def test_no_module_hides_an_observable():
    for module in pkgutil.iter_modules(gp.analysis.__path__, "gaspart.analysis."):
        import_module(module.name)
    for name in (*OBSERVABLES, *ALIASES):
        if name.isidentifier() and hasattr(gp.analysis, name):
            function = OBSERVABLES[observable_name(name)].function
            expected = name if function == "profile" else function
            assert getattr(gp.analysis, name).__name__ == expected
    assert set(OBSERVABLES) <= set(gp.analysis.__all__)


def test_an_accuracy_takes_aliases():
    assert gp.Accuracy("compressibility_factor", 1e-2).observable == "Z"
    with pytest.raises(gp.SceneError, match="temperature.*does not end a run.*give a duration and measure"):
        gp.Accuracy("temperature", 1e-2)


def test_a_plot_over_frames_has_the_time_as_its_axis(tmp_path):
    scene = gp.Scene(gp.Container((9.0, 9.0)), [gp.Species(20, 0.5, temperature=1.0)])
    gp.run(scene, gp.EventDriven("direct"), 1, 2.0, 0.5, tmp_path / "a.nc")
    with gp.open_trajectory(tmp_path / "a.nc") as trajectory:
        (line,) = trajectory["kinetic_energy"].plot()
        assert line.get_xdata().tolist() == [0.0, 0.5, 1.0, 1.5, 2.0]
        assert line.axes.get_xlabel() == "time [time]"
        assert not {"steps", "rebuilds", "overlaps_left"} & set(trajectory)
    gp.run(scene, gp.TimeStepped(time_step=0.01), 1, 2.0, 0.5, tmp_path / "b.nc")
    with gp.open_trajectory(tmp_path / "b.nc") as trajectory:
        assert trajectory["steps"].values[-1] == 200


# The words of the command line are those of Python, and both names of a face are taken.

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


def test_engines_are_taken_by_name():
    assert resolve_engine(None) == resolve_engine("event") == gp.EventDriven()
    assert resolve_engine("dsmc") == gp.DSMC()
    for given, rule in (
        ("step", "engine.time_step = None: is required"),
        ("md", "name = 'md': must be one of"),
    ):
        with pytest.raises(gp.SceneError, match=rule):
            resolve_engine(given)


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
