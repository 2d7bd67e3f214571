"""The comparison tables of the theory tests."""

from pathlib import Path

import numpy as np
import pytest


@pytest.fixture(scope="session")
def table():
    """Loader of a table of tests/theory/data as a structured array."""

    def load(name):
        return np.genfromtxt(Path(__file__).parent / "data" / f"{name}.csv", delimiter=",", names=True)

    return load
