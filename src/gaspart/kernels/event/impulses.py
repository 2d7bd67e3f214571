"""Impulses along one axis, tallied by the position of the particle that receives them.

They make density profiles more accurate (`kernels.physics.flight`).
"""

from __future__ import annotations

from functools import reduce
from math import floor, sqrt
from typing import NamedTuple

import numpy as np
from llvmlite import ir
from numba import types
from numba.extending import intrinsic
from numpy import int64, uint64

from gaspart.kernels.compile.policy import inner_helper, inner_kernel, kernel
from gaspart.kernels.event.boxes import member
from gaspart.kernels.event.simd import PLACES, list_box, load_row, load_rows
from gaspart.kernels.model import COLLISIONS
from gaspart.kernels.physics.collision import gap_along
from gaspart.kernels.physics.flight import acceleration_of, bin_at, row_of
from gaspart.kernels.physics.mass import mass_of
from gaspart.kernels.simd import WIDTH, Lanes, fields


class Impulses(NamedTuple):
    """Tally of impulses along an axis by position."""

    sums: np.ndarray
    axis: int
    per_length: float
    row: np.ndarray | None


@inner_helper
def add_at(sums, row, position, impulse):
    """Add an impulse at a position in units of bins."""
    bin_, part = bin_at(position, sums.shape[1] - 1)
    upper = impulse * part
    sums[row, bin_] += impulse - upper
    sums[row, bin_ + 1] += upper


@inner_helper
def speed_before(flights, i, impulses):
    """Return the velocity of a particle along the axis before an impulse; 0 without a tally."""
    if impulses is not None:
        return flights[i].velocity[impulses.axis]
    return 0.0


@inner_helper
def speed_on_arrival(flights, i, time, model, gravity, impulses):
    """Return the velocity along the axis at a later time, also of a particle behind it; 0 without a tally."""
    if impulses is not None:
        axis = impulses.axis
        if gravity is None:
            return flights[i].velocity[axis]
        pull = acceleration_of(flights, i, axis, model.space, gravity)
        return flights[i].velocity[axis] + pull * (time - flights[i].clock)
    return 0.0


@inner_helper
def tally_impulse(flights, i, before, model, impulses):
    """Add the impulse that changed the velocity of a particle from `before`."""
    if impulses is not None:
        change = flights[i].velocity[impulses.axis] - before
        if change != 0.0:  # the velocity of a particle of infinite mass does not change
            position = flights[i].position[impulses.axis] * impulses.per_length
            impulse = mass_of(i, model.masses, model.law) * change
            add_at(impulses.sums, row_of(i, impulses.row), position, impulse)


@kernel
def add_momenta(flights, sign, model, impulses):
    """Add `sign` times the present momentum of each particle at its position."""
    for i in range(len(flights)):
        velocity = flights[i].velocity[impulses.axis]
        if velocity != 0.0:
            position = flights[i].position[impulses.axis] * impulses.per_length
            momentum = sign * mass_of(i, model.masses, model.law) * velocity
            add_at(impulses.sums, row_of(i, impulses.row), position, momentum)


# Eight pairs at once: their distances, and projections of a vector on their separations, with vector
# instructions.


_DOUBLE, _WORD = ir.DoubleType(), ir.IntType(64)


def nearest(gap: Lanes, length: ir.Value) -> Lanes:
    """Return coordinate differences for the nearest image along a periodic axis, as in `physics.periodic`."""
    side = gap.all(length)
    lower = (gap + side).where(gap + gap < gap.all(0.0) - side, gap)
    return (gap - side).where(gap + gap > side, lower)


