"""A small data set of each figure, that of the smoke run, with its claims; this program stores them anew.

PYTHONPATH=tests python tests/reproduction/figures/stored_data.py results/smoke/measurements/*.nc
PYTHONPATH=tests python tests/reproduction/figures/stored_data.py FIGURE ...     only the claims
"""

import json
import lzma
import sys
import tempfile
import warnings
from functools import cache
from pathlib import Path

import numpy as np
import xarray as xr

from gaspart.reproduction.claims import judge
from gaspart.reproduction.figure import find_parts
from gaspart.reproduction.registry import families, home

FOLDER = Path(__file__).with_name("data")
MOST = 500
"""Number of values of a variable up to which they are stored with all their digits."""


@cache
def _read(figure):
    with tempfile.NamedTemporaryFile(suffix=".nc") as file:
        file.write(lzma.decompress((FOLDER / f"{figure}.nc.xz").read_bytes()))
        file.flush()
        dataset = xr.load_dataset(file.name)
    return dataset, json.loads(dataset.attrs.pop("claims", "{}"))


def stored(figure):
    """The stored data set of a figure."""
    return _read(figure)[0]


def stored_claims(figure):
    """What the claims of the stored data set were: numbers and verdict by text."""
    return _read(figure)[1]


def judged(figure, dataset):
    """What the claims of a data set are: measured and expected value, with uncertainties, and verdict."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        claims = list(parts(figure).claims(dataset))
    rows = {}
    for one, verdict in zip(claims, judge(claims), strict=True):
        measured, expected = one.measured, one.expected
        numbers = measured.value, measured.error, expected.value, expected.error, one.required
        rows[one.claim] = [*map(float, numbers), verdict]
    return rows


def parts(figure):
    """The parts of a figure of gaspart."""
    return find_parts(home(families()[figure]), figure)


def store(dataset, figure):
    """Store a data set of a figure, and its claims."""
    for name, variable in dataset.variables.items():
        variable.encoding = {}
        if variable.dtype == np.float64 and variable.size > MOST:
            dataset[name] = dataset[name].astype(np.float32)
    dataset.attrs = {key: value for key, value in dataset.attrs.items() if key not in ("points", "key")}
    claims = json.dumps(judged(figure, dataset))
    with tempfile.NamedTemporaryFile(suffix=".nc") as file:
        dataset.assign_attrs(claims=claims).to_netcdf(file.name)
        FOLDER.mkdir(exist_ok=True)
        (FOLDER / f"{figure}.nc.xz").write_bytes(lzma.compress(Path(file.name).read_bytes(), preset=9))


if __name__ == "__main__":
    for name in sys.argv[1:]:
        store(xr.load_dataset(name) if Path(name).exists() else stored(name), Path(name).stem)
