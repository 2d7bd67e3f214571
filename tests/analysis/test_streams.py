"""Runs are read in parts: equal results for parts of any length, in memory that does not grow with a run."""

import subprocess
import sys

import numpy as np
import pytest

import gaspart as gp

_CONTAINER = gp.Container((9.0, 6.0), ("wall", "periodic"))
_MIXTURE = [gp.Species(24, 0.3, temperature=1.0), gp.Species(16, 0.2, temperature=1.0, mass=3.0)]
_SLIDING = {"x_low": gp.Thermal(1.0, velocity=(0.0, -1.5)), "x_high": gp.Thermal(1.0, velocity=(0.0, 1.5))}
SCENES = {
    "rest": gp.Scene(_CONTAINER, _MIXTURE),
    "fixed": gp.Scene(_CONTAINER, [*_MIXTURE, gp.Species(3, 0.4, fixed=True)]),
    "steady flow": gp.Scene(_CONTAINER, _MIXTURE, faces=_SLIDING),
    "changing flow": gp.Scene(_CONTAINER, _MIXTURE, faces={"x_low": gp.Vibrating(0.2, 1.0)}),
}


def results(path):
    """All values of observables whose frames are read in parts."""
    tables = [
        *gp.measure(path, ["speeds", "density", "temperature"]).values(),
        gp.analysis.field(path, "velocity", "xy", 3),
        gp.analysis.field(path, "temperature", "xy", 3),
        gp.analysis.by_species(path)[["temperature", "mean_speed"]],
    ]
    return [variable.values for table in tables for variable in table.data_vars.values()]


@pytest.mark.thorough
@pytest.mark.parametrize("name", SCENES)
def test_results_have_the_same_bits_for_parts_of_any_length(tmp_path, monkeypatch, name):
    path = gp.run(SCENES[name], gp.EventDriven(), 1, 20.0, 0.5, tmp_path / "run.nc")
    found = {}
    for numbers in (1, 700, 10**9):  # a frame, some frames, all frames
        monkeypatch.setattr("gaspart.analysis.run_data._BLOCK", numbers)
        found[numbers] = results(path)
    for part in (1, 700):
        for values, whole in zip(found[part], found[10**9], strict=True):
            np.testing.assert_array_equal(values, whole)


PERIODIC = gp.Container((9.0, 9.0, 9.0), "periodic")
CORRELATED = {
    "species": gp.Scene(PERIODIC, [gp.Species(100, 0.5, temperature=1.0)]),
    "mixture": gp.Scene(
        PERIODIC, [gp.Species(40, r, temperature=1.0, mass=m) for r, m in ((0.5, 1), (0.4, 2))]
    ),
    "obstacles": SCENES["fixed"],
}


def correlations(path):
    """All values of the correlations of paths and velocities, also of some particles."""
    lag = 1.0
    tables = [
        *gp.measure(path, ["msd", "vacf"]).values(),
        gp.analysis.mean_squared_displacement(path, per_axis=True, about="rest"),
        gp.analysis.mean_squared_displacement(path, particles=[1, 5, 29]),
        gp.analysis.velocity_autocorrelation(path, species=0),
        gp.analysis.diffusion_coefficient(path, lag=lag),
    ]
    return [variable.values for table in tables for variable in table.data_vars.values()]


@pytest.mark.parametrize("displacements", [False, True])
@pytest.mark.parametrize(
    "name", ["species", "mixture", pytest.param("obstacles", marks=pytest.mark.thorough)]
)
def test_correlations_of_blocks_of_particles_are_those_of_all(tmp_path, monkeypatch, name, displacements):
    path = gp.run(CORRELATED[name], seed=1, duration=24.0, sample_interval=0.1, path=tmp_path / "run.nc",
                  displacements=displacements)  # fmt: skip
    whole = correlations(path)
    monkeypatch.setattr("gaspart.analysis.paths._WHOLE", 0)
    for numbers in (3_000, 20_000):  # of five particles, of some more
        monkeypatch.setattr("gaspart.analysis.paths._BLOCK", numbers)
        for values, expected in zip(correlations(path), whole, strict=True):
            assert values == pytest.approx(expected, rel=1e-10, abs=1e-12, nan_ok=True)


@pytest.mark.parametrize("displacements", [False, True])
def test_every_third_frame_is_the_same_in_blocks(tmp_path, monkeypatch, displacements):
    path = gp.run(CORRELATED["mixture"], seed=1, duration=30.0, sample_interval=0.1, path=tmp_path / "run.nc",
                  displacements=displacements)  # fmt: skip
    monkeypatch.setattr("gaspart.analysis.paths.MOST_FRAMES", 80)
    whole = gp.measure(path, "msd")
    monkeypatch.setattr("gaspart.analysis.paths._WHOLE", 0)
    monkeypatch.setattr("gaspart.analysis.paths._BLOCK", 5000)
    monkeypatch.setattr("gaspart.analysis.run_data._BLOCK", 700)
    found = gp.measure(path, "msd")
    assert len(found["lag"]) == len(whole["lag"]) < 40
    assert found.estimate.values == pytest.approx(whole.estimate.values, rel=1e-10)


_CHILD = """
import resource, sys
import numpy as np
import gaspart as gp

names = ["speeds", "density", "temperature", "msd", "vacf"]
small, large = sys.argv[1:]


def measure(path):
    return [*gp.measure(path, names).values(), gp.analysis.diffusion_coefficient(path, lag=5e-4)]


measure(small)  # loads what is loaded once
used = int(open("/proc/self/statm").read().split()[0]) * resource.getpagesize()
resource.setrlimit(resource.RLIMIT_AS, (used + 100_000_000,) * 2)
for observable in measure(large):
    assert np.isfinite(observable.estimate.values).any()
with gp.open_trajectory(large) as trajectory:
    try:
        trajectory["velocities"].values.astype(float)
    except MemoryError:
        print("the whole file does not fit")
"""


@pytest.mark.thorough
@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="limits of address space are Linux's")
def test_a_file_larger_than_memory_is_measured(tmp_path):
    scene = gp.Scene(gp.Container((60.0,) * 3, "periodic"), [gp.Species(20_000, 0.1, temperature=1.0)])
    paths = [tmp_path / name for name in ("small.nc", "large.nc")]
    for path, frames in zip(paths, (20, 400), strict=True):
        gp.run(scene, gp.EventDriven(), 1, 1e-4 * frames, 1e-4, path)
    assert paths[1].stat().st_size > 190_000_000
    child = subprocess.run(
        [sys.executable, "-c", _CHILD, *map(str, paths)], capture_output=True, text=True, check=False
    )
    assert child.returncode == 0, child.stderr[-2000:]
    assert "does not fit" in child.stdout
