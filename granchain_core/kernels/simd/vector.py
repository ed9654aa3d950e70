"""Vectors of 4, 8, 16 or 32 doubles as Numba types: explicit SIMD over scenes or along a chain.

LLVM puts eight doubles into one register of 512 bits, two of 256 or four of 128, depending on the machine. Arithmetic
has the flags of `FAST_MATH`, as in the scalar kernels; roots, comparisons and selects (here and in functions.py) have
none, so that they see a NaN (compiling/jit.py). `load8`, `load16` and `load32` read one row of a C-ordered array
(rows, 8), (rows, 16) or (rows, 32); `load_batch` reads a row of a batch, whose width depends on the machine
(batch_size.py).
"""

from __future__ import annotations

import operator

import numpy as np
from llvmlite import ir
from numba import errors, types
from numba.core.typing.templates import ConcreteTemplate, infer_global, signature
from numba.extending import (
    intrinsic,
    lower_builtin,
    models,
    register_model,
)

from ..batch_size import BATCH_SIZE
from ..compiling.jit import FAST_MATH

#: Number of doubles in a block of a long chain, in a block of tangents, and in the vectors of q and t (dop853_root).
BLOCK_WIDTH = 8
#: The available widths of vectors.
WIDTHS = (4, 8, 16, 32)


class VectorType(types.Type):
    """The Numba type of a vector of `width` doubles; `ir` is its LLVM type."""

    def __init__(self, width: int) -> None:
        super().__init__(name=f"vector{width}")
        self.width = width
        self.ir = ir.VectorType(ir.DoubleType(), width)


VECTORS = {width: VectorType(width) for width in WIDTHS}
block_vector = VECTORS[BLOCK_WIDTH]


@register_model(VectorType)
class _VectorModel(models.PrimitiveModel):
    def __init__(self, dmm, fe_type) -> None:
        super().__init__(dmm, fe_type, fe_type.ir)


def _splat(builder, kind, value):
    """A vector with one value in all lanes."""
    one = builder.insert_element(ir.Constant(kind, ir.Undefined), value, ir.Constant(ir.IntType(32), 0))
    zeros = ir.Constant(ir.VectorType(ir.IntType(32), kind.count), [0] * kind.count)
    return builder.shuffle_vector(one, ir.Constant(kind, ir.Undefined), zeros)


def as_vector(builder, wanted, kind, value):
    """The value as a vector; a number is copied into all lanes."""
    return value if isinstance(kind, VectorType) else _splat(builder, wanted.ir, value)


def _binary(operation, instruction) -> None:
    cases = [signature(v, *args) for v in VECTORS.values()
             for args in ((v, v), (v, types.float64), (types.float64, v))]

    @infer_global(operation)
    class _Typing(ConcreteTemplate):
        pass

    _Typing.cases = cases
    for case in cases:

        @lower_builtin(operation, *case.args)
        def _lower(context, builder, sig, args):
            left, right = (as_vector(builder, sig.return_type, k, v) for k, v in zip(sig.args, args, strict=True))
            return getattr(builder, instruction)(left, right, flags=FAST_MATH)


for _operation, _instruction in ((operator.add, "fadd"), (operator.sub, "fsub"), (operator.mul, "fmul"),
                                 (operator.truediv, "fdiv")):
    _binary(_operation, _instruction)


@infer_global(operator.neg)
class _Negated(ConcreteTemplate):
    pass


_Negated.cases = [signature(v, v) for v in VECTORS.values()]


for _kind in VECTORS.values():

    @lower_builtin(operator.neg, _kind)
    def _negate(context, builder, sig, args):
        return builder.fneg(args[0], flags=FAST_MATH)


