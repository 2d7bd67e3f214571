"""Prefetch of data that will be read soon, while the processor does other work."""

from __future__ import annotations

from llvmlite import ir
from numba import types
from numba.core import cgutils
from numba.extending import intrinsic

_BYTE, _FLAG, _WORD = ir.IntType(8).as_pointer(), ir.IntType(32), ir.IntType(64)
TOGETHER = 8  # number of rows fetched by one call of `fetch_numbered`
_LINE = 64  # length of a cache line in bytes


def _fetch(context, builder, kind, array, index, offset=0):
    """Emit the instruction that prefetches array[index] plus `offset` bytes."""
    array = context.make_array(kind)(context, builder, array)
    one_after_other = kind.ndim == 1 and kind.layout == "C"
    stride = _WORD(context.get_abi_sizeof(context.get_data_type(kind.dtype)))
    if not one_after_other:
        stride = cgutils.unpack_tuple(builder, array.strides)[0]
    address = builder.gep(builder.bitcast(array.data, _BYTE), [builder.mul(index, stride)])
    address = builder.gep(address, [_WORD(offset)])
    form = ir.FunctionType(ir.VoidType(), [_BYTE, _FLAG, _FLAG, _FLAG])
    prefetch = cgutils.get_or_insert_function(builder.module, form, "llvm.prefetch.p0")
    builder.call(prefetch, [address, _FLAG(0), _FLAG(3), _FLAG(1)])


@intrinsic
def fetch(typingctx, array, index):
    """Prefetch the cache line that contains the start of array[index], without waiting for it."""

    def generate(context, builder, signature, arguments):
        _fetch(context, builder, signature.args[0], *arguments)
        return context.get_dummy_value()

    return types.none(array, types.int64), generate


@intrinsic
def fetch_two(typingctx, array, index):
    """Prefetch the cache line that contains the start of array[index], and the next one."""

    def generate(context, builder, signature, arguments):
        _fetch(context, builder, signature.args[0], *arguments)
        _fetch(context, builder, signature.args[0], *arguments, offset=_LINE)
        return context.get_dummy_value()

    return types.none(array, types.int64), generate


@intrinsic
def fetch_numbered(typingctx, array, numbers, first, mask):
    """Prefetch `TOGETHER` rows of an array; another array contains their numbers. The numbers are 32-bit
    words, starting at numbers[first]. Only the bits of a mask count.
    """

    def generate(context, builder, signature, arguments):
        array, numbers, first, mask = arguments
        numbers = context.make_array(signature.args[1])(context, builder, numbers).data
        for n in range(TOGETHER):
            number = builder.load(builder.gep(numbers, [builder.add(first, _WORD(n))]))
            number = builder.and_(builder.zext(number, _WORD), mask)
            _fetch(context, builder, signature.args[0], array, number)
        return context.get_dummy_value()

    return types.none(array, numbers, types.uint64, types.uint64), generate