@intrinsic
def separate(typingctx, flights, i, first, listed, vector, space, separations):
    """Compute distances and projections for particle i and eight listed particles. The eight particles are
    listed from index `first`, and particle i is at the time of its clock. separations[0] becomes the distance
    r, by the nearest image in a periodic space. separations[1] becomes r.v / |r|^d, with a vector v (d,) and
    r pointing from the other particle to i; it is NaN at a distance of 0.
    """

    def generate(context, builder, signature, arguments):
        flights, i, first, listed, vector, space, separations = arguments
        lengths = fields(builder, signature.args[5], space)["lengths"]

        def data(n, array):
            return context.make_array(signature.args[n])(context, builder, array).data

        rows = builder.bitcast(data(0, flights), _DOUBLE.as_pointer())
        near, vector, separations = data(3, listed), data(4, vector), data(6, separations)
        indices = []
        for n in range(WIDTH):
            number = builder.load(builder.gep(near, [builder.add(first, _WORD(n))]))
            indices.append(builder.zext(number, _WORD))
        own, other, d = load_row(builder, rows, i), load_rows(builder, rows, indices), len(lengths)
        late = own[2 * d] - other[2 * d]
        products = []
        for k, length in enumerate(lengths):
            gap = nearest(own[k] - (other[k] + other[d + k] * late), length)
            products.append((gap * gap, gap * builder.load(builder.gep(vector, [_WORD(k)]))))
        square, product = (reduce(Lanes.__add__, terms) for terms in zip(*products, strict=True))
        distance = square.sqrt()
        for n, lanes in enumerate((distance, product / (square * distance if d == 3 else square))):
            address = builder.gep(separations, [_WORD(n * WIDTH)])
            builder.store(lanes.value, builder.bitcast(address, lanes.value.type.as_pointer()), align=8)
        return context.get_dummy_value()

    index = types.uint64
    return types.none(flights, index, index, listed, vector, space, separations), generate


# Impulses, tallied by the distance of a pair of particles; they make the radial distribution function more
# accurate.
#
# An impulse dp on a particle, at a separation r from another particle, changes the relative momentum (p - p')
# / 2 of the pair. It contributes dp.r / (2 r^d) to all distances above r (docs/estimators.md). A collision
# contributes for the colliding pair, and for each of its particles with all other particles. The contribution
# is averaged over each shell. Let f be the fraction of the volume of the pair's own shell that is below r.
# This shell gets the fraction 1 - f, and all higher shells get the whole contribution. So 1 - f is added to
# the shell and f to the next one; the mean over a shell is then the sum of all entries up to the shell.
#
# The order in which the other pairs are found depends on the search, so integers are summed.


MEETING, OTHERS = range(2)
_SLACK = 1.0 + 1e-9  # extension of the search, so that rounding does not hide a pair


class PairImpulses(NamedTuple):
    """Tally of impulses by the distance of a pair."""

    sums: np.ndarray
    impulse: np.ndarray
    furthest: float
    per_length: float
    per_volume: np.ndarray
    per_unit: float
    share: float
    listed: np.ndarray
    separations: np.ndarray


@inner_helper
def note_velocity(flights, i, pairs):
    """Store the velocity of a particle that is about to collide."""
    if pairs is not None:
        for k in range(len(pairs.impulse)):
            pairs.impulse[k] = flights[i].velocity[k]


@inner_helper
def tally_pairs(particles, i, j, queue, boxes, model, tally, pairs):
    """Add the contribution of a collision of particles i and j to the pairs. The velocity of i before the
    collision was stored by `note_velocity`.
    """
    if pairs is not None:
        mass = mass_of(i, model.masses, model.law)
        _add_contact(particles.flights, i, j, mass, model.space, pairs)
        number = tally.counts[COLLISIONS]
        if floor(number * pairs.share) > floor((number - 1) * pairs.share):
            _add_others(particles.flights, i, j, 0.5, queue, boxes, model.space, pairs)
            _add_others(particles.flights, j, i, -0.5, queue, boxes, model.space, pairs)


@inner_helper
def _add_at(row, distance, product, pairs):
    """Add dp.r / r^d = `product` for a pair at a distance."""
    position = distance * pairs.per_length
    shell = uint64(position)
    low = float(shell)
    if len(pairs.impulse) == 3:
        part = (position * position * position - low * low * low) * pairs.per_volume[shell]
    else:
        part = (position * position - low * low) * pairs.per_volume[shell]
    total = product * pairs.per_unit
    upper = int64(np.rint(total * part))
    pairs.sums[row, shell] += int64(np.rint(total)) - upper
    pairs.sums[row, shell + uint64(1)] += upper


@inner_helper
def _add_contact(flights, i, j, mass, space, pairs):
    """Compute the impulse from the stored velocity, and add the contribution of the colliding pair."""
    square = product = 0.0
    for k in range(len(space.lengths)):
        pairs.impulse[k] = mass * (flights[i].velocity[k] - pairs.impulse[k])
        gap = gap_along(flights, j, i, k, space)
        square += gap * gap
        product += gap * pairs.impulse[k]
    distance = sqrt(square)
    if distance < pairs.furthest:
        power = square if len(space.lengths) == 2 else square * distance
        _add_at(MEETING, distance, product / power, pairs)


