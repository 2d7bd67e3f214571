"""Eight pairs at once: contact times with vector instructions.

Compilers do not find this vectorization. Eight rows, each a vector of eight numbers of one particle, are
transposed into vectors of one number of eight particles. The times are computed from these, with the same
arithmetic and order as in `flight.time_of_contact`, so the bits are the same.
"""

from __future__ import annotations

from functools import reduce
from math import inf

from llvmlite import ir
from numba import types
from numba.core import cgutils
from numba.extending import intrinsic

from gaspart.kernels.model import IMAGE_BITS, NUMBER_BITS
from gaspart.kernels.physics.contact import TINY
from gaspart.kernels.simd import WIDTH, Lanes, fields, mask_of

PLACES = 4  # number of particles of a box that are listed at once
ROW = 8  # numbers of a particle: position, velocity, clock, radius
_DOUBLE, _INT, _WORD = ir.DoubleType(), ir.IntType(32), ir.IntType(64)
_STAGES = (  # stages of a transposition: pairs of rows, shuffled within quarters, or by quarters
    (1, [0, 8, 2, 10, 4, 12, 6, 14], [1, 9, 3, 11, 5, 13, 7, 15]),
    (2, [0, 1, 4, 5, 8, 9, 12, 13], [2, 3, 6, 7, 10, 11, 14, 15]),
    (4, [0, 1, 4, 5, 8, 9, 12, 13], [2, 3, 6, 7, 10, 11, 14, 15]),
)
_STEPS = [step for step, *_ in reversed(_STAGES) if step < WIDTH]


def load_rows(builder: ir.IRBuilder, data: ir.Value, indices: list[ir.Value]) -> list[Lanes]:
    """Load the rows of WIDTH particles as columns."""
    vector = ir.VectorType(_DOUBLE, ROW)
    rows = []
    for index in indices:
        address = builder.gep(data, [builder.mul(index, _WORD(ROW))])
        rows.append(builder.load(builder.bitcast(address, vector.as_pointer()), align=8))
    for step, *halves in _STAGES[: len(_STEPS)]:
        swapped = list(rows)
        for n in range(WIDTH):
            if not n & step:
                for row, mask in zip((n, n + step), halves, strict=True):
                    which = ir.Constant(ir.VectorType(_INT, ROW), mask)
                    swapped[row] = builder.shuffle_vector(rows[n], rows[n + step], which)
        rows = swapped
    if WIDTH < ROW:
        parts = [[k - k % WIDTH + n for n in range(WIDTH)] for k in range(ROW)]
        masks = [ir.Constant(ir.VectorType(_INT, WIDTH), part) for part in parts]
        rows = [
            builder.shuffle_vector(rows[k % WIDTH], rows[k % WIDTH], mask) for k, mask in enumerate(masks)
        ]
    return [Lanes(builder, row) for row in rows]


def load_row(builder: ir.IRBuilder, data: ir.Value, index: ir.Value) -> list[Lanes]:
    """Load the row of one particle into every lane."""
    start = builder.mul(index, _WORD(ROW))
    values = (builder.load(builder.gep(data, [builder.add(start, _WORD(k))])) for k in range(ROW))
    return [Lanes(builder, value).all(value) for value in values]


def advance_flight(x: Lanes, v: Lanes, pull: Lanes | None, late: Lanes) -> tuple[Lanes, Lanes]:
    """Return a coordinate and its velocity after some time, as in `flight.encounter`."""
    if not pull:
        return x + v * late, v
    return x + (v + pull * 0.5 * late) * late, v + pull * late


def bring_to_start(particle: list[Lanes], clocks: Lanes, pull: list) -> tuple[Lanes, list[tuple]]:
    """Return the later clock of a particle and each of eight others, and its flight then. The flight consists
    of coordinates and velocities, under an acceleration `pull` (d,). If no other clock is later than its own,
    these values are already known; this is the case just after its event.
    """
    builder, d = clocks.builder, len(pull)
    clock = particle[2 * d]
    later = clocks > clock
    entry_block = builder.basic_block
    own = [clock, *(part for k in range(d) for part in (particle[k], particle[d + k]))]
    with builder.if_then(builder.icmp_unsigned("!=", mask_of(later), ir.IntType(WIDTH)(0)), likely=False):
        start = clocks.where(later, clock)
        then = [advance_flight(particle[k], particle[d + k], pull[k], start - clock) for k in range(d)]
        moved, computed = [start, *(part for pair in then for part in pair)], builder.basic_block
    joined = []
    for part, moved_part in zip(own, moved, strict=True):
        phi = builder.phi(part.value.type)
        phi.add_incoming(part.value, entry_block)
        phi.add_incoming(moved_part.value, computed)
        joined.append(Lanes(builder, phi))
    return joined[0], list(zip(joined[1::2], joined[2::2], strict=True))


