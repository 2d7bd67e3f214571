"""Search of overlapping pairs with a neighbour list.

The list contains all pairs closer than the contact distance plus a `skin`. It is renewed if particles may
have crossed the skin. An entry of the list is one word: a slot, the first of eight other consecutive slots,
and a bit for each of these that is near. So making and searching the list loads eight particles at once.
Entries are always written, and entries without a set bit are removed later. Otherwise the position of an
entry would depend on the preceding entry and have to wait for it.
"""

from __future__ import annotations

from math import inf, prod

import numpy as np
from llvmlite import ir
from numba import types
from numba.core import cgutils
from numba.extending import intrinsic
from numpy.typing import DTypeLike

from gaspart.kernels.compile.policy import inner_allocating_kernel, inner_helper, inner_kernel
from gaspart.kernels.prefetch import fetch
from gaspart.kernels.simd import WIDTH, Lanes, fields, lowest
from gaspart.kernels.step.model import DISPLACEMENT, part_of
from gaspart.kernels.step.resolve import examine

# Eight slots at once: the particles near another particle, with vector instructions.
#
# Particles are stored in the order of their cells, so the candidates for neighbours of a particle occupy a
# few contiguous ranges of slots. Eight consecutive slots are loaded as a vector. The near ones are written
# one after another, without a branch. All arithmetic is the same as in `resolve`, so the bits are the same.
# Data loaded beyond the end of a range, or of an array (see `roomy`), are never used.


_BYTE, _WORD = ir.IntType(WIDTH), ir.IntType(64)
_MARKS, _WORDS = ir.VectorType(ir.IntType(1), WIDTH), ir.VectorType(_WORD, WIDTH)


def roomy(shape: tuple[int, ...], dtype: DTypeLike) -> np.ndarray:
    """Return an array of zeros that allows loading a vector beyond its end."""
    return np.zeros(prod(shape) + WIDTH, dtype)[: prod(shape)].reshape(shape)


def _call(builder: ir.IRBuilder, name: str, kind: ir.Type, *arguments: ir.Value) -> ir.Value:
    """Return the result of an LLVM instruction, by its name. `kind`: type of the result."""
    function = ir.FunctionType(kind, [argument.type for argument in arguments])
    return builder.call(cgutils.get_or_insert_function(builder.module, function, name), arguments)


def _size(lanes: Lanes) -> Lanes:
    bits = 64 if isinstance(lanes.value.type.element, ir.DoubleType) else 32
    return Lanes(
        lanes.builder, _call(lanes.builder, f"llvm.fabs.v{WIDTH}f{bits}", lanes.value.type, lanes.value)
    )


@intrinsic
def nearer(typingctx, positions, radii, space, slot, skin, first):
    """Return a bit for each of the eight slots starting at `first`. The lowest bit belongs to the first slot.
    A bit is set if the distance between the particle of its slot and the particle in `slot` is below the
    contact distance plus the skin. `resolve.distance_squared` computes the same distance.
    """

    def generate(context, builder, signature, arguments):
        positions, radii, space, slot, skin, first = arguments
        array = context.make_array(signature.args[0])(context, builder, positions)
        count = builder.extract_value(array.shape, 1)
        radii = context.make_array(signature.args[1])(context, builder, radii).data
        space = fields(builder, signature.args[2], space)
        real = context.get_value_type(signature.args[0].dtype)
        vector = ir.VectorType(real, WIDTH)

        def load_lanes(data, start):
            eight = builder.bitcast(builder.gep(data, [builder.add(start, first)]), vector.as_pointer())
            eight = Lanes(builder, builder.load(eight, align=real.get_abi_size(context.target_data)))
            return eight, eight.all(builder.load(builder.gep(data, [builder.add(start, slot)])))

        square = None
        for k, (length, periodic) in enumerate(zip(space["lengths"], space["periodic"], strict=True)):
            others, own = load_lanes(array.data, builder.mul(count, _WORD(k)))
            length = builder.select(builder.trunc(periodic, ir.IntType(1)), length, ir.Constant(real, inf))
            gap = _size(others - own)
            across = _size(gap.all(length) - gap)
            gap = gap.where(gap < across, across)
            square = gap * gap if square is None else square + gap * gap
        others, own = load_lanes(radii, _WORD(0))
        reach = own + others + skin
        near = builder.bitcast((square < reach * reach).value, _BYTE)
        return builder.zext(near, _WORD)

    index = types.uint64
    return index(positions, radii, space, index, positions.dtype, index), generate