@inner_helper
def _add_listed(flights, i, j, count, factor, space, pairs):
    """Add `factor` times the contribution of the impulse for pairs of i with listed particles. Particle i
    itself and its collision partner j are excluded.
    """
    for n in range(uint64(WIDTH)):
        pairs.listed[count + n] = i
    for first in range(uint64(0), count, uint64(WIDTH)):
        separate(flights, i, first, pairs.listed, pairs.impulse, space, pairs.separations)
        for n in range(uint64(WIDTH)):
            distance = pairs.separations[0, n]
            if 0.0 < distance < pairs.furthest and pairs.listed[first + n] != j:
                _add_at(OTHERS, distance, factor * pairs.separations[1, n], pairs)


@inner_kernel
def _add_others(flights, i, j, factor, queue, boxes, space, pairs):
    """Add `factor` times the contribution of the impulse for pairs of i with all other particles."""
    i, j = uint64(i), uint64(j)
    if queue is None:
        count = uint64(len(flights))
        for other in range(count):
            pairs.listed[other] = other
    else:
        count = _list_near(flights, i, boxes, space, pairs, boxes.lists)
    _add_listed(flights, i, j, count, factor, space, pairs)


@inner_helper
def _grid(boxes, axis, lists):
    """Return the number of cells along an axis, and the inverse of their width."""
    if lists is None:
        return boxes.per_side[axis], 1.0 / boxes.widths[axis]
    return lists.per_side[axis], lists.per_length[axis]


@inner_helper
def _list_cell(cell, count, boxes, pairs, lists):
    """List the particles of a cell after the first `count`; return the new number."""
    other = uint64(0)
    if lists is None:
        filled = uint64(boxes.filled[cell])
        list_box(pairs.listed, count, boxes.members, cell, uint64(0))
        for n in range(uint64(PLACES), filled):
            other = uint64(member(boxes, cell, n, other))
            pairs.listed[count + n] = other
    else:
        filled = uint64(lists.filled[cell])
        page = cell * uint64(lists.per_cell)
        for n in range(filled):
            pairs.listed[count + n] = lists.pages[page + n // uint64(WIDTH)].members[n % uint64(WIDTH)]
    return count + filled


@inner_helper
def _reach(furthest, lists):
    """Return the largest distance of the cell of a particle within a given distance. A particle in a
    neighbour list has moved by at most a margin from its cell.
    """
    if lists is None:
        return furthest * _SLACK
    return furthest * _SLACK + lists.margin


@inner_helper
def _span(x, reach, count, per_length):
    """Return first and end of the cells along an axis within a distance of x, also beyond the container."""
    low, end = int64(floor((x - reach) * per_length)), int64(floor((x + reach) * per_length)) + 1
    if end - low >= count:
        return int64(0), int64(count)
    return low, end


@inner_helper
def _gap_square(x, cell, span, count, per_length):
    """Return the squared distance between x and a cell along an axis; 0 if all cells are within reach."""
    if span[1] - span[0] >= count:
        return 0.0
    gap = max(cell - x * per_length, x * per_length - (cell + 1), 0.0) / per_length
    return gap * gap


@inner_helper
def _wrap_cell(cell, count):
    """Wrap a cell number along a periodic axis into the container."""
    if cell < 0:
        return cell + count
    return cell - count if cell >= count else cell


@inner_helper
def _list_near(flights, i, boxes, space, pairs, lists):
    """List all particles in the cells within reach of particle i; return their number."""
    count = uint64(0)
    position, d = flights[i].position, len(space.lengths)
    x, y, z = position[0], position[1], position[2] if d == 3 else 0.0
    reach = _reach(pairs.furthest, lists)
    count_x, per_x = _grid(boxes, 0, lists)
    count_y, per_y = _grid(boxes, 1, lists)
    count_z, per_z = _grid(boxes, 2, lists)
    span_z = _span(z, reach, count_z, per_z)
    for cz in range(span_z[0], span_z[1]):
        left_z = reach * reach - _gap_square(z, cz, span_z, count_z, per_z)
        span_y = _span(y, sqrt(max(left_z, 0.0)), count_y, per_y)
        for cy in range(span_y[0], span_y[1]):
            remaining = left_z - _gap_square(y, cy, span_y, count_y, per_y)
            row = (_wrap_cell(cz, count_z) * count_y + _wrap_cell(cy, count_y)) * count_x
            low, end = _span(x, sqrt(max(remaining, 0.0)), count_x, per_x)
            for cx in range(low, end):
                cell = uint64(row + _wrap_cell(cx, count_x))
                count = _list_cell(cell, count, boxes, pairs, lists)
    return count