def contact_times(
    particle: list[Lanes], other: list[Lanes], images: list, lengths: list, pull: list
) -> Lanes:
    """Return the contact times of one particle and eight others in images (d,) of a container. This is
    `flight.time_of_contact` for columns of rows. All particles fall with the same acceleration `pull` (d,),
    or do not fall without it. `lengths`: (d,), side lengths of the container.
    """
    d = len(lengths)
    pull = [particle[0].all(component) for component in pull] or [None] * d
    start, flights = bring_to_start(particle, other[2 * d], pull)
    late = start - other[2 * d]
    relative = []
    for k, (x, v) in enumerate(flights):
        x_other, v_other = advance_flight(other[k], other[d + k], pull[k], late)
        relative.append(((x_other - x).plus_product(images[k], start.all(lengths[k])), v_other - v))
    products = [(r * r, r * v, v * v) for r, v in relative]
    rr, rv, vv = (reduce(Lanes.__add__, terms) for terms in zip(*products, strict=True))
    sigma = particle[2 * d + 1] + other[2 * d + 1]
    ss = sigma * sigma
    c = rr - ss
    meets = (rv < 0.0) & (rv * rv >= vv * c)
    root = c / ((rv * rv - vv * c).sqrt() - rv)
    late = start.all(0.0).where(c <= 0.0, root).where(meets, inf)
    return start + unless_tiny(late, relative, rr, rv, vv, ss)


def unless_tiny(late: Lanes, relative: list, rr: Lanes, rv: Lanes, vv: Lanes, ss: Lanes) -> Lanes:
    """Return the times until contact; those of particles that are tiny beside their distance from r x v."""
    builder = late.builder
    tiny = (ss < rr * TINY) & (rv < 0.0)
    entry_block = builder.basic_block
    with builder.if_then(builder.icmp_unsigned("!=", mask_of(tiny), ir.IntType(WIDTH)(0)), likely=False):
        areas = [r * v_m - r_m * v for k, (r, v) in enumerate(relative) for r_m, v_m in relative[:k]]
        square = ss * vv - reduce(Lanes.__add__, [area * area for area in areas])
        root = ((rr - ss) / (square.sqrt() - rv)).where(square >= 0.0, inf)
        known, computed = root.where(tiny, late), builder.basic_block
    phi = builder.phi(late.value.type)
    phi.add_incoming(late.value, entry_block)
    phi.add_incoming(known.value, computed)
    return Lanes(builder, phi)


def images_of(candidates: Lanes, axes: int) -> list[Lanes]:
    """Return the image of the container, -1, 0 or 1 along each axis, for each candidate."""
    builder = candidates.builder
    images = []
    for axis in range(axes):
        above = candidates.all(_INT(32 - NUMBER_BITS - IMAGE_BITS * (axis + 1)))
        image = builder.shl(candidates.value, above.value)
        image = builder.ashr(image, candidates.all(_INT(32 - IMAGE_BITS)).value)
        images.append(Lanes(builder, builder.sitofp(image, ir.VectorType(_DOUBLE, WIDTH))))
    return images


def marks(builder: ir.IRBuilder, data: ir.Value, indices: list[ir.Value]) -> ir.Value:
    """Return one bit per particle, from an array of bytes 0 or 1."""
    mask = ir.IntType(WIDTH)(0)
    for n, index in enumerate(indices):
        mark = builder.trunc(builder.load(builder.gep(data, [index])), ir.IntType(WIDTH))
        mask = builder.or_(mask, builder.shl(mark, ir.IntType(WIDTH)(n)))
    return mask


def sooner(time: Lanes, number: Lanes, other_time: Lanes, other_number: Lanes) -> tuple[Lanes, Lanes]:
    """Return the earlier of two contacts; of simultaneous contacts, the lower index."""
    build = time.builder
    sooner = other_time < time
    lower = Lanes(build, build.icmp_signed("<", other_number.value, number.value))
    other_is = sooner | (other_time.equals(time) & lower)
    return other_time.where(sooner, time), other_number.where(other_is, number)


