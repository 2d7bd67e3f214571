"""Eight pairs at once: how far apart they are, and how much of a vector lies along that, in vector
instructions."""

from __future__ import annotations

from functools import reduce

from llvmlite import ir
from numba import types
from numba.extending import intrinsic

from gaspart.kernels.event.simd import load_row, load_rows
from gaspart.kernels.simd import WIDTH, Lanes, fields

_DOUBLE, _WORD = ir.DoubleType(), ir.IntType(64)


def nearest(gap: Lanes, length: ir.Value) -> Lanes:
    """Differences along a periodic axis by the nearest image, as in `physics.periodic`."""
    side = gap.all(length)
    lower = (gap + side).where(gap + gap < gap.all(0.0) - side, gap)
    return (gap - side).where(gap + gap > side, lower)


@intrinsic
def separate(typingctx, flights, i, first, listed, vector, space, found):
    """Of particle i, at the time of its clock, and each of the eight that are listed from number `first` on:
    found[0] the distance r, by the nearest image in a periodic space, and found[1] r.v / |r|^d with a vector
    v (d,) and r from the other to i; NaN at a distance of 0."""

    def generate(context, builder, signature, arguments):
        flights, i, first, listed, vector, space, found = arguments
        lengths = fields(builder, signature.args[5], space)["lengths"]

        def data(n, array):
            return context.make_array(signature.args[n])(context, builder, array).data

        rows = builder.bitcast(data(0, flights), _DOUBLE.as_pointer())
        near, vector, found = data(3, listed), data(4, vector), data(6, found)
        indices = []
        for n in range(WIDTH):
            number = builder.load(builder.gep(near, [builder.add(first, _WORD(n))]))
            indices.append(builder.zext(number, _WORD))
        one, other, d = load_row(builder, rows, i), load_rows(builder, rows, indices), len(lengths)
        late = one[2 * d] - other[2 * d]
        products = []
        for k, length in enumerate(lengths):
            gap = nearest(one[k] - (other[k] + other[d + k] * late), length)
            products.append((gap * gap, gap * builder.load(builder.gep(vector, [_WORD(k)]))))
        square, product = (reduce(Lanes.__add__, terms) for terms in zip(*products, strict=True))
        distance = square.sqrt()
        for n, lanes in enumerate((distance, product / (square * distance if d == 3 else square))):
            place = builder.gep(found, [_WORD(n * WIDTH)])
            builder.store(lanes.value, builder.bitcast(place, lanes.value.type.as_pointer()), align=8)
        return context.get_dummy_value()

    word = types.uint64
    return types.none(flights, word, word, listed, vector, space, found), generate
