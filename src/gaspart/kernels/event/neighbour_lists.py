"""Neighbour lists: the particles that a particle may touch before it has moved by a margin.

The *centre* of a particle is its position when its list was made. Its list contains all particles whose
centres are closer to its own centre than the largest diameter plus two margins. Once a particle has moved a
margin away from its centre, its list is renewed. This is a separate event that changes no flight. So in a
dense gas a search tests about a dozen particles, and the cells of the centres are read only once in many
collisions (Verlet, Phys. Rev. 159, 98 (1967); for events Donev, Torquato & Stillinger, J. Comput. Phys. 202,
737 (2005)).

The lists follow from the centres alone, so checkpoints need not contain them.
"""

from math import inf, sqrt
from typing import NamedTuple

import numpy as np
from numpy import int64, uint32, uint64

from gaspart.kernels.compile.policy import inner_helper, inner_kernel, kernel
from gaspart.kernels.event.boxes import NUMBER, X, Y, Z, image_bits, number_of, opposite
from gaspart.kernels.event.simd import earliest, equal, nearer
from gaspart.kernels.memory import aligned_zeros
from gaspart.kernels.model import BOX_FACES, CROSSINGS, NONE, PAIR_TESTS
from gaspart.kernels.simd import WIDTH, lowest

_FAR = 1e30  # coordinate of an unused entry of a cell
_STILL = 1e-280  # squared speed below which a particle counts as immobile

LISTED = np.dtype([("centre", "f8", 3), ("cell", "u4"), ("slot", "u4")], align=True)
"""Centre of a particle, the cell of the centre, and the entry of the particle in this cell."""


def page_dtype(dimension: int) -> np.dtype:
    """Return the data type of a page: centres and numbers of WIDTH entries of a cell in two cache lines."""
    return np.dtype(
        {
            "names": ["centres", "members"],
            "formats": [(np.float32, (dimension, WIDTH)), (np.uint32, (WIDTH,))],
            "offsets": [0, 96],
            "itemsize": 128,
        }
    )


class NeighbourLists(NamedTuple):
    """Neighbour lists, and the cells of the centres (see `state.boxes.Boxes`)."""

    listed: np.ndarray
    candidates: np.ndarray
    room: int
    per_side: np.ndarray
    per_length: np.ndarray
    strides: np.ndarray
    neighbour: np.ndarray
    shift: np.ndarray
    filled: np.ndarray
    pages: np.ndarray
    per_cell: int
    margin: float
    reach: float
    clearance: np.ndarray
    full: np.ndarray


def empty_neighbour_lists(cells, count, dimension, distances, room, per_cell):
    """Return neighbour lists for `count` particles, without entries. `cells`: `state.boxes.Boxes`.
    `distances`: margin, reach, clearance (3,). `room`: length of a row; a list has fewer entries. `per_cell`:
    number of pages per cell.
    """
    return NeighbourLists(
        listed=aligned_zeros((count,), LISTED),
        candidates=aligned_zeros((count * room + 2 * WIDTH,), np.uint32),
        room=room,
        per_side=cells.per_side, per_length=1.0 / cells.widths, strides=cells.strides,
        neighbour=cells.neighbour, shift=cells.shift,
        filled=np.zeros(cells.count, dtype=np.uint32),
        pages=aligned_zeros((cells.count * per_cell,), page_dtype(dimension)),
        per_cell=per_cell,
        margin=distances[0],
        reach=distances[1],
        clearance=distances[2],
        full=np.zeros(2, dtype=np.uint8),
    )  # fmt: skip


@inner_helper
def write_slot(lists, cell, slot, i, centre):
    """Write a particle and its centre (d,) to an entry of a cell."""
    page, lane = cell * uint64(lists.per_cell) + slot // uint64(WIDTH), slot % uint64(WIDTH)
    lists.pages[page].members[lane] = i
    for k in range(lists.pages[page].centres.shape[0]):
        lists.pages[page].centres[k, lane] = centre[k]


@inner_helper
def cell_along(lists, axis, x):
    """Return the coordinate of the cell that contains a point, or of the outermost cell."""
    return min(max(int64(x * lists.per_length[axis]), int64(0)), lists.per_side[axis] - 1)


@inner_helper
def enter_cell(lists, i):
    """Insert a particle into the cell of its centre."""
    listed = lists.listed[i]
    cell = int64(0)
    for k in range(lists.pages[0].centres.shape[0]):
        cell += cell_along(lists, k, listed.centre[k]) * lists.strides[k]
    slot = uint64(lists.filled[cell])
    listed.cell, listed.slot = cell, slot
    if slot == uint64(lists.per_cell * WIDTH):
        lists.full[1] = 1
        return
    write_slot(lists, uint64(cell), slot, i, listed.centre)
    lists.filled[cell] = slot + uint64(1)