def aligned(rows: int, width: int = BLOCK_WIDTH) -> np.ndarray:
    """Return zeros (rows, width) that start on a cache line: a vector that spans two lines costs two accesses."""
    spare = 8  # doubles in a cache line of 64 bytes
    memory = np.zeros(rows * width + spare)
    first = -(memory.ctypes.data // 8) % spare
    return memory[first : first + rows * width].reshape(rows, width)


@intrinsic
def splat8(typingctx, value):
    """A vector of eight doubles, all equal to `value`."""

    def codegen(context, builder, sig, args):
        return _splat(builder, block_vector.ir, args[0])

    return block_vector(types.float64), codegen


def require_rows(array):
    """Check, while a kernel is typed, that an array is C-ordered and two-dimensional and contains float64.

    From any other array, a vector would be read out of foreign memory. The width of a row is not known at that stage.
    """
    fits = isinstance(array, types.Array) and array.ndim == 2 and array.layout == "C" and array.dtype == types.float64
    if not fits:
        raise errors.TypingError(f"vectors are rows of C-ordered arrays (rows, width) of float64, not of {array}.")


def _row_pointer(context, builder, array_type, array, row, kind):
    """Pointer to a row of a C-ordered (rows, width) array."""
    data = context.make_array(array_type)(context, builder, array).data
    offset = builder.mul(row, ir.Constant(row.type, kind.count))
    return builder.bitcast(builder.gep(data, [offset]), kind.as_pointer())


def loader(width):
    """Make an intrinsic that reads row `row` of a (rows, width) array."""
    kind = VECTORS[width]

    @intrinsic
    def load_row(typingctx, array, row):
        require_rows(array)

        def codegen(context, builder, sig, args):
            return builder.load(_row_pointer(context, builder, sig.args[0], *args, kind.ir), align=8)

        return kind(array, types.intp), codegen

    return load_row


load8, load16, load32 = (loader(width) for width in (BLOCK_WIDTH, 16, 32))
#: Reads one row of the arrays of a batch.
load_batch = loader(BATCH_SIZE)


@intrinsic
def load_like(typingctx, value, array, row):
    """One row of an array as wide as the vector `value`."""
    require_rows(array)

    def codegen(context, builder, sig, args):
        return builder.load(_row_pointer(context, builder, sig.args[1], *args[1:], sig.return_type.ir), align=8)

    return value(value, array, row), codegen


@intrinsic
def store(typingctx, array, row, value):
    """Write a vector to row `row` of a (rows, width) array."""
    require_rows(array)

    def codegen(context, builder, sig, args):
        builder.store(args[2], _row_pointer(context, builder, sig.args[0], args[0], args[1], sig.args[2].ir), align=8)
        return context.get_dummy_value()

    return types.void(array, types.intp, value), codegen


def _shifted(left: bool):
    """Make an intrinsic that shifts two concatenated vectors by one lane to the left or right."""

    @intrinsic
    def shifted(typingctx, here, beside):
        width = here.width
        first = width - 1 if left else 1

        def codegen(context, builder, sig, args):
            mask = ir.Constant(ir.VectorType(ir.IntType(32), width), list(range(first, first + width)))
            return builder.shuffle_vector(args[0], args[1], mask)

        return here(here, here), codegen

    return shifted


#: from_left(before, here): every lane's left neighbour; from_right(here, ahead): every lane's right neighbour.
from_left, from_right = _shifted(True), _shifted(False)


@intrinsic
def with_first(typingctx, value, first):
    """The vector with its first lane replaced by a number."""

    def codegen(context, builder, sig, args):
        return builder.insert_element(args[0], args[1], ir.Constant(ir.IntType(32), 0))

    return value(value, types.float64), codegen


@intrinsic
def blank(typingctx, value):
    """Zero in all lanes of a vector like `value`."""

    def codegen(context, builder, sig, args):
        kind = sig.return_type.ir
        return ir.Constant(kind, [0.0] * kind.count)

    return value(value), codegen


@intrinsic
def at(typingctx, value, lane):
    """One lane of a vector."""

    def codegen(context, builder, sig, args):
        return builder.extract_element(args[0], builder.trunc(args[1], ir.IntType(32)))

    return types.float64(value, types.intp), codegen


@intrinsic
def positive_mask(typingctx, value):
    """One bit per lane: 1 if it is above zero."""

    def codegen(context, builder, sig, args):
        kind = sig.args[0].ir
        above = builder.fcmp_ordered(">", args[0], ir.Constant(kind, [0.0] * kind.count))
        return builder.zext(builder.bitcast(above, ir.IntType(kind.count)), ir.IntType(64))

    return types.int64(value), codegen


@intrinsic
def lowest_bit(typingctx, mask):
    """The number of the lowest set bit."""

    def codegen(context, builder, sig, args):
        return builder.cttz(args[0], ir.Constant(ir.IntType(1), 0))

    return types.int64(mask), codegen