def soonest(time: Lanes, number: Lanes) -> tuple[ir.Value, ir.Value]:
    """Return the earliest of eight contacts; of simultaneous contacts, the lowest index."""
    build = time.builder
    first = time
    for step in _STEPS:
        other = first.rotate(step)
        first = other.where(other < first, first)
    earliest = build.extract_element(first.value, _INT(0))
    at_first = time.equals(first)
    mask = mask_of(at_first)
    lane = build.zext(build.cttz(mask, ir.IntType(1)(0)), _INT)
    result = cgutils.alloca_once_value(build, build.extract_element(number.value, lane))
    one_less = build.sub(mask, mask.type(1))
    several = build.icmp_unsigned("!=", build.and_(mask, one_less), mask.type(0))
    is_finite = build.fcmp_ordered("<", earliest, _DOUBLE(inf))
    with build.if_then(build.and_(several, is_finite), likely=False):
        lowest = number.where(at_first, number.all(_WORD(2**63 - 1)))
        for step in _STEPS:
            other = lowest.rotate(step)
            lower = Lanes(build, build.icmp_signed("<", other.value, lowest.value))
            lowest = other.where(lower, lowest)
        build.store(build.extract_element(lowest.value, _INT(0)), result)
    return earliest, build.load(result)


def load_candidates(builder: ir.IRBuilder, address: ir.Value) -> tuple[Lanes, Lanes, list[ir.Value]]:
    """Load eight candidates, and their numbers as a vector and as scalars. The scalars are loaded separately
    because the vector units of the processor are busy.
    """
    mask, numbers = (1 << NUMBER_BITS) - 1, []
    for n in range(WIDTH):
        candidate = builder.load(builder.gep(address, [_WORD(n)]))
        numbers.append(builder.zext(builder.and_(candidate, _INT(mask)), _WORD))
    eight = builder.bitcast(address, ir.VectorType(_INT, WIDTH).as_pointer())
    candidates = Lanes(builder, builder.load(eight, align=4))
    together = builder.and_(candidates.value, candidates.all(_INT(mask)).value)
    return candidates, Lanes(builder, builder.zext(together, ir.VectorType(_WORD, WIDTH))), numbers


@intrinsic
def earliest(typingctx, flights, i, span, present, boxes, space, gravity):
    """Return the earliest contact of a particle with candidates, if it is earlier than `present`. The result
    is (time, partner, bits). A bit is set for each candidate whose contact was not computed, because it or
    the particle may not fall, see `flight.mark_resting`. `span`: first candidate and number of candidates.
    `present`: time and partner of the earliest contact so far. `boxes`: named tuple with `candidates` and,
    under gravity, `resting`.
    """

    def generate(context, builder, signature, arguments):
        flights, i, span, present, boxes, space, gravity = arguments
        start, count = cgutils.unpack_tuple(builder, span)
        types_of = dict(zip(("boxes", "space", "gravity"), signature.args[4:], strict=True))
        boxes = fields(builder, types_of["boxes"], boxes)
        lengths = fields(builder, types_of["space"], space)["lengths"]

        def data(array_type, array):
            return context.make_array(array_type)(context, builder, array).data

        kinds = dict(zip(types_of["boxes"].fields, types_of["boxes"].types, strict=True))
        rows = builder.bitcast(data(signature.args[0], flights), _DOUBLE.as_pointer())
        near = builder.gep(data(kinds["candidates"], boxes["candidates"]), [start])
        falls = not isinstance(types_of["gravity"], types.NoneType)
        resting = data(kinds["resting"], boxes["resting"]) if falls else None
        pull = fields(builder, types_of["gravity"], gravity)["acceleration"] if falls else []
        particle = load_row(builder, rows, i)
        best, partner = (
            cgutils.alloca_once_value(builder, particle[0].all(part).value)
            for part in cgutils.unpack_tuple(builder, present)
        )
        unknown = cgutils.alloca_once_value(builder, _WORD(0))
        with cgutils.for_range_slice(builder, _WORD(0), count, _WORD(WIDTH), _WORD) as (first, _):
            candidates, numbers, indices = load_candidates(builder, builder.gep(near, [first]))
            others = load_rows(builder, rows, indices)
            images = images_of(candidates, len(lengths))
            time = contact_times(particle, others, images, lengths, pull)
            if falls:
                mask = builder.or_(marks(builder, resting, indices), marks(builder, resting, [i] * WIDTH))
                lanes = builder.bitcast(mask, ir.VectorType(ir.IntType(1), WIDTH))
                time = time.all(inf).where(Lanes(builder, lanes), time)
                mask = builder.shl(builder.zext(mask, _WORD), first)
                builder.store(builder.or_(builder.load(unknown), mask), unknown)
            so_far = Lanes(builder, builder.load(best)), Lanes(builder, builder.load(partner))
            time, numbers = sooner(*so_far, time, numbers)
            builder.store(time.value, best)
            builder.store(numbers.value, partner)
        contact = soonest(*(Lanes(builder, builder.load(part)) for part in (best, partner)))
        return context.make_tuple(builder, signature.return_type, [*contact, builder.load(unknown)])

    result = types.Tuple((types.float64, types.int64, types.uint64))
    contact = types.Tuple((types.float64, types.int64))
    span_type = types.UniTuple(types.uint64, 2)
    return result(flights, types.uint64, span_type, contact, boxes, space, gravity), generate


