"""Eight slots at once: which particles lie near another, in vector instructions.

Particles are in memory in the order of their cells, so those that may be near one fill a few unbroken
stretches of slots. Eight of these are eight numbers in a row, of which a vector is loaded at once; and those
that count are written one after another, without a branch. All arithmetic is that of `resolve`, to the same
bits. What is loaded beyond the end of a stretch, or of an array (see `roomy`), is never used.
"""

from __future__ import annotations

from math import inf, prod

import numpy as np
from llvmlite import ir
from numba import types
from numba.core import cgutils
from numba.extending import intrinsic
from numpy.typing import DTypeLike

from gaspart.kernels.simd import WIDTH, Lanes, fields

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
