"""A small data set of each figure, that of the smoke run; this program stores them anew.

PYTHONPATH=tests python tests/reproduction/figures/stored_data.py results/smoke/measurements/*.nc
"""

import lzma
import sys
import tempfile
from functools import cache
from pathlib import Path

import numpy as np
import xarray as xr

from gaspart.reproduction.figure import find_parts
from gaspart.reproduction.registry import families, home

FOLDER = Path(__file__).with_name("data")
MOST = 500
"""Number of values of a variable up to which they are stored with all their digits."""


@cache
def stored(figure):
    """The stored data set of a figure."""
    with tempfile.NamedTemporaryFile(suffix=".nc") as file:
        file.write(lzma.decompress((FOLDER / f"{figure}.nc.xz").read_bytes()))
        file.flush()
        return xr.load_dataset(file.name)


def parts(figure):
    """The parts of a figure of gaspart."""
    return find_parts(home(families()[figure]), figure)


def store(path):
    """Store the data set of a file."""
    dataset = xr.load_dataset(path)
    for name, variable in dataset.variables.items():
        variable.encoding = {}
        if variable.dtype == np.float64 and variable.size > MOST:
            dataset[name] = dataset[name].astype(np.float32)
    dataset.attrs = {key: value for key, value in dataset.attrs.items() if key not in ("points", "key")}
    with tempfile.NamedTemporaryFile(suffix=".nc") as file:
        dataset.to_netcdf(file.name)
        FOLDER.mkdir(exist_ok=True)
        (FOLDER / f"{path.stem}.nc.xz").write_bytes(lzma.compress(Path(file.name).read_bytes(), preset=9))


if __name__ == "__main__":
    for path in map(Path, sys.argv[1:]):
        store(path)
