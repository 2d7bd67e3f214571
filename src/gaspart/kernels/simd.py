"""Eight numbers at once, with vector instructions: the basis of the searches of both engines.

LLVM maps these vectors to processor vectors of any width. See `event.simd` and `step.neighbour_list`.
"""

from __future__ import annotations

from dataclasses import dataclass

from llvmlite import ir
from numba import types
from numba.core import cgutils
from numba.extending import intrinsic

WIDTH = 8
_DOUBLE, _INT = ir.DoubleType(), ir.IntType(32)


@dataclass(frozen=True, eq=False)
class Lanes:
    """Eight values, and operations on them that are emitted into machine code."""

    builder: ir.IRBuilder
    value: ir.Value

    def all(self, scalar: float | ir.Value) -> Lanes:
        """Return a vector with the same number in every lane."""
        if not isinstance(scalar, ir.Value):
            scalar = ir.Constant(_DOUBLE, scalar)
        vector = ir.VectorType(scalar.type, WIDTH)
        first = self.builder.insert_element(ir.Constant(vector, ir.Undefined), scalar, _INT(0))
        everywhere = ir.Constant(ir.VectorType(_INT, WIDTH), [0] * WIDTH)
        return Lanes(self.builder, self.builder.shuffle_vector(first, first, everywhere))

    def _with(self, name: str, other: Lanes | float | ir.Value) -> Lanes:
        other = other if isinstance(other, Lanes) else self.all(other)
        return Lanes(self.builder, getattr(self.builder, name)(self.value, other.value))

    def _than(self, sign: str, other: Lanes | float | ir.Value) -> Lanes:
        other = other if isinstance(other, Lanes) else self.all(other)
        return Lanes(self.builder, self.builder.fcmp_ordered(sign, self.value, other.value))

    def __add__(self, other):
        return self._with("fadd", other)

    def __sub__(self, other):
        return self._with("fsub", other)

    def __mul__(self, other):
        return self._with("fmul", other)

    def __truediv__(self, other):
        return self._with("fdiv", other)

    def __and__(self, other):
        return self._with("and_", other)

    def __or__(self, other):
        return self._with("or_", other)

    def __lt__(self, other):
        return self._than("<", other)

    def __le__(self, other):
        return self._than("<=", other)

    def __gt__(self, other):
        return self._than(">", other)

    def __ge__(self, other):
        return self._than(">=", other)

    def equals(self, other):
        """Compare lane by lane."""
        return self._than("==", other)

    def rotate(self, step: int) -> Lanes:
        """Rotate the lanes by a number of positions."""
        indices = ir.Constant(ir.VectorType(_INT, WIDTH), [(n + step) % WIDTH for n in range(WIDTH)])
        return Lanes(self.builder, self.builder.shuffle_vector(self.value, self.value, indices))

    def plus_product(self, factor: Lanes, other: Lanes) -> Lanes:
        """Add an exact product; it does not matter if it is rounded before the addition."""
        kind = ir.FunctionType(self.value.type, [self.value.type] * 3)
        name = f"llvm.fmuladd.v{WIDTH}f64"
        fused = cgutils.get_or_insert_function(self.builder.module, kind, name)
        return Lanes(self.builder, self.builder.call(fused, [factor.value, other.value, self.value]))

    def sqrt(self):
        """Compute the square root lane by lane, rounded as IEEE requires."""
        kind = ir.FunctionType(self.value.type, [self.value.type])
        root = cgutils.get_or_insert_function(self.builder.module, kind, f"llvm.sqrt.v{WIDTH}f64")
        return Lanes(self.builder, self.builder.call(root, [self.value]))

    def where(self, condition: Lanes, other: Lanes | float) -> Lanes:
        """Select these lanes if the condition holds, otherwise the other lanes."""
        other = other if isinstance(other, Lanes) else self.all(other)
        return Lanes(self.builder, self.builder.select(condition.value, self.value, other.value))


def mask_of(condition: Lanes) -> ir.Value:
    """Return a bit for each lane that is set if the condition holds."""
    return condition.builder.bitcast(condition.value, ir.IntType(WIDTH))


def fields(builder: ir.IRBuilder, kind: types.BaseNamedTuple, value: ir.Value) -> dict:
    """Return the members of a named tuple by name; nested tuples become lists."""
    members = {}
    for n, (name, member) in enumerate(zip(kind.fields, kind.types, strict=True)):
        part = builder.extract_value(value, n)
        members[name] = cgutils.unpack_tuple(builder, part) if hasattr(member, "count") else part
    return members


@intrinsic
def lowest(typingctx, bits):
    """Return the index of the lowest set bit of a nonzero word."""

    def generate(context, builder, signature, arguments):
        return builder.cttz(arguments[0], ir.IntType(1)(1))

    return types.uint64(types.uint64), generate