@inner_helper
def leave_cell(lists, i):
    """Remove a particle from its cell; the last particle of the cell moves to its entry."""
    cell, slot = uint64(lists.listed[i].cell), uint64(lists.listed[i].slot)
    last = uint64(lists.filled[cell]) - uint64(1)
    page = cell * uint64(lists.per_cell) + last // uint64(WIDTH)
    other = lists.pages[page].members[last % uint64(WIDTH)]
    write_slot(lists, cell, slot, other, lists.listed[other].centre)
    lists.listed[other].slot = slot
    write_slot(lists, cell, last, i, (_FAR, _FAR, _FAR))
    lists.filled[cell] = last


@inner_helper
def append(lists, i, entry):
    """Append an entry, a particle and its image, to a list."""
    row = uint64(i) * uint64(lists.room)
    count = uint64(lists.candidates[row]) + uint64(1)
    if count == uint64(lists.room):
        lists.full[0] = 1
        return
    lists.candidates[row + count] = entry
    lists.candidates[row] = count


@inner_helper
def clear(lists, i):
    """Empty a list: all its entries become the number of the particle itself, which are ignored."""
    row = i * lists.room
    lists.candidates[row] = 0
    for n in range(row + 1, row + lists.room):
        lists.candidates[n] = i


@inner_helper
def strike(lists, i, other):
    """Remove a particle from a list."""
    row = uint64(i) * uint64(lists.room)
    last = row + uint64(lists.candidates[row])
    index = row + uint64(1)
    matches = equal(lists.candidates, index, other, NUMBER)
    while not matches:
        index += uint64(2 * WIDTH)
        matches = equal(lists.candidates, index, other, NUMBER)
    lists.candidates[index + lowest(matches)] = lists.candidates[last]
    lists.candidates[last] = i
    lists.candidates[row] -= uint32(1)


