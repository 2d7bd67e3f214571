"""The names of `import gaspart`: loaded when first used."""

import subprocess
import sys

import gaspart as gp

HEAVY = {"numpy", "numba", "xarray", "scipy", "matplotlib", "pandas", "netCDF4"}


def test_importing_the_package_imports_nothing_large():
    code = "import sys, gaspart; gaspart.__all__; print(*{name.split('.')[0] for name in sys.modules})"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert not HEAVY & set(done.stdout.split())


def test_theory_and_analysis_are_attributes():
    assert gp.theory.compressibility_factor(0.1, 3) > 1.0
    assert set(gp.analysis.__all__) <= set(dir(gp.analysis))
    assert all(callable(getattr(gp.analysis, name)) for name in gp.analysis.__all__)
    assert {"analysis", "theory"} <= set(dir(gp))


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
