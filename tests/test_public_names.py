"""The names of `import gaspart`: loaded when first used."""

import os
import pkgutil
import subprocess
import sys
from importlib import import_module
from pathlib import Path

import pytest

import gaspart as gp
from gaspart.analysis.observables import ALIASES, OBSERVABLES, observable_name
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