@inner_helper
def list_matches(lists, i, page, matches, image, both):
    """List the particles whose centres are near the centre of a particle. `page`: first page. `matches`: one
    bit for each entry of the pages, WIDTH bits per page. `both`: True to also add the particle to their
    lists.
    """
    while matches:
        slot = lowest(matches)
        matches &= matches - uint64(1)
        other = uint64(lists.pages[page + slot // uint64(WIDTH)].members[slot % uint64(WIDTH)])
        if other != i:
            append(lists, i, other | image)
            if both:
                append(lists, other, i | opposite(image))


@inner_helper
def list_cell(lists, i, point, cell, offset, image, both):
    """List the particles in a cell whose centres are near the centre of a particle. `point`: (3,), centre of
    the particle. `offset`: (3,), displacement of the cell into an image of the container.
    """
    page = cell * uint64(lists.per_cell)
    end = page + max((uint64(lists.filled[cell]) + uint64(WIDTH - 1)) // uint64(WIDTH), uint64(1))
    while page < end:
        matches = nearer(lists.pages, page, point, offset, lists.reach * lists.reach)
        list_matches(lists, i, page, matches, image, both)
        page += uint64(1)


@inner_helper
def list_row(lists, i, point, first, offset, image, both):
    """List near particles in three consecutive cells, which usually have one page each. All three cells are
    processed in one loop, because processors predict the ends of many short loops badly.
    """
    if lists.per_cell > 1:
        for cell in range(first, first + uint64(3)):
            list_cell(lists, i, point, cell, offset, image, both)
        return
    matches = uint64(0)
    for n in range(uint64(3)):
        near = nearer(lists.pages, first + n, point, offset, lists.reach * lists.reach)
        matches |= near << n * uint64(WIDTH)
    list_matches(lists, i, first, matches, image, both)


@inner_kernel
def list_near(lists, i, lengths, both):
    """List the particles whose centres are near the centre of a particle. `both`: True to also add the
    particle to their lists.
    """
    number, centre, neighbour, shift = uint64(i), lists.listed[i].centre, lists.neighbour, lists.shift
    point = centre[0], centre[1], centre[2]
    ax, ay = uint64(cell_along(lists, 0, point[0])), uint64(cell_along(lists, 1, point[1]))
    az = uint64(cell_along(lists, 2, point[2])) if len(lengths) == 3 else uint64(0)
    within = 0 < ax < lists.per_side[0] - 1  # the three cells of a row are adjacent in memory
    for dz in range(uint64(0), uint64(3)):
        z, shift_z = neighbour[2, az, dz], shift[2, az, dz]
        if z < 0:
            continue
        for dy in range(uint64(0), uint64(3)):
            y, shift_y = neighbour[1, ay, dy], shift[1, ay, dy]
            if y < 0:
                continue
            y_offset, z_offset = shift_y * lengths[1], shift_z * lengths[len(lengths) - 1]
            image = image_bits(shift_y, Y) | image_bits(shift_z, Z)
            if within:
                first = uint64(y + z) + ax - uint64(1)
                list_row(lists, number, point, first, (0.0, y_offset, z_offset), image, both)
                continue
            for dx in range(uint64(0), uint64(3)):
                x, shift_x = neighbour[0, ax, dx], shift[0, ax, dx]
                if x >= 0:
                    offset, image_x = (shift_x * lengths[0], y_offset, z_offset), image_bits(shift_x, X)
                    list_cell(lists, number, point, uint64(x + y + z), offset, image | image_x, both)


@inner_helper
def centre_on(lists, flights, i, time, lengths):
    """Set the centre of a particle to its position at a time."""
    late = time - flights[i].clock
    for k in range(len(lengths)):
        lists.listed[i].centre[k] = flights[i].position[k] + flights[i].velocity[k] * late


@inner_kernel
def renew(flights, i, time, lists, space, tally):
    """Renew the list of a particle, and its entries in the lists of others. `time`: present time."""
    tally.counts[CROSSINGS] += 1
    row = i * lists.room
    for n in range(row + 1, row + 1 + int64(lists.candidates[row])):
        strike(lists, number_of(lists.candidates[n]), i)
    clear(lists, i)
    leave_cell(lists, i)
    centre_on(lists, flights, i, time, space.lengths)
    enter_cell(lists, i)
    list_near(lists, i, space.lengths, True)


@kernel
def make_lists(lists, lengths):
    """Make all lists from the centres; `full` is set if there was not enough space."""
    lists.full[:] = 0
    lists.filled[:] = 0
    for page in range(len(lists.pages)):
        lists.pages[page].centres[:] = _FAR
    for i in range(len(lists.listed)):
        clear(lists, i)
        enter_cell(lists, i)
    for i in range(len(lists.listed)):
        list_near(lists, i, lengths, False)


@kernel
def centre_all(lists, flights, time, lengths):
    """Set the centre of each particle to its position at a time."""
    for i in range(len(flights)):
        centre_on(lists, flights, i, time, lengths)


@inner_helper
def search_list(particles, i, lists, space, tally):
    """Predict the contact with a particle of the list, if it is the earliest."""
    row = uint64(i) * uint64(lists.room)
    count = uint64(lists.candidates[row])
    tally.counts[PAIR_TESTS] += int64(count)
    present = particles.predictions[i].contact_time, int64(particles.predictions[i].partner)
    span = row + uint64(1), count
    time, partner, _ = earliest(particles.flights, uint64(i), span, present, lists, space, None)
    particles.predictions[i].contact_time = time
    particles.predictions[i].partner = partner


@inner_helper
def next_renewal(flights, i, lists):
    """Return the time at which a particle has moved by a margin: (time, face code)."""
    if lists is not None:
        flight, centre = flights[i], lists.listed[i].centre
        rr = rv = vv = 0.0
        for k in range(len(flight.position)):
            r, v = flight.position[k] - centre[k], flight.velocity[k]
            rr += r * r
            rv += r * v
            vv += v * v
        if vv > _STILL:
            discriminant = rv * rv - vv * (rr - lists.margin * lists.margin)
            return flight.clock + (sqrt(max(discriminant, 0.0)) - rv) / vv, int64(BOX_FACES)
    return inf, int64(NONE)


@inner_helper
def is_renewed_first(i, time, lists, space, faces):
    """Return True if a list is renewed before its particle can reach a face. The renewal is at `time`, which
    must be finite. All faces must be at rest and farther from the centre than a margin.
    """
    if lists is None or faces is not None:
        return False
    centre, far = lists.listed[i].centre, time < inf
    for k in range(len(space.lengths)):
        far &= (lists.clearance[k] < centre[k]) & (centre[k] < space.lengths[k] - lists.clearance[k])
    return far


@inner_helper
def is_room_lacking(lists):
    """Return True if a list or cell had no space, so that the lists are incomplete."""
    if lists is None:
        return False
    return lists.full[0] + lists.full[1] > 0
