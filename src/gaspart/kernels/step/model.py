"""What the time-stepped engine's kernels pass to one another: particles, search, model, step, tally.

A *slot* is a particle's present place in memory; `index` gives the particle's number. Arrays are by axis, in
the order of slots. Arguments come in one order: the particles and which of them, the structures of the
search, the model, the step, the tally, the thread, and last whatever may be absent, as in `kernels.model`.
All real numbers have the precision of the positions (float32 or float64). Sums that several threads make are
whole numbers, so that they do not depend on the order of adding.
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
"""What StepTally has, by the fields of `state.tally.Tally`. Two more counts are for the engine alone."""
_NUMBERS = range(len(COUNTS) + 2)
COLLISIONS, PAIR_TESTS, BOX_VISITS, OVERLAPS_LEFT, MULTIPLE, REBUILDS, FIXED, LATE, PASSED = _NUMBERS
VIRIAL, LOSS = range(len(SUMS))
DEEPEST, WORST = range(len(EXTREMES))
FASTEST, DISPLACEMENT = range(2)


class StepParticles(NamedTuple):
    """By slot: positions, velocities (d, N), radii (N,), index (N,), last_pass (N,), the number of the pass
    of the last contact. By particle: images (d, N), masses (N,). bounds (2,): the speed of the FASTEST
    particle and the largest DISPLACEMENT since the list was made, or more.

    ordinary: how many slots boxes and cells hold; the particles beyond, too large for them, come last.
    """

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
    """What is simulated. normal: the restitution of smooth contacts; impulse_share: what such a contact
    passes of the elastic impulse, (1 + normal) / 2; inset: the largest radius, of an ordinary particle, that
    a wall stops; gravity (d,), rules (see `boundaries.Rules`) and law may be None."""

    space: Space
    normal: float
    impulse_share: float
    inset: float
    gravity: tuple | None
    rules: Any
    law: ContactLaw | None


class Search(NamedTuple):
    """The boxes (see `box_search.StepBoxes`), or the cells and pairs (threads, room) of a neighbour list;
    boxes or cells are None."""

    boxes: Any
    cells: Any
    pairs: np.ndarray


class Step(NamedTuple):
    """One pass of a step of length dt. rewind: whether pairs collide as they were at their contact; parting:
    whether overlaps count that began in this step and shrink; number: that of this pass, among those of all
    steps, counted from 1; first: that of the step's first pass; before: that of the pass before if only its
    contacts have changed what a search finds, otherwise 0."""

    dt: float
    rewind: bool
    parting: bool
    number: int
    first: int
    before: int


class StepTally(NamedTuple):
    """counts, sums (..., 2) by `running_sum.add` and extremes, see the names at the module's top; by
    thread: wall_hits (threads, 2d); wall_impulse (threads, 2d, 2) and wall_loss (threads, 2), an energy, both
    by `running_sum.add_whole`; momentum and energy: the powers of two that few terms of these exceed.

    impulses (threads, rows, bins + 1, 2), by `add_whole`: those along an axis, as in
    `kernels.physics.flight`, or None; pull, the acceleration along it; per_length, bins in a unit of length;
    turns, one over the number of bins if the axis is periodic, otherwise 0; row (N,), that of each particle,
    or None if there is one. They are not in a tuple of their own: numba passes no tuples in tuples to
    threads.

    per_area (threads, 2d, 2, 2), by `add_whole`: the momentum along its normal and the heat that each face is
    given, each times the least area of a face that centres of particles of any size can reach, divided by
    that of the particle's size: share (sizes, 2d), with size (N,) of each particle. None unless these
    differ. fixed: True if there are fixed particles, whose collisions are counted apart, otherwise None."""

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


class Found(NamedTuple):
    """Contacts to resolve, by thread: pairs (threads, room, 2) of slots, times (threads, room), number
    (threads,), which may exceed the room; tests (threads,), how many pairs were tested; touching
    (threads, n), room for those of a block that touch."""

    pairs: np.ndarray
    times: np.ndarray
    number: np.ndarray
    tests: np.ndarray
    touching: np.ndarray


@inner_helper
def part_of(part, parts, count):
    """Where part `part` of `count` things divided among `parts` begins, and where it ends."""
    return part * count // parts, (part + 1) * count // parts


# The cells of a neighbour list: rows of them along the first axis, and the particles in memory in their
# order.
#
# So the particles in three cells of a row, one after another, are one stretch of slots. Around the cells
# lies a layer of empty ones; behind a periodic face a row of it holds the slots of the row across the
# container.


ONE = np.uint32(1)  # whole numbers of this type index arrays without a test for negative ones


class Cells(NamedTuple):
    """per_side (3,) cells along each axis, without the layer around them; inverse (3,) of their widths;
    strides (3,) of the index with that layer, which is two cells deep where a row begins; wraps (3,), whether
    the first and the last cell along an axis are neighbours; ends (cells,), behind which slot each cell's
    particles end; cell (N,), in which cell the particle in each slot was when the list was made; order (N,):
    room for the sort; skin, the distance beyond a contact up to which pairs are listed; origin (d, N), where
    the particle in each slot was when the list was made; held (N,), see `shared_contacts`; listed (threads,),
    how long each thread's list is."""

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
    """Which cell along an axis holds coordinate x; the outermost one for x outside."""
    return min(max(int(x * inverse), 0), per_side - 1)


@inner_kernel
def locate(x, inverse, per_side, stride, cell):
    """Add to the cells (n,) of particles the term of their coordinates x (n,) along one axis."""
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
    """Divide the cells among threads, shares[n] to shares[n + 1] (threads + 1,) each: with about as many
    particles, if these are where they were when they were sorted before."""
    threads = len(cells.listed)
    shares[0], shares[threads] = 0, len(cells.ends)
    for part in range(1, threads):
        first = part_of(part, threads, ordinary)[0]
        shares[part] = max(shares[part - 1], cells.cell[first] if ordinary > 0 else ONE - ONE)


@inner_kernel
def order_part(cells, ordinary, first, end):
    """Put the slots in the cells from `first` to `end`, one thread's share, into the order of these, in each
    cell by number; and find where each cell's slots end then."""
    ends, order, width = cells.ends[first:end], cells.order, np.uint32(end - first)
    ends[:] = 0
    place = ONE - ONE
    for cell in cells.cell[:ordinary]:
        within = np.uint32(cell - first)  # of a cell before the first, a large number
        if within < width:
            ends[within] += ONE
        place += np.uint32(cell < first)
    for within in range(width):
        number = ends[within]
        ends[within] = place
        place += number
    for slot in range(ordinary):
        within = np.uint32(cells.cell[slot] - first)
        if within < width:
            order[ends[within]] = slot
            ends[within] += ONE


@inner_kernel
def copy_periodic_rows(cells):
    """Give the rows behind periodic faces the slots of those across the container."""
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
    """permuted[n] becomes values[order[n]] for n from slots[0] to slots[1]."""
    source, permuted = order[slots[0] : slots[1]], permuted[slots[0] : slots[1]]
    for n in range(len(source)):
        permuted[n] = values[source[n]]


@inner_kernel
def copy(permuted, slots, values):
    """values[n] becomes permuted[n] for n from slots[0] to slots[1]."""
    values, permuted = values[slots[0] : slots[1]], permuted[slots[0] : slots[1]]
    for n in range(len(permuted)):
        values[n] = permuted[n]