@intrinsic
def nearer(typingctx, pages, page, point, offset, square):
    """Return a bit for each of the WIDTH points of a page near a point. A point is near if the square of its
    distance is below `square`. The arithmetic is in single precision, and the result does not depend on the
    order of the two points. `neighbour_lists.page_dtype` describes the page. `point`: (3,). `offset`: (3,),
    displacement of the page.
    """

    def generate(context, builder, signature, arguments):
        pages, page, point, offset, square = arguments
        kind = signature.args[0]
        data = context.make_array(kind)(context, builder, pages).data
        single, byte = ir.FloatType(), ir.IntType(8)
        vector = ir.VectorType(single, WIDTH)
        start = builder.gep(
            builder.bitcast(data, byte.as_pointer()), [builder.mul(page, _WORD(kind.dtype.size))]
        )
        centres = builder.bitcast(start, vector.as_pointer())
        point, offset = (cgutils.unpack_tuple(builder, part) for part in (point, offset))
        squares = []
        for k in range(kind.dtype.fields["centres"].type.shape[0]):
            there = Lanes(builder, builder.load(builder.gep(centres, [_WORD(k)]), align=32))
            gap = (there - builder.fptrunc(point[k], single)) + builder.fptrunc(offset[k], single)
            squares.append(gap * gap)
        total = reduce(Lanes.__add__, squares)
        near = (total < builder.fptrunc(square, single)).value
        return builder.zext(builder.bitcast(near, ir.IntType(WIDTH)), _WORD)

    vector = types.UniTuple(types.float64, 3)
    return types.uint64(pages, types.uint64, vector, vector, types.float64), generate


@intrinsic
def equal(typingctx, numbers, start, number, mask):
    """Return a bit for each of 2 WIDTH numbers that equals `number` after masking. The numbers are 32-bit
    words of an array, beginning at `start`; only the bits in `mask` are compared.
    """

    def generate(context, builder, signature, arguments):
        numbers, start, number, mask = arguments
        data = context.make_array(signature.args[0])(context, builder, numbers).data
        many = ir.VectorType(_INT, 2 * WIDTH)

        def all_of(value):
            first = builder.insert_element(
                ir.Constant(many, ir.Undefined), builder.trunc(value, _INT), _INT(0)
            )
            return builder.shuffle_vector(first, first, ir.Constant(many, [0] * (2 * WIDTH)))

        address = builder.bitcast(builder.gep(data, [start]), many.as_pointer())
        masked = builder.and_(builder.load(address, align=4), all_of(mask))
        same = builder.icmp_unsigned("==", masked, all_of(number))
        return builder.zext(builder.bitcast(same, ir.IntType(2 * WIDTH)), _WORD)

    index = types.uint64
    return index(numbers, index, index, index), generate


@intrinsic
def list_box(typingctx, candidates, count, members, box, image):
    """Write all entries of a box, used or not, in an image, into `candidates` from index `count`."""

    def generate(context, builder, signature, arguments):
        near, count, members, box, image = arguments
        near = context.make_array(signature.args[0])(context, builder, near).data
        members = context.make_array(signature.args[2])(context, builder, members).data
        four = ir.VectorType(_INT, PLACES)
        address = builder.gep(members, [builder.mul(box, _WORD(PLACES))])
        numbers = builder.load(builder.bitcast(address, four.as_pointer()), align=4)
        image = builder.insert_element(ir.Constant(four, ir.Undefined), builder.trunc(image, _INT), _INT(0))
        images = builder.shuffle_vector(image, image, ir.Constant(four, [0] * PLACES))
        address = builder.bitcast(builder.gep(near, [count]), four.as_pointer())
        builder.store(builder.or_(numbers, images), address, align=4)
        return context.get_dummy_value()

    return types.none(candidates, types.uint64, members, types.uint64, types.uint64), generate