@intrinsic
def equals(typingctx, values, first, value):
    """Return a bit, lowest for `first`, for each of eight elements that equals a value."""

    def generate(context, builder, signature, arguments):
        values, first, value = arguments
        data = context.make_array(signature.args[0])(context, builder, values).data
        vector = ir.VectorType(value.type, WIDTH)
        eight = builder.bitcast(builder.gep(data, [first]), vector.as_pointer())
        eight = Lanes(builder, builder.load(eight, align=value.type.width // 8))
        same = builder.icmp_unsigned("==", eight.value, eight.all(value).value)
        return builder.zext(builder.bitcast(same, _BYTE), _WORD)

    index = types.uint64
    return index(values, index, values.dtype), generate


@intrinsic
def compact_eight(typingctx, words, first, least, kept, number):
    """Write the words of eight from `first` that are at least `least` into `kept` from `number`; return their
    number.
    """

    def generate(context, builder, signature, arguments):
        words, first, least, kept, number = arguments
        words = context.make_array(signature.args[0])(context, builder, words).data
        kept = context.make_array(signature.args[3])(context, builder, kept).data
        eight = builder.bitcast(builder.gep(words, [first]), _WORDS.as_pointer())
        eight = Lanes(builder, builder.load(eight, align=8))
        which = builder.icmp_unsigned(">=", eight.value, eight.all(least).value)
        name, unused = f"llvm.experimental.vector.compress.v{WIDTH}i64", ir.Constant(_WORDS, ir.Undefined)
        packed = _call(builder, name, _WORDS, eight.value, which, unused)
        builder.store(packed, builder.bitcast(builder.gep(kept, [number]), _WORDS.as_pointer()), align=8)
        which = builder.zext(builder.bitcast(which, _BYTE), _WORD)
        return _call(builder, "llvm.ctpop.i64", _WORD, which)

    index = types.uint64
    return index(words, index, index, kept, index), generate


@intrinsic
def bits(typingctx, value):
    """Return the number of set bits in a word."""

    def generate(context, builder, signature, arguments):
        return _call(builder, "llvm.ctpop.i64", _WORD, arguments[0])

    return types.uint64(types.uint64), generate


_SAFE = 0.99  # usable fraction of the skin, because of rounding
_ROOM = np.uint64(1024)  # number of entries that are written before entries without a set bit are removed
_BLOCK = 64  # number of slots whose neighbours in one row are searched before the next row
ONE, _TWO, _EIGHT = np.uint64(1), np.uint64(2), np.uint64(WIDTH)
_PLACE, _SHIFT = np.uint64(28), np.uint64(56)  # first bits of the slot and of the near bits in an entry
_SLOTS = (ONE << _PLACE) - ONE


@inner_kernel
def compact(entries, number, pairs, listed):
    """Write the entries with a set bit into pairs (room,), as long as there is space. `number`: number of
    entries. `listed`: number of entries in `pairs` so far; the new number is returned.
    """
    most = np.uint64(len(pairs)) - _EIGHT
    for n in range(WIDTH):
        entries[number + np.uint64(n)] = 0
    for n in range(np.uint64(0), number, _EIGHT):
        listed += compact_eight(entries, n, ONE << _SHIFT, pairs, min(listed, most))
    return listed


@inner_helper
def record_near(particles, slot, others, cells, space, entries, pairs, filled):
    """Record the slots from others[0] to others[1] that are near a slot, eight per entry. A slot is near if
    its distance is below the contact distance plus the skin. `filled`: numbers of entries, and of entries in
    the list; the new numbers are returned.
    """
    number, listed = filled
    first, last = np.uint64(others[0]), np.uint64(others[1])
    while True:
        marks = nearer(particles.positions, particles.radii, space, slot, cells.skin, first)
        marks &= (ONE << min(last - first, _EIGHT)) - ONE
        entries[number] = (marks << _SHIFT) | (slot << _PLACE) | first
        number += ONE
        if number == _ROOM:
            listed = compact(entries, number, pairs, listed)
            number = np.uint64(0)
        first += _EIGHT
        if first >= last:
            return number, listed


@inner_helper
def rows_ahead(dimension):
    """Return the number of rows of cells, its own first, with which the particles of a row are paired."""
    return 5 if dimension == 3 else 2


@inner_helper
def ahead(cells, n):
    """Return the index of a cell in row n of `rows_ahead`, relative to the cell."""
    if n < 2:
        return cells.strides[1] * n
    return cells.strides[2] + cells.strides[1] * (n - 3)


@inner_helper
def find_stretches(slots, n, cells, stretches):
    """Find the ranges of slots that may contain neighbours in row n, for slots[0] to slots[1]. The ranges
    cover the cells in the same column and in the adjacent columns. Nonempty ranges are written into stretches
    (2, m), as entries without set bits and as the end of the slots. Returns the number of ranges, and the
    number of candidates. (Testing an empty range takes as long as eight slots, and processors cannot predict
    which ranges are empty.)
    """
    ends = cells.ends
    on = np.uint64(ahead(cells, n))
    number = partners = np.uint64(0)
    for slot in range(np.uint64(slots[0]), np.uint64(slots[1])):
        at = np.uint64(cells.cell[slot]) + on
        first, last = slot + ONE if n == 0 else np.uint64(ends[at - _TWO]), np.uint64(ends[at + ONE])
        stretches[0, number] = (slot << _PLACE) | first
        stretches[1, number] = last
        number += np.uint64(last > first)
        partners += last - first
    return number, partners


@inner_helper
def record_stretches(particles, stretches, stop, cells, space, entries, pairs, filled):
    """Perform `record_near` for slots and candidates in stretches[:, :stop]; return the numbers."""
    for k in range(stop):
        slot, others = stretches[0, k] >> _PLACE, (stretches[0, k] & _SLOTS, stretches[1, k])
        filled = record_near(particles, slot, others, cells, space, entries, pairs, filled)
    return filled


@inner_helper
def record_across(particles, at, across, cells, space, entries, pairs, filled):
    """Perform `record_near` for a cell and the cells at the opposite side of the container. The slots are in
    cell `at`. The candidates are in cell `across` and in the same column of the following rows. Returns the
    new numbers of entries, and the number of tests.
    """
    ends = cells.ends
    tests = np.uint64(0)
    for slot in range(np.uint64(ends[at - 1]), np.uint64(ends[at])):
        for n in range(0 if across > at else 1, rows_ahead(len(space.lengths))):
            other = across + ahead(cells, n)
            others = np.uint64(ends[other - 1]), np.uint64(ends[other])
            tests += others[1] - others[0]
            filled = record_near(particles, slot, others, cells, space, entries, pairs, filled)
    return filled, tests


@inner_allocating_kernel
def list_part(particles, part, cells, pairs, space, tests):
    """List all pairs closer than the contact distance plus the skin that one thread must find. The entries
    are written into pairs[part] (room,), their number into cells.listed, and the number of tests into tests
    (threads,). If the space is insufficient, the last entries are missing.
    """
    parts, rows, mine = len(pairs), rows_ahead(len(space.lengths)), pairs[part]
    start, stop = part_of(part, parts, particles.ordinary)
    entries = np.empty(_ROOM + _EIGHT, np.uint64)
    stretches = np.empty((2, _BLOCK), np.uint64)
    total = np.uint64(0)
    filled = np.uint64(0), np.uint64(0)
    for low in range(start, stop, _BLOCK):
        slots = low, min(low + _BLOCK, stop)
        for n in range(rows):
            number, tested = find_stretches(slots, n, cells, stretches)
            filled = record_stretches(particles, stretches, number, cells, space, entries, mine, filled)
            total += tested
    if cells.wraps[0]:
        lines = cells.per_side[1] * cells.per_side[2]
        start, stop = part_of(part, parts, lines)
        for line in range(start, stop):
            plane = line // cells.per_side[1]
            first = 2 + (line - plane * cells.per_side[1] + 1) * cells.strides[1]
            if rows == 5:
                first += (plane + 1) * cells.strides[2]
            last = first + cells.per_side[0] - 1
            for at, across in ((first, last), (last, first)):
                filled, tested = record_across(particles, at, across, cells, space, entries, mine, filled)
                total += tested
    cells.listed[part] = compact(entries, filled[0], mine, filled[1])
    tests[part] = total


@inner_kernel
def is_complete(particles, cells):
    """Return True if no pair can have approached by more than the skin since the list was made."""
    return 2.0 * particles.bounds[DISPLACEMENT] < _SAFE * cells.skin


@inner_kernel
def search_pairs(particles, entries, space, step, overlaps, thread):
    """Record the pairs of some entries (n,) that must be resolved. With a pass `step.before`, only pairs are
    searched that contain a particle with a contact in that pass, because all other particles have not changed
    since the last search.
    """
    touching, before, last_pass = overlaps.touching[thread], step.before, particles.last_pass
    # The number is written to `overlaps` only at the end, because threads that write to one cache line wait
    # for each other.
    tests = np.uint64(0)
    for low in range(0, len(entries), len(touching)):
        number = np.uint64(0)
        for entry in entries[low : low + len(touching)]:
            slot, first, marks = (entry >> _PLACE) & _SLOTS, entry & _SLOTS, entry >> _SHIFT
            if before != 0 and last_pass[slot] != before:
                marks &= equals(last_pass, first, np.uint32(before))
                if marks == 0:
                    continue
            tests += bits(marks)
            marks &= nearer(particles.positions, particles.radii, space, slot, step.dt - step.dt, first)
            if marks != 0:
                touching[number] = (marks << _SHIFT) | (entry & ~(~np.uint64(0) << _SHIFT))
                number += ONE
        for entry in touching[:number]:
            slot, other = (entry >> _PLACE) & _SLOTS, entry & _SLOTS
            for k in range(len(space.lengths)):
                fetch(particles.velocities[k], slot)
                fetch(particles.velocities[k], other)
            fetch(particles.index, slot)
            fetch(particles.index, other)
        for entry in touching[:number]:
            slot, first, marks = (entry >> _PLACE) & _SLOTS, entry & _SLOTS, entry >> _SHIFT
            while marks != 0:
                examine(particles, slot, first + lowest(marks), space, step, overlaps, thread)
                marks &= marks - ONE
    overlaps.tests[thread] += np.int64(tests)
