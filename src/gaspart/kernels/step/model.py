"""Data structures of the kernels of the time-stepped engine: particles, search, model, step, and counters.

A *slot* is the present position of a particle in memory; `index` contains the number of the particle in each
slot. Arrays are indexed by axis, then by slot. Arguments have a fixed order: the particles and their indices,
the structures of the search, the model, the step, the tally, the thread, and finally arguments that may be
None, as in `kernels.model`. All floating-point numbers have the precision of the positions (float32 or
float64). Sums over several threads are integers, so they do not depend on the order of addition.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from gaspart.kernels.compile.policy import inner_helper, inner_kernel
from gaspart.kernels.model import ContactLaw, Space

COUNTS = (
    "collisions",
    "pair_tests",
    "box_visits",
    "overlaps_left",
    "multiple_contacts",
    "rebuilds",
    "fixed_collisions",
)
SUMS, EXTREMES = ("virial_sum", "dissipated_energy"), ("deepest_overlap", "worst_contact")
"""Indices of StepTally, under the names of fields of `state.tally.Tally`; two additional counters are used
only by the engine.
"""
_NUMBERS = range(len(COUNTS) + 2)
COLLISIONS, PAIR_TESTS, BOX_VISITS, OVERLAPS_LEFT, MULTIPLE, REBUILDS, FIXED, LATE, PASSED = _NUMBERS
VIRIAL, LOSS = range(len(SUMS))
DEEPEST, WORST = range(len(EXTREMES))
FASTEST, DISPLACEMENT = range(2)


class StepParticles(NamedTuple):
    """Particles by slot, and their periodic images and masses by particle number."""

    positions: np.ndarray
    velocities: np.ndarray
    images: np.ndarray
    radii: np.ndarray
    index: np.ndarray  # type: ignore[assignment]  # tuples have a method of this name
    masses: np.ndarray
    last_pass: np.ndarray
    bounds: np.ndarray
    ordinary: int


class StepModel(NamedTuple):
    """Model of the simulated scene."""

    space: Space
    normal: float
    impulse_share: float
    inset: float
    gravity: tuple | None
    rules: Any
    law: ContactLaw | None


class Search(NamedTuple):
    """Search for contacts: boxes, or the cells and pairs of a neighbour list."""

    boxes: Any
    cells: Any
    pairs: np.ndarray


class Step(NamedTuple):
    """Pass of a step."""

    dt: float
    rewind: bool
    parting: bool
    number: int
    first: int
    before: int


class StepTally(NamedTuple):
    """Counters and sums of a run with time steps. They are not in nested tuples, because numba does not pass
    nested tuples to threads.
    """

    counts: np.ndarray
    sums: np.ndarray
    extremes: np.ndarray
    wall_hits: np.ndarray
    wall_impulse: np.ndarray
    wall_loss: np.ndarray
    momentum: float
    energy: float
    impulses: np.ndarray | None = None
    axis: int = 0
    pull: float = 0.0
    per_length: float = 0.0
    turns: float = 0.0
    row: np.ndarray | None = None
    per_area: np.ndarray | None = None
    share: np.ndarray | None = None
    size: np.ndarray | None = None
    fixed: bool | None = None


class Overlaps(NamedTuple):
    """Contacts to resolve, by thread."""

    pairs: np.ndarray
    times: np.ndarray
    number: np.ndarray
    tests: np.ndarray
    touching: np.ndarray


@inner_helper
def part_of(part, parts, count):
    """Return the first and the last index (exclusive) of an equal slice of `count` items in `parts`."""
    return part * count // parts, (part + 1) * count // parts


# Cells of a neighbour list: rows along the first axis. Particles are stored in memory in the order of cells.
#
# So the particles in three consecutive cells of a row occupy one range of slots. A layer of empty cells
# surrounds the cells. Behind a periodic face, a row of this layer contains the slots of the row at the
# opposite side of the container.


ONE = np.uint32(1)  # unsigned indices need no test for negative values


class Cells(NamedTuple):
    """Cells of a neighbour list."""

    per_side: np.ndarray
    inverse: np.ndarray
    strides: np.ndarray
    wraps: np.ndarray
    ends: np.ndarray
    cell: np.ndarray
    order: np.ndarray
    skin: float
    origin: np.ndarray
    held: np.ndarray
    listed: np.ndarray


@inner_helper
def coordinate(x, inverse, per_side):
    """Return the index along an axis of the cell that contains x; outside, the outermost."""
    return min(max(int(x * inverse), 0), per_side - 1)


@inner_kernel
def locate(x, inverse, per_side, stride, cell):
    """Add the contribution of one axis to the cell numbers (n,) of particles at x (n,)."""
    for n in range(len(x)):
        cell[n] += np.uint32((coordinate(x[n], inverse, per_side) + 1) * stride)


@inner_kernel
def locate_part(particles, part, cells):
    """Find the cells of one thread's slots."""
    low, high = part_of(part, len(cells.listed), particles.ordinary)
    cell = cells.cell[low:high]
    cell[:] = 1
    for k in range(len(particles.positions)):
        x = particles.positions[k, low:high]
        locate(x, cells.inverse[k], cells.per_side[k], cells.strides[k], cell)


@inner_kernel
def divide_cells(cells, ordinary, shares):
    """Divide the cells among threads so that each has about the same number of particles. The particle
    numbers of the last sort are used. `shares`: (threads + 1,), cells shares[n] to shares[n + 1] belong to
    thread n.
    """
    threads = len(cells.listed)
    shares[0], shares[threads] = 0, len(cells.ends)
    for part in range(1, threads):
        first = part_of(part, threads, ordinary)[0]
        shares[part] = max(shares[part - 1], cells.cell[first] if ordinary > 0 else ONE - ONE)


@inner_kernel
def order_part(cells, ordinary, first, end):
    """Sort the slots in one thread's cells, from `first` to `end`, by cell and number. Also find the new end
    of the slots of each cell.
    """
    ends, order, width = cells.ends[first:end], cells.order, np.uint32(end - first)
    ends[:] = 0
    offset = ONE - ONE
    for cell in cells.cell[:ordinary]:
        within = np.uint32(cell - first)  # a large number for a cell before the first
        if within < width:
            ends[within] += ONE
        offset += np.uint32(cell < first)
    for within in range(width):
        number = ends[within]
        ends[within] = offset
        offset += number
    for slot in range(ordinary):
        within = np.uint32(cells.cell[slot] - first)
        if within < width:
            order[ends[within]] = slot
            ends[within] += ONE


@inner_kernel
def copy_periodic_rows(cells):
    """Copy the slots of rows across the container to the rows behind periodic faces."""
    ends = cells.ends
    for k in range(1, 3):
        if cells.wraps[k]:
            stride, across = cells.strides[k], cells.strides[k] * cells.per_side[k]
            for low in range(0, len(ends), across + 2 * stride):
                for n in range(low, low + stride):
                    ends[n] = ends[n + across]
                    ends[n + across + stride] = ends[n + stride]


@inner_kernel
def permute(values, order, slots, permuted):
    """Set permuted[n] to values[order[n]] for n from slots[0] to slots[1]."""
    source, permuted = order[slots[0] : slots[1]], permuted[slots[0] : slots[1]]
    for n in range(len(source)):
        permuted[n] = values[source[n]]


@inner_kernel
def copy(permuted, slots, values):
    """Set values[n] to permuted[n] for n from slots[0] to slots[1]."""
    values, permuted = values[slots[0] : slots[1]], permuted[slots[0] : slots[1]]
    for n in range(len(permuted)):
        values[n] = permuted[n]
