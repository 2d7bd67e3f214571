"""The sort into cells, whatever number of threads shares it, is a stable sort by cell."""

import numpy as np
import pytest

from gaspart.kernels.compile.policy import kernel
from gaspart.kernels.step.model import Cells, divide_cells, order_part

CELLS = 50


@kernel
def divide(cells, ordinary, shares):
    divide_cells(cells, ordinary, shares)


@kernel
def order(cells, ordinary, shares):
    for part in range(len(shares) - 1):
        order_part(cells, ordinary, shares[part], shares[part + 1])


def cells_of(cell, threads):
    """Cells of which those of the particles (N,) are given, for so many threads."""
    none = np.empty(0)
    return Cells(
        per_side=none, inverse=none, strides=none, wraps=none,
        ends=np.full(CELLS, 99, np.uint32), cell=cell.astype(np.uint32),
        order=np.zeros(len(cell), np.uint32), skin=0.0, origin=none, held=none, listed=np.zeros(threads, int),
    )  # fmt: skip


@pytest.mark.parametrize("threads", [1, 2, 5])
@pytest.mark.parametrize("count", [0, 3, 400])
def test_threads_that_share_the_cells_sort_as_one(threads, count):
    rng = np.random.default_rng(count)
    drawn = rng.integers(0, CELLS, count)
    for before in (drawn, np.sort(drawn)):  # in no order, as at first, and as the sort before left them
        cells, shares = cells_of(before, threads), np.zeros(threads + 1, np.uint32)
        divide(cells, count, shares)
        assert shares[0] == 0 and shares[-1] == CELLS and np.all(np.diff(shares.astype(int)) >= 0)
        cells.cell[:] = now = np.clip(before + rng.integers(-1, 2, count), 0, CELLS - 1)
        order(cells, count, shares)
        assert cells.order.tolist() == np.argsort(now, kind="stable").tolist()
        assert cells.ends.tolist() == np.cumsum(np.bincount(now, minlength=CELLS)).tolist()


def test_threads_have_as_many_particles_each_as_in_the_order_before():
    crowded = np.sort(np.random.default_rng(1).integers(0, 10, 1000))  # in a fifth of the cells
    cells, shares = cells_of(crowded, 4), np.zeros(5, np.uint32)
    divide(cells, 1000, shares)
    number = np.histogram(crowded, shares.astype(int))[0]
    most_in_one_cell = np.bincount(crowded).max()
    assert np.all(abs(number - 250) <= most_in_one_cell)
