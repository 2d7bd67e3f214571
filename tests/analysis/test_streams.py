"""Frames are read in parts: equal bits for parts of any length, in memory that does not grow with the run."""

import subprocess
import sys

import numpy as np
import pytest

import gaspart as gp

_CONTAINER = gp.Container((9.0, 6.0), ("wall", "periodic"))
_MIXTURE = [gp.Species(24, 0.3, temperature=1.0), gp.Species(16, 0.2, temperature=1.0, mass=3.0)]
_SLIDING = {
    "x_low": gp.Thermal(1.0, velocity=(0.0, -1.5)),
    "x_high": gp.Thermal(1.0, velocity=(0.0, 1.5)),
}
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


@pytest.mark.parametrize("name", SCENES)
def test_results_have_the_same_bits_for_parts_of_any_length(tmp_path, monkeypatch, name):
    path = gp.run(SCENES[name], gp.EventDriven(), 1, 20.0, 0.5, tmp_path / "run.nc")
    found = {}
    for numbers in (1, 700, 10**9):  # a frame, some frames, all frames
        monkeypatch.setattr("gaspart.analysis.run._BLOCK", numbers)
        found[numbers] = results(path)
    for part in (1, 700):
        for values, whole in zip(found[part], found[10**9], strict=True):
            np.testing.assert_array_equal(values, whole)


_CHILD = """
import resource, sys
import numpy as np
import gaspart as gp

names = ["speeds", "density", "temperature"]
small, large = sys.argv[1:]
gp.measure(small, names)  # loads what is loaded once
used = int(open("/proc/self/statm").read().split()[0]) * resource.getpagesize()
resource.setrlimit(resource.RLIMIT_AS, (used + 100_000_000,) * 2)
for observable in gp.measure(large, names).values():
    assert np.isfinite(observable.estimate.values).any()
with gp.open_trajectory(large) as trajectory:
    try:
        trajectory["velocities"].values.astype(float)
    except MemoryError:
        print("the whole file does not fit")
"""


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
