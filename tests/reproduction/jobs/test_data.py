"""What jobs find, read again; and what is not loaded where they start."""

import subprocess
import sys

import numpy as np
import xarray as xr

from gaspart.reproduction.jobs.data import PointData
from gaspart.reproduction.points.jobs import JOBS
from gaspart.reproduction.points.modules import PACKAGE, find_imports


def test_what_is_written_is_what_xarray_makes_of_it(tmp_path):
    data = PointData(
        {
            "seconds": (("engine", "repeat"), np.array([[1.5, np.nan], [-0.0, np.inf]]), {"units": "s"}),
            "counts": ("engine", [2**62, -1]),
            "length": ("axis", np.array([1.0, 2.0, 3.0], dtype=np.float32)),
        },
        {"engine": ("engine", ["event", "step"])},
        {"count": 5, "radius": 0.1, "search": "", "side": [1.0, 2.0]},
    )
    data.write(tmp_path / "größe.nc")
    read, made = xr.load_dataset(tmp_path / "größe.nc"), xr.Dataset(*data)
    assert read.attrs.pop("side").tolist() == made.attrs.pop("side")
    xr.testing.assert_identical(read, made)
    assert {name: str(read[name].dtype) for name in ("seconds", "counts", "length")} == {
        "seconds": "float64",
        "counts": "int64",
        "length": "float32",
    }


def test_jobs_load_neither_xarray_nor_pandas():
    """But for the echo, which needs the exponent of `gaspart.analysis`."""
    files = set().union(*(find_imports(PACKAGE / "reproduction/jobs" / f"{name}.py") for name in JOBS))
    files = {path for path in files if "analysis" not in path.parts}
    assert PACKAGE / "trajectory/run.py" in files and PACKAGE / "kernels/insertion.py" in files
    names = [".".join(("gaspart", *path.relative_to(PACKAGE).with_suffix("").parts)) for path in files]
    code = f"import sys, {', '.join(names)}; print(*sys.modules)"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert not {"xarray", "pandas"} & set(done.stdout.split())
