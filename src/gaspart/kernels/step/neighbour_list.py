"""Overlapping pairs by a neighbour list: all pairs nearer than a contact and a `skin`, made anew when
particles may have crossed the skin.

An entry of the list is one word: a slot, the first of eight others in a row, and a mark for each of these
that is near. So it is made, and searched, by loading eight particles at once. Entries are written in any
case, and only then are those without a mark left out: a place that depends on the entry before would have to
wait for it.
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

# Eight slots at once: which particles lie near another, in vector instructions.
#
# Particles are in memory in the order of their cells, so those that may be near one fill a few unbroken
# stretches of slots. Eight of these are eight numbers in a row, of which a vector is loaded at once; and
# those that count are written one after another, without a branch. All arithmetic is that of `resolve`, to
# the same bits. What is loaded beyond the end of a stretch, or of an array (see `roomy`), is never used.


_BYTE, _WORD = ir.IntType(WIDTH), ir.IntType(64)
_MARKS, _WORDS = ir.VectorType(ir.IntType(1), WIDTH), ir.VectorType(_WORD, WIDTH)


def roomy(shape: tuple[int, ...], dtype: DTypeLike) -> np.ndarray:
    """An array of zeros behind whose end a vector can be loaded."""
    return np.zeros(prod(shape) + WIDTH, dtype)[: prod(shape)].reshape(shape)


def _call(builder: ir.IRBuilder, name: str, kind: ir.Type, *arguments: ir.Value) -> ir.Value:
    """What an instruction that LLVM has a name for makes of values, of the type of the first."""
    function = ir.FunctionType(kind, [argument.type for argument in arguments])
    return builder.call(cgutils.get_or_insert_function(builder.module, function, name), arguments)


def _size(lanes: Lanes) -> Lanes:
    bits = 64 if isinstance(lanes.value.type.element, ir.DoubleType) else 32
    return Lanes(
        lanes.builder, _call(lanes.builder, f"llvm.fabs.v{WIDTH}f{bits}", lanes.value.type, lanes.value)
    )


@intrinsic
def nearer(typingctx, positions, radii, space, slot, skin, first):
    """A bit for each of the eight slots from `first` on, lowest first: whether its particle is nearer to that
    in `slot` than a contact and the skin. See `resolve.distance_squared`."""

    def generate(context, builder, signature, arguments):
        positions, radii, space, slot, skin, first = arguments
        array = context.make_array(signature.args[0])(context, builder, positions)
        count = builder.extract_value(array.shape, 1)
        radii = context.make_array(signature.args[1])(context, builder, radii).data
        space = fields(builder, signature.args[2], space)
        real = context.get_value_type(signature.args[0].dtype)
        vector = ir.VectorType(real, WIDTH)

        def loaded(data, start):
            eight = builder.bitcast(builder.gep(data, [builder.add(start, first)]), vector.as_pointer())
            eight = Lanes(builder, builder.load(eight, align=real.get_abi_size(context.target_data)))
            return eight, eight.all(builder.load(builder.gep(data, [builder.add(start, slot)])))

        square = None
        for k, (length, periodic) in enumerate(zip(space["lengths"], space["periodic"], strict=True)):
            others, one = loaded(array.data, builder.mul(count, _WORD(k)))
            length = builder.select(builder.trunc(periodic, ir.IntType(1)), length, ir.Constant(real, inf))
            gap = _size(others - one)
            across = _size(gap.all(length) - gap)
            gap = gap.where(gap < across, across)
            square = gap * gap if square is None else square + gap * gap
        others, one = loaded(radii, _WORD(0))
        reach = one + others + skin
        near = builder.bitcast((square < reach * reach).value, _BYTE)
        return builder.zext(near, _WORD)

    word = types.uint64
    return word(positions, radii, space, word, positions.dtype, word), generate


@intrinsic
def equals(typingctx, values, first, value):
    """A bit for each of the eight places from `first` on, lowest first: whether a value is there."""

    def generate(context, builder, signature, arguments):
        values, first, value = arguments
        data = context.make_array(signature.args[0])(context, builder, values).data
        vector = ir.VectorType(value.type, WIDTH)
        eight = builder.bitcast(builder.gep(data, [first]), vector.as_pointer())
        eight = Lanes(builder, builder.load(eight, align=value.type.width // 8))
        same = builder.icmp_unsigned("==", eight.value, eight.all(value).value)
        return builder.zext(builder.bitcast(same, _BYTE), _WORD)

    word = types.uint64
    return word(values, word, values.dtype), generate


@intrinsic
def compact_eight(typingctx, words, first, least, kept, number):
    """Write those of eight words, from place `first` on, that are not less than `least` into `kept`, from
    place `number` on; how many these are. There must be room for eight."""

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

    word = types.uint64
    return word(words, word, word, kept, word), generate


@intrinsic
def bits(typingctx, word):
    """How many bits of a word are set."""

    def generate(context, builder, signature, arguments):
        return _call(builder, "llvm.ctpop.i64", _WORD, arguments[0])

    return types.uint64(types.uint64), generate


_SAFE = 0.99  # of the skin, so that rounding uses none of it
_ROOM = np.uint64(1024)  # entries written before those without a mark are left out
_BLOCK = 64  # slots whose partners in one row are looked for before those in the next
ONE, _TWO, _EIGHT = np.uint64(1), np.uint64(2), np.uint64(WIDTH)
_PLACE, _SHIFT = np.uint64(28), np.uint64(56)  # of an entry: where its slot begins, and its marks
_SLOTS = (ONE << _PLACE) - ONE


@inner_kernel
def compact(entries, number, pairs, listed):
    """Write those of the first entries that have a mark into pairs (room,), behind those `listed` before, as
    long as there is room; how many there are then."""
    most = np.uint64(len(pairs)) - _EIGHT
    for n in range(WIDTH):
        entries[number + np.uint64(n)] = 0
    for n in range(np.uint64(0), number, _EIGHT):
        listed += compact_eight(entries, n, ONE << _SHIFT, pairs, min(listed, most))
    return listed


@inner_helper
def record_near(particles, slot, others, cells, space, entries, pairs, filled):
    """Record which of the slots from others[0] to others[1] are nearer to one than a contact and the skin,
    eight an entry. filled: the numbers of entries, and of those in the list; these numbers then."""
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
    """How many rows of cells hold partners of a particle that its row is to be listed with: its own, and
    those that come next to it along the other axes."""
    return 5 if dimension == 3 else 2


@inner_helper
def ahead(cells, n):
    """By how much the index of a cell in row n of these is higher."""
    if n < 2:
        return cells.strides[1] * n
    return cells.strides[2] + cells.strides[1] * (n - 3)


@inner_helper
def find_stretches(slots, n, cells, stretches):
    """Find the partners in row n of the slots from slots[0] to slots[1]: stretches of slots, those in the
    same column and in the columns beside it. Those that are not empty are written into stretches (2, m), as
    entries without marks and as the slots behind; how many these are, and how many partners. (To test an
    empty stretch takes as long as eight slots, and no branch can foresee which are empty.)"""
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
    """`record_near` of the slots and their partners in stretches[:, :stop]; the numbers of entries then."""
    for k in range(stop):
        slot, others = stretches[0, k] >> _PLACE, (stretches[0, k] & _SLOTS, stretches[1, k])
        filled = record_near(particles, slot, others, cells, space, entries, pairs, filled)
    return filled


@inner_helper
def record_across(particles, at, across, cells, space, entries, pairs, filled):
    """`record_near` of the slots in cell `at` with those in the cell `across` the container and in the same
    column of the rows ahead; the numbers of entries then, and of tests."""
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
    """Write all pairs of slots nearer than a contact and the skin that one thread is to find, as entries into
    pairs[part] (room,), and how many these are into cells.listed (if there is no room for all, the last are
    missing); the number of tests into tests (threads,)."""
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
            left = 2 + (line - plane * cells.per_side[1] + 1) * cells.strides[1]
            if rows == 5:
                left += (plane + 1) * cells.strides[2]
            right = left + cells.per_side[0] - 1
            for at, across in ((left, right), (right, left)):
                filled, tested = record_across(particles, at, across, cells, space, entries, mine, filled)
                total += tested
    cells.listed[part] = compact(entries, filled[0], mine, filled[1])
    tests[part] = total


@inner_kernel
def is_complete(particles, cells):
    """Whether no two particles may have come nearer by more than the skin since the list was made."""
    return 2.0 * particles.bounds[DISPLACEMENT] < _SAFE * cells.skin


@inner_kernel
def search_pairs(particles, entries, space, step, found, thread):
    """Record the pairs, among those of some entries (n,), that are to be resolved; with a pass `step.before`,
    only those of which one particle at least had a contact in that pass: for all others nothing has changed
    since they were searched."""
    touching, before, last_pass = found.touching[thread], step.before, particles.last_pass
    tests = np.uint64(0)  # into `found` at the end: threads that write to one cache line wait for each other
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
                examine(particles, slot, first + lowest(marks), space, step, found, thread)
                marks &= marks - ONE
    found.tests[thread] += np.int64(tests)
